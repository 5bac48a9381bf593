#!/usr/bin/python3
"""benchmarks/compare.py: ratios and intervals of files whose answer is known, and bad input."""

import json
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "compare.py"


def google(times, unit="ns", **more):
    """A run of Google Benchmark, by benchmark the times of its repetitions."""
    entries = []
    for name, values in times.items():
        for value in values:
            entries.append({"name": name, "run_name": name, "run_type": "iteration",
                            "real_time": value, "time_unit": unit, **more})
        entries.append({"name": name + "_mean", "run_name": name, "run_type": "aggregate",
                        "real_time": 1e9, "time_unit": unit})
    return {"context": {}, "benchmarks": entries}


def problems(total, certified=9):
    statistic = {"median": total, "mean": total, "p95": 2 * total, "max": 3 * total}
    entry = {"runs": 10, "certified": certified}
    for key in ("plan_us", "simplify_us", "total_us", "length_before", "length_after"):
        entry[key] = statistic
    return {"sets": {"shelf": entry}, "total": entry}


def cell(p50):
    return {"queries": 4, "success": 4, "motion_duration_s": {"mean": 2.0},
            "times_ms": {"total": {"p50": p50, "p99": 2 * p50}}}


class Compare(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.files = 0

    def file(self, content):
        self.files += 1
        path = self.folder / f"{self.files}.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return str(path)

    def run_with(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True)

    def rows(self, *arguments):
        """By name: before, after, ratio, interval (None or low, high)."""
        done = self.run_with(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = {}
        for line in done.stdout.splitlines()[1:]:
            name, before, after, ratio, span, _ = [c.strip() for c in line.split("  ") if c.strip()]
            span = None if span == "-" else tuple(float(end) for end in span.split(" to "))
            rows[name] = (float(before), float(after), float(ratio), span)
        return rows

    def test_ratios_are_of_medians_and_intervals_hold_the_truth(self):
        rng = random.Random(7)
        held = 0
        for _ in range(40):
            before = [100 * rng.gauss(1, 0.1) for _ in range(15)]
            after = [50 * rng.gauss(1, 0.1) for _ in range(15)]
            rows = self.rows(self.file(google({"kernel": before})),
                             self.file(google({"kernel": after})), "--resamples", "300")
            _, _, ratio, (low, high) = rows["kernel [ns]"]
            self.assertTrue(low <= ratio <= high)
            self.assertLess(high - low, 0.2)
            held += low <= 0.5 <= high
        self.assertGreaterEqual(held, 33)  # Of 40 at 95 %.

    def test_equal_samples_have_a_narrow_interval_and_few_samples_none(self):
        same = self.file(google({"kernel": [10.0] * 5}))
        self.assertEqual(self.rows(same, same)["kernel [ns]"], (10, 10, 1, (1, 1)))
        few = self.file(google({"kernel": [10.0, 10.0]}))
        self.assertEqual(self.rows(few, same)["kernel [ns]"], (10, 10, 1, None))

    def test_units_and_counts_per_question(self):
        us = self.file(google({"kernel": [2.0]}, "us"))
        ns = self.file(google({"kernel": [1000.0]}))
        self.assertEqual(self.rows(us, ns)["kernel [ns]"][:3], (2000, 1000, 0.5))
        each = self.file(google({"kernel": [999.0]}, each=4e-9))
        self.assertEqual(self.rows(each, each)["kernel [ns]"][0], 4)

    def test_bench_files_are_one_sample_each(self):
        before = [self.file(problems(t)) for t in (100, 110, 90)]
        after = [self.file(problems(t, 10)) for t in (50, 55, 45)]
        rows = self.rows("--before", *before, "--after", *after)
        self.assertEqual(rows["shelf total_us median"][:3], (100, 50, 0.5))
        self.assertEqual(rows["total total_us p95"][:3], (200, 100, 0.5))
        self.assertEqual(rows["shelf certified"][:2], (0.9, 1))
        low, high = rows["shelf total_us median"][3]
        self.assertTrue(low < 0.5 < high)
        rows = self.rows(self.file(cell(4)), self.file(cell(1)))
        self.assertEqual(rows["total_ms p99"], (8, 2, 0.25, None))

    def test_refuses_what_it_cannot_compare(self):
        good = self.file(google({"kernel": [1.0]}))
        other = self.file(google({"other": [1.0]}))
        failed = self.file({"benchmarks": [{"name": "kernel", "error_occurred": True,
                                            "error_message": "no data"}]})
        cases = {
            "No such file": [good, str(self.folder / "absent.json")],
            "not a benchmark file": [good, self.file("{")],
            "neither of": [good, self.file({"a": 1})],
            "different kinds": [good, self.file(cell(1))],
            "nothing in common": [good, other],
            "no data": [good, failed],
            "give two files": [good],
            "KeyError": [good, self.file({"benchmarks": [{"name": "kernel"}]})],
            "between 0 and 1": [good, good, "--confidence", "2"],
        }
        for says, arguments in cases.items():
            with self.subTest(says):
                done = self.run_with(*arguments)
                self.assertEqual(done.returncode, 2)
                self.assertIn(says, done.stderr)
                self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()

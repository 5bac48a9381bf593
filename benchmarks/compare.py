#!/usr/bin/env python3
"""Ratios of two benchmark runs with confidence intervals.

    compare.py BEFORE.json AFTER.json
    compare.py --before A1.json A2.json ... --after B1.json B2.json ...

Each file is a run of Google Benchmark (--benchmark_out=FILE --benchmark_repetitions=10) or of
`tandem bench --json FILE`; one comparison takes one kind. Samples are the repetitions of all
files of a side; `tandem bench` keeps statistics only, so a file is one sample of each: give
several files with other seeds. A ratio is the median after divided by the median before, its
interval the percentile bootstrap: both sides are drawn anew with replacement. With less than three
samples on a side there is none.

Ref: Efron, Tibshirani, An introduction to the bootstrap (1993), 13.
"""

import argparse
import json
import random
import statistics
import sys
from pathlib import Path

SEED = 1
LEAST_SAMPLES = 3
NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
# What is compared of a `tandem bench` file, and by which statistic.
PROBLEM_MEASURES = (("plan_us", "median"), ("simplify_us", "median"), ("total_us", "median"),
                    ("total_us", "p95"), ("length_after", "mean"))
CELL_STATISTICS = ("p50", "p99")


class BadFile(Exception):
    """A file that is not what it should be; the message is for people."""


def google_samples(run):
    """Times per iteration [ns], or per question where a benchmark counts them as `each`."""
    samples = {}
    for entry in run["benchmarks"]:
        if entry.get("run_type", "iteration") != "iteration":
            continue
        if entry.get("error_occurred"):
            raise BadFile(f"benchmark {entry['name']} failed: {entry.get('error_message', '?')}")
        time = entry["real_time"] * NANOSECONDS[entry["time_unit"]]
        if "each" in entry:
            time = entry["each"] * NANOSECONDS["s"]
        samples.setdefault(entry.get("run_name", entry["name"]) + " [ns]", []).append(time)
    return samples


def problem_samples(run):
    """Statistics of every set of problems, and the part that was solved."""
    samples = {}
    for name, entry in {**run["sets"], "total": run["total"]}.items():
        for measure, statistic in PROBLEM_MEASURES:
            samples[f"{name} {measure} {statistic}"] = [entry[measure][statistic]]
        samples[f"{name} certified"] = [entry["certified"] / max(1, entry["runs"])]
    return samples


def cell_samples(run):
    """Times of every module of a cell's plans, the motions' durations, and the part that succeeded."""
    samples = {"success": [run["success"] / max(1, run["queries"])],
               "motion_duration_s mean": [run["motion_duration_s"]["mean"]]}
    for module, values in run["times_ms"].items():
        for statistic in CELL_STATISTICS:
            samples[f"{module}_ms {statistic}"] = [values[statistic]]
    return samples


KINDS = {"benchmarks": google_samples, "sets": problem_samples, "times_ms": cell_samples}


def load(path):
    """Kind of the file and its samples by name."""
    try:
        run = json.loads(Path(path).read_text(encoding="utf-8"))
        for key, read in KINDS.items():
            if key in run:
                return key, read(run)
    except OSError as error:
        raise BadFile(f"{path}: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise BadFile(f"{path}: not a benchmark file as it should be: {error!r}") from error
    except BadFile as error:
        raise BadFile(f"{path}: {error}") from error
    raise BadFile(f"{path}: neither of Google Benchmark nor of `tandem bench --json`")


def merge(paths, kinds):
    """Samples of all files; adds their kinds to `kinds`."""
    merged = {}
    for path in paths:
        kind, samples = load(path)
        kinds.add(kind)
        for name, values in samples.items():
            merged.setdefault(name, []).extend(values)
    return merged


def ratio_of(before, after):
    """Ratio of medians, after to before; None if there is nothing to divide by."""
    base = statistics.median(before)
    return statistics.median(after) / base if base else None


def interval(before, after, confidence, resamples):
    """Percentile bootstrap of the ratio; None if there are too few samples."""
    if min(len(before), len(after)) < LEAST_SAMPLES:
        return None
    rng = random.Random(SEED)
    ratios = []
    for _ in range(resamples):
        ratio = ratio_of(rng.choices(before, k=len(before)), rng.choices(after, k=len(after)))
        if ratio is not None:
            ratios.append(ratio)
    if not ratios:
        return None
    ratios.sort()
    tail = (1 - confidence) / 2
    return ratios[int(tail * (len(ratios) - 1))], ratios[round((1 - tail) * (len(ratios) - 1))]


def table(before, after, confidence, resamples):
    """One row per name that both sides have."""
    rows = [("", "before", "after", "ratio", f"{100 * confidence:g} % interval", "samples")]
    for name in before:
        if name not in after:
            continue
        ratio = ratio_of(before[name], after[name])
        span = interval(before[name], after[name], confidence, resamples)
        rows.append((name, f"{statistics.median(before[name]):.4g}",
                     f"{statistics.median(after[name]):.4g}",
                     "-" if ratio is None else f"{ratio:.3f}",
                     "-" if span is None else f"{span[0]:.3f} to {span[1]:.3f}",
                     f"{len(before[name])}, {len(after[name])}"))
    return rows


def print_table(rows):
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        cells = [row[0].ljust(widths[0])]
        cells += [cell.rjust(width) for cell, width in zip(row[1:], widths[1:])]
        print("  ".join(cells).rstrip())


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", metavar="FILE", help="BEFORE.json AFTER.json")
    parser.add_argument("--before", nargs="+", metavar="FILE", default=[])
    parser.add_argument("--after", nargs="+", metavar="FILE", default=[])
    parser.add_argument("--confidence", type=float, default=0.95, help="default 0.95")
    parser.add_argument("--resamples", type=int, default=2000, help="default 2000")
    arguments = parser.parse_args()
    if arguments.files:
        if len(arguments.files) != 2 or arguments.before or arguments.after:
            parser.error("give two files, or --before and --after")
        arguments.before, arguments.after = [[file] for file in arguments.files]
    if not arguments.before or not arguments.after:
        parser.error("give two files, or --before and --after")
    if not 0 < arguments.confidence < 1 or arguments.resamples < 1:
        parser.error("--confidence lies between 0 and 1, --resamples is positive")
    return arguments


def main():
    arguments = parse_arguments()
    kinds = set()
    try:
        before = merge(arguments.before, kinds)
        after = merge(arguments.after, kinds)
    except BadFile as error:
        print(f"compare.py: {error}", file=sys.stderr)
        return 2
    if len(kinds) > 1:
        print("compare.py: the files are of different kinds", file=sys.stderr)
        return 2
    for name in sorted(before.keys() ^ after.keys()):
        print(f"only {'before' if name in before else 'after'}: {name}", file=sys.stderr)
    rows = table(before, after, arguments.confidence, arguments.resamples)
    if len(rows) == 1:
        print("compare.py: the sides have nothing in common", file=sys.stderr)
        return 2
    print_table(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())

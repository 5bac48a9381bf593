#!/usr/bin/python3
"""Benchmarks, fits and the viewer from outside. usage: PROGRAM SOURCE_FOLDER"""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
import unittest
import urllib.request

from command_line import CELL, COMMANDS, PROGRAM, SOURCE, CommandLine, Done


class Bench(CommandLine):
    def test_table_and_json(self):
        done = self.ok("bench", CELL, "--cycles", "3", "--json", "b.json")
        for words in ("3 whole cycles, 6 queries", "p99", "path_planning [ms]", "failures:",
                      "swing"):
            self.assertIn(words, done.out)
        bench = json.loads((self.folder / "b.json").read_text())
        self.assertEqual((bench["cycles"], bench["queries"]), (3, 6))
        self.assertEqual(bench["queries"], bench["success"] + sum(bench["failures"].values()))
        self.refused(2, "bench", CELL, "--json", "b.json", says=("b.json exists", "--force"))
        self.ok("bench", CELL, "--json", "b.json", "--force", "--preset", "paper")
        self.assertEqual(json.loads((self.folder / "b.json").read_text())["preset"], "paper")

    def test_arms_apart(self):
        done = self.ok("bench", CELL, "--strategy", "decoupled", "--json", "b.json")
        self.assertIn("strategy decoupled", done.out)
        bench = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(bench["success"], bench["queries"])
        for arm in bench["arms"].values():
            self.assertGreater(arm["times_ms"]["total"]["mean"], 0)
        self.assertGreater(bench["times_ms"]["coordination"]["mean"], 0)

    def test_a_diagram_of_the_coordination(self):
        plan = ("plan", CELL, "swing", "--strategy", "decoupled", "--diagram")
        self.assertIn("written: d.json", self.ok(*plan, "d.json").out)
        diagram = json.loads((self.folder / "d.json").read_text())
        self.assertIn("coordinated", str(diagram))
        self.refused(2, *plan, "d.json", says=("d.json exists", "--force"))
        self.ok(*plan, "d.csv")
        self.assertTrue((self.folder / "d.lines.csv").exists())
        self.ok(*plan, "e.json", "--arms", "right,left")
        turned = json.loads((self.folder / "e.json").read_text())
        self.assertEqual(turned["arms"], diagram["arms"][::-1])
        self.refused(2, *plan, "f.json", "--arms", "right,lef", says=("--arms", "mean 'left'"))
        self.refused(2, *plan, "f.json", "--arms", "left,left", says=("'left' twice",))
        self.refused(2, *plan, "f.json", "--arms", "left", says=("--arms",))
        self.refused(2, "plan", CELL, "swing", "--arms", "left,right", says=("--diagram",))

    def test_failures_are_a_result_and_are_explained(self):
        done = self.ok("bench", CELL, "--cycles", "2", "--deadline", "1e-9", "--json", "b.json")
        self.assertIn("timeout 4", done.out)
        self.assertIn("swing failed 2 times by timeout", done.err)
        self.assertEqual(json.loads((self.folder / "b.json").read_text())["failures"]["timeout"], 4)

    def test_interruption_keeps_what_it_has(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PROGRAM, "bench", CELL, "--cycles", "1000000", "--json", "b.json",
                                   "--force"], cwd=self.folder, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True) as process:
                time.sleep(1.5)
                process.send_signal(number)
                out, err = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 130, err)
            self.assertIn("interrupted after", err)
            bench = json.loads((self.folder / "b.json").read_text())
            self.assertGreater(bench["queries"], 0)
            self.assertIn(f"{bench['queries']} queries", out)

    def test_progress_is_for_terminals(self):
        self.assertEqual(self.ok("bench", CELL).err, "")
        try:
            ours, theirs = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminal to be had: {error}")
        with subprocess.Popen([PROGRAM, "bench", CELL, "--cycles", "3"], stdout=subprocess.DEVNULL,
                              stderr=theirs) as process:
            process.wait(timeout=60)
        shown = b""
        while select.select([ours], [], [], 0.2)[0]:
            shown += os.read(ours, 65536)
        os.close(theirs)
        os.close(ours)
        self.assertIn(b"6/6, 0 failed", shown)


class BenchProblems(CommandLine):
    PROBLEMS = SOURCE / "tests/io/problems"
    ROBOT = ("--urdf", PROBLEMS / "torso.urdf", "--srdf", PROBLEMS / "torso.srdf")

    def torso(self, *arguments):
        return ("bench", "--problems", self.PROBLEMS / "torso_sets.json", *self.ROBOT, *arguments)

    def test_table_and_json(self):
        done = self.ok(*self.torso("--cycles", "2", "--json", "b.json"))
        for words in ("crates", "posts plan_us", "total total_us", "failures: none"):
            self.assertIn(words, done.out)
        bench = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(set(bench["sets"]), {"crates", "posts"})
        counts = [(s["problems"], s["valid"], s["runs"], s["solved"], s["certified"])
                  for s in (*bench["sets"].values(), bench["total"])]
        self.assertEqual(counts, [(1, 1, 2, 2, 2), (2, 1, 2, 2, 2), (3, 2, 4, 4, 4)])
        for key in ("plan_us", "simplify_us", "total_us", "length_before", "length_after"):
            self.assertEqual(set(bench["total"][key]), {"median", "mean", "p95", "max"})
            self.assertGreater(bench["total"][key]["median"], 0)
        self.refused(2, *self.torso("--json", "b.json"), says=("b.json exists", "--force"))

    def test_several_robots(self):
        done = self.ok("bench", "--problems", self.PROBLEMS / "planar_pairs.json", "--urdf",
                       f"planar={self.PROBLEMS / 'planar.urdf'}")
        self.assertRegex(done.out, r"facing +3 +3 +3 +3 +3\n")

    def test_one_set_and_failures(self):
        done = self.ok(*self.torso("--set", "posts", "--deadline", "1e-9", "--verbose",
                                   "--json", "b.json"))
        self.assertNotIn("crates", done.out)
        self.assertIn("posts 1, cycle 0, timeout: ", done.out)
        posts = json.loads((self.folder / "b.json").read_text())["sets"]["posts"]
        self.assertEqual((posts["solved"], posts["failure_kinds"]), (0, {"timeout": 1}))
        self.assertEqual(posts["failures"][0]["problem"], "1")

    def test_wrong_use(self):
        sets = self.PROBLEMS / "torso_sets.json"
        for arguments, says in (
                (("bench",), "CELL or --problems is required"),
                (("bench", CELL, "--problems", sets), "--problems"),
                (("bench", CELL, "--urdf", "x"), "--problems"),
                (("bench", "--problems", sets), "no URDF for robot model 'torso'"),
                (("bench", "--problems", "gone.json"), "gone.json"),
                (self.torso("--set", "post"), "did you mean 'posts'?"),
                (self.torso("--urdf", "x"), "MODEL=FILE"),
                (self.torso("--joint", "neck"), "NAME=VALUE"),
                (self.torso("--joint", "neck=inf"), "NAME=VALUE"),
                (self.torso("--joint", "neck=9"), "outside its limits"),
                (self.torso("--cycles", "0"), "'0' is not a whole number from 1")):
            with self.subTest(arguments):
                self.refused(2, *arguments, says=says)

    def test_interruption_keeps_what_it_has(self):
        with subprocess.Popen([PROGRAM, *map(str, self.torso("--cycles", "10000000", "--json",
                                                             "b.json"))],
                              cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            time.sleep(1.5)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, err)
        self.assertRegex(err, r"interrupted after \d+ of 20000000 runs")
        bench = json.loads((self.folder / "b.json").read_text())
        self.assertTrue(bench["interrupted"])
        self.assertGreater(bench["total"]["runs"], 0)
        self.assertIn("failures: none", out)


class Fit(CommandLine):
    URDF = CELL.parent / "arm.urdf"

    def test_writes_a_volumes_file_and_a_table(self):
        self.cell_with(lambda text: text)
        done = self.ok("fit", "arm.urdf", "-o", "v.yaml", "--count", "1", "--starts", "1")
        self.assertRegex(done.out, r"(?m)^upper +cylinder +252 ")
        self.refused(2, "fit", "arm.urdf", "-o", "v.yaml", says=("v.yaml exists", "--force"))
        links = json.loads(self.ok("fit", "arm.urdf", "--link", "upper", "--count", "1",
                                   "--starts", "1", "--json").out)["links"]
        self.assertEqual([(link["link"], link["triangles"]) for link in links], [("upper", 252)])

    def test_refusals(self):
        for arguments, says in ((("none.urdf",), "none.urdf"),
                                ((self.URDF, "--link", "uper"), "did you mean 'upper'?"),
                                ((self.URDF, "--count", "0"), "'0' is not a whole number from 1"),
                                ((self.URDF, "--time", "0"), "--time"),
                                ((self.URDF, "--padding", "-1"), "--padding")):
            with self.subTest(arguments):
                self.refused(2, "fit", *arguments, says=("tandem fit: ", says))


class View(CommandLine):
    def setUp(self):
        super().setUp()
        self.ok("plan", CELL, "swing", "-o", "p.json")
        done = Done("view", "p.json", "--export", "probe.html", folder=self.folder)
        if done.code == 2 and "built without the viewer's page" in done.err:
            self.assertIn("tools/setup", done.err)
            self.skipTest(done.err)

    def test_export_is_one_page_with_the_plan_inside(self):
        self.assertEqual(self.ok("view", "p.json", "--export", "p.html").out, "written: p.html\n")
        page = (self.folder / "p.html").read_text()
        data = json.loads(re.search(r'id="tandem-data" type="application/json">(.*?)</script>', page,
                                    re.S)[1])
        self.assertEqual(data["scene"]["name"], "two_small_arms")
        self.assertEqual(data["plan"], json.loads((self.folder / "p.json").read_text()))
        self.assertGreater(min(sample["distance"] for sample in data["clearance"]), 0)
        self.refused(2, "view", "p.json", "--export", "p.html", says=("p.html exists", "--force"))
        self.ok("view", CELL, "--export", "p.html", "--force")
        self.assertIn('"plan":null', (self.folder / "p.html").read_text())

    def test_what_cannot_be_shown(self):
        self.refused(2, "view", "none.yaml", says="none.yaml")
        self.refused(2, "view", "none.json", says="none.json")
        self.refused(2, "view", "p.json", "--workcell", "none.yaml", says="none.yaml")
        self.refused(2, "view", CELL, "--webm", "a.webm", says="needs a motion")
        self.refused(2, "view", "p.json", "--png", "a.png", "--time", "99", says="past the end")
        self.refused(2, "view", "p.json", "--png", "a", "--webm", "a", says="two outputs")
        self.refused(2, "view", "p.json", "--png", "no/a.png", says="create it first")
        other = json.loads((self.folder / "p.json").read_text())
        other["arms"][0]["joints"][1] = "left/wrist"
        (self.folder / "other.json").write_text(json.dumps(other))
        self.refused(2, "view", "other.json", says=("other.json", "left/wrist"))

    def test_serves_until_it_is_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PROGRAM, "view", "p.json", "--no-open"], cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as process:
                address = process.stdout.readline().strip()
                self.assertRegex(address, r"^http://127\.0\.0\.1:\d+/$")
                with urllib.request.urlopen(address + "api/plan", timeout=30) as answer:
                    self.assertEqual(json.load(answer)["query"], "swing")
                request = json.dumps({"query": "rise"}).encode()
                with urllib.request.urlopen(address + "api/plan", request, timeout=60) as answer:
                    plan = json.load(answer)["plan"]
                self.assertEqual((plan["query"], plan["workcell"]), ("rise", CELL.name))
                process.send_signal(number)
                _, err = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 0, err)

    def test_a_missing_browser_names_the_package(self):
        done = subprocess.run([PROGRAM, "view", "p.json", "--png", "p.png"], cwd=self.folder,
                              env={"TANDEM_CHROMIUM": "/none"}, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("package chromium", done.stderr)


@unittest.skipUnless((SOURCE / "scenarios/gearbox/workcell.yaml").exists(), "no gearbox scenario")
class Gearbox(CommandLine):
    CELL = SOURCE / "scenarios/gearbox/workcell.yaml"

    def test_every_query_is_planned_and_verified(self):
        cell = json.loads(self.ok("check", self.CELL, "--json").out)
        self.assertTrue(cell["queries"])
        for query in cell["queries"]:
            with self.subTest(query["name"]):
                self.assertTrue(query["feasible"], query)
                file = query["name"].replace("/", "_") + ".json"
                for strategy in ("centralized", "decoupled"):
                    self.ok("plan", self.CELL, query["name"], "--strategy", strategy, "-o", file,
                            "--force")
                    self.ok("verify", file, "--rate", "250")

    def test_commands_of_the_readme_do_what_they_say(self):
        (self.folder / "scenarios").symlink_to(SOURCE / "scenarios")
        text = (SOURCE / "README.md").read_text()
        lines = re.findall(r"(?m)^ {4,}build/release/bin/tandem (.*)$", text)
        self.assertEqual({line.split()[0] for line in lines}, set(COMMANDS))
        for line in lines:
            if line.startswith("view") and "--export" not in line:
                continue  # Serves until it is interrupted, or needs a browser.
            self.ok(*re.sub(r"--cycles \d+", "--cycles 1", line).split())
        self.assertTrue((self.folder / "plan.json").exists())
        self.assertTrue((self.folder / "bench.json").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)

#!/usr/bin/python3
"""The tandem program from outside: exit codes, words, files. usage: PROGRAM SOURCE_FOLDER"""

import csv
import json
import re
import subprocess
import sys
import unittest
from xml.etree import ElementTree

from command_line import CELL, COMMANDS, PROGRAM, SOURCE, CommandLine, Done


class Help(CommandLine):
    def test_help_of_every_command_has_an_example_and_exit_codes(self):
        for arguments in ((), *((name,) for name in COMMANDS)):
            done = self.ok(*arguments, "--help")
            self.assertRegex(done.out, r"Example:\n  tandem \w+ \S+")
            self.assertIn("Exit codes: 0", done.out)
            self.assertIn("130 interrupted", done.out)
            self.assertEqual(done.err, "")
        for name in COMMANDS:
            self.assertIn(f"  {name} ", self.ok("--help").out)

    def test_planning_options_are_the_same_everywhere(self):
        blocks = {re.search(r"Planning options:\n.*?\n\n", self.ok(name, "--help").out, re.S)[0]
                  for name in ("plan", "bench")}
        self.assertEqual(len(blocks), 1)
        for option in ("--preset", "--strategy", "--interpolation", "--seed", "--deadline"):
            self.assertIn(option, blocks.copy().pop())

    def test_examples_use_options_that_exist(self):
        for name in COMMANDS:
            text = self.ok(name, "--help").out
            example = re.search(r"Example:\n  (tandem .*)", text)[1]
            for option in re.findall(r" (--?[a-z-]+)", example):
                self.assertRegex(text, rf"(?m)^  (-\w,)?{option}\b|^  {option},")

    def test_version(self):
        version = re.search(r"project\(tandem VERSION ([\d.]+)",
                            (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertRegex(self.ok("--version").out,
                         rf"^tandem {re.escape(version)}( \([0-9a-f]{{7,40}}(-dirty)?\))?\n$")


class Usage(CommandLine):
    def test_wrong_use_is_exit_2_with_the_command_in_the_message(self):
        for arguments, says in (
                ((), ("tandem: ", "subcommand")),
                (("fly",), "tandem: "),
                (("plan",), ("tandem plan: ", "CELL is required", "tandem plan --help")),
                (("plan", CELL), "QUERY is required"),
                (("plan", CELL, "swing", "--sede", "1"), "--sede"),
                (("plan", CELL, "swing", "--preset", "papper"), "did you mean 'paper'?"),
                (("plan", CELL, "swing", "--strategy", "fast"), "centralized"),
                (("plan", CELL, "swing", "--strategy", "decopled"), "did you mean 'decoupled'?"),
                (("plan", CELL, "swing", "--interpolation", "septic"), "quintic"),
                (("plan", CELL, "swing", "--seed", "-1"), "'-1' is not a whole number from 0"),
                (("plan", CELL, "swing", "--seed", "1.5"), "'1.5' is not a whole number"),
                (("plan", CELL, "swing", "--deadline", "0"), "'0' is not a number above 0"),
                (("plan", CELL, "swing", "--deadline", "nan"), "'nan' is not a number above 0"),
                (("plan", CELL, "swing", "--rate", "100"), "--csv"),
                (("plan", CELL, "swing", "--csv", "a", "--rate", "inf"), "up to 1000000"),
                (("plan", CELL, "swing", "--package-path", "none"), "none"),
                (("bench", CELL, "--cycles", "0"), "'0' is not a whole number from 1"),
                (("bench", CELL, "--cycles", "99999999999"), "--cycles"),
                (("verify", "p.json", "--rate", "-1"), "'-1' is not a number above 0"),
                (("verify",), "PLAN is required"),
                (("view",), ("tandem view: ", "SHOWN is required")),
                (("view", CELL, "--size", "1280"), "'1280' is no size from 64x64 to 4096x4096"),
                (("view", CELL, "--size", "10x10"), "'10x10' is no size"),
                (("view", CELL, "--port", "65536"), "65536"),
                (("view", CELL, "--time", "1"), "--png"),
                (("view", CELL, "--png", "a", "--time", "-1"), "--time"),
                (("view", CELL, "--webm", "a", "--fps", "0"), "'0' is not a number above 0"),
                (("check", CELL, "extra"), "extra")):
            with self.subTest(arguments):
                self.refused(2, *arguments, says=says)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_package_path_leaves_the_next_word_alone(self):
        self.ok("check", "--package-path", self.folder, CELL, "--package-path", self.folder)

    def test_files_that_cannot_be_used(self):
        for command in (("plan", "none.yaml", "swing"), ("check", "none.yaml"),
                        ("bench", "none.yaml"), ("verify", "none.json")):
            done = self.refused(2, *command, says=(f"tandem {command[0]}: ", command[1]))
            self.assertEqual(done.err.count("\n"), 1, done)
        (self.folder / "bad.yaml").write_text("name: [")
        self.refused(2, "check", "bad.yaml", says="bad.yaml")
        (self.folder / "bad.json").write_text("{}")
        self.refused(2, "verify", "bad.json", says=("bad.json", "schema_version"))

    def test_closed_output_is_an_error(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([PROGRAM, "check", CELL], stdout=full, stderr=subprocess.PIPE,
                                  text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("standard output", done.stderr)


class Plan(CommandLine):
    def test_writes_plan_and_csv(self):
        done = self.ok("plan", CELL, "swing", "-o", "p.json", "--csv", "p.csv", "--rate", "100")
        for words in ("query swing", "path planning", "total", "ms", "motion duration",
                      "least clearance", "rungs:", "written: p.json", "written: p.csv"):
            self.assertIn(words, done.out)
        plan = json.loads((self.folder / "p.json").read_text())
        self.assertEqual((plan["query"], plan["seed"]), ("swing", 1))
        self.assertEqual((self.folder / plan["workcell"]).resolve(), CELL)
        with (self.folder / "p.csv").open(encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0][:4], ["t", "left/yaw.q", "left/yaw.qd", "left/yaw.qdd"])
        self.assertEqual([float(x) for x in rows[1][1::3]], plan["start"])
        self.assertEqual(float(rows[-1][0]), plan["report"]["motion_duration_s"])
        for end, value in zip(rows[-1][1::3], plan["goal"]):
            self.assertAlmostEqual(float(end), value, places=9)

    def test_json_is_the_plan_file(self):
        done = self.ok("plan", CELL, "swing", "--json", "-o", "p.json", "--seed", "7")
        self.assertEqual(done.out, (self.folder / "p.json").read_text())
        self.assertEqual(json.loads(done.out)["seed"], 7)

    def test_same_seed_same_motion(self):
        motions = []
        for _ in range(2):
            plan = json.loads(self.ok("plan", CELL, "swing", "--json", "--seed", "3").out)
            motions.append((plan["arms"], plan["phases"]))
        self.assertEqual(motions[0], motions[1])

    def test_never_overwrites_unless_asked(self):
        for option in ("-o", "--csv"):
            (self.folder / "mine").write_text("mine")
            self.refused(2, "plan", CELL, "swing", option, "mine", says=("mine exists", "--force"))
            self.assertEqual((self.folder / "mine").read_text(), "mine")
            self.ok("plan", CELL, "swing", option, "mine", "--force")
            self.assertNotEqual((self.folder / "mine").read_text(), "mine")

    def test_refuses_outputs_before_planning(self):
        self.refused(2, "plan", CELL, "swing", "-o", "no/p.json", says="create it first")
        self.refused(2, "plan", CELL, "swing", "-o", "a", "--csv", "a", says="same file")
        self.refused(2, "plan", CELL, "swing", "-o", "/dev/null", "--force", says="regular file")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_unknown_query_names_the_nearest(self):
        self.refused(2, "plan", CELL, "swnig", says=("swnig", "did you mean 'swing'?"))

    def test_infeasible_and_too_late_are_exit_1_and_write_nothing(self):
        self.refused(1, "plan", CELL, "swing", "--deadline", "1e-9", "-o", "p.json",
                     says="deadline")
        low = self.cell_with(lambda text: text.replace("[-0.9, -0.2, 0.3]", "[-0.9, 0.9, 0.3]"))
        done = self.refused(1, "plan", low, "swing", "-o", "p.json", "--csv", "p.csv",
                            says=("goal of query 'swing'", "table"))
        self.assertEqual(done.err.count("\n"), 1)
        self.assertFalse((self.folder / "p.json").exists() or (self.folder / "p.csv").exists())


class Check(CommandLine):
    def test_shows_the_cell(self):
        text = self.ok("check", CELL).out
        for words in ("workcell two_small_arms", "left/elbow", "2.400", "100.000", "table", "1 box",
                      "1 sphere", "pairs: ", "skipped: ", "query swing: feasible"):
            self.assertIn(words, text)
        self.assertNotIn("checked: ", text)

    def test_pairs_lists_each(self):
        text = self.ok("check", CELL, "--pairs").out
        checked, skipped = map(int, re.search(r"pairs: (\d+) checked, (\d+) skipped", text).groups())
        self.assertEqual(len(re.findall(r"(?m)^checked: ", text)), checked)
        self.assertEqual(len(re.findall(r"(?m)^skipped: ", text)), skipped)

    def test_json(self):
        cell = json.loads(self.ok("check", CELL, "--json", "--pairs").out)
        self.assertEqual([arm["name"] for arm in cell["arms"]], ["left", "right"])
        self.assertIsNone(cell["arms"][0]["joints"][2]["jerk"])
        self.assertEqual(len(cell["pairs"]["list"]),
                         cell["pairs"]["checked"] + cell["pairs"]["skipped"])
        self.assertEqual([(query["name"], query["feasible"]) for query in cell["queries"]],
                         [("swing", True), ("rise", True)])
        self.assertEqual(cell["queries"][0]["start"]["q"], [0.9, -0.2, 0.3, 0.5, -0.9, 0.4])
        self.assertEqual(cell["queries"][1]["goal"]["touching"], [])
        self.assertEqual(cell["bodies"][0]["pieces"], {"sphere": 1})
        self.assertEqual(cell["robots"][0]["urdf"], str(CELL.parent / "arm.urdf"))

    def test_obstacles_go_to_moveit_and_come_back(self):
        self.ok("check", CELL, "--export-scene", "out.scene")
        scene = (self.folder / "out.scene").read_text()
        self.assertTrue(scene.startswith("two_small_arms\n* table\n0 0 -0.06\n0 0 0 1\n1\nbox\n"))
        self.assertTrue(scene.endswith("\n.\n"))
        self.refused(2, "check", CELL, "--export-scene", "out.scene", says="--force")
        cell = self.cell_with(lambda text: re.sub(r"obstacles:\n(  - .*\n)+", "scene: out.scene\n",
                                                  text))
        self.assertNotIn("obstacles", cell.read_text())
        # Another file in another folder: the robots' table names their files.
        before, after = (json.loads(self.ok("check", file, "--json").out) for file in (CELL, cell))
        for key in ("bodies", "pairs", "queries"):
            self.assertEqual(after[key], before[key])
        self.ok("check", cell, "--export-scene", "again.scene")
        self.assertEqual((self.folder / "again.scene").read_text(), scene)

    def test_infeasible_query_is_exit_1_with_pair_and_depth(self):
        low = self.cell_with(lambda text: text.replace("[0.9, -0.2, 0.3]", "[0.9, 0.9, 0.3]", 1))
        done = Done("check", low)
        self.assertEqual(done.code, 1)
        self.assertRegex(done.out, r"query swing: NOT feasible\n  start: .*table.* m deep\n")
        self.assertIn("1 of 2 queries are not feasible", done.err)
        queries = json.loads(Done("check", low, "--json").out)["queries"]
        self.assertEqual([query["feasible"] for query in queries], [False, True])
        touching = queries[0]["start"]["touching"]
        self.assertIn("table", (touching[0]["a"], touching[0]["b"]))
        depths = [pair["depth_m"] for pair in touching]
        self.assertTrue(all(depth >= 0 for depth in depths))
        self.assertEqual(depths, sorted(depths, reverse=True))

    def test_every_touching_pair_and_joint_out_of_limits_is_named(self):
        bad = self.cell_with(lambda text: text.replace("[0.9, -0.2, 0.3]", "[3, 1.5, -2.5]", 1))
        done = Done("check", bad)
        self.assertEqual(done.code, 1)
        for words in ("start: joint 'left/yaw' is at 3, 0.2 above its upper limit 2.8",
                      "start: joint 'left/lift' is at 1.5, 0.5 above its upper limit 1",
                      "start: joint 'left/elbow' is at -2.5, 0.1 below its lower limit -2.4",
                      "left/upper and table", "left/fore and table"):
            self.assertIn(words, done.out)
        start = json.loads(Done("check", bad, "--json").out)["queries"][0]["start"]
        self.assertEqual([entry["joint"] for entry in start["outside_limits"]],
                         ["left/yaw", "left/lift", "left/elbow"])
        self.assertAlmostEqual(start["outside_limits"][2]["excess"], 0.1)
        self.assertGreaterEqual(len(start["touching"]), 2)

    def test_suggests_pairs_as_srdf(self):
        bare = self.cell_with(lambda text: text.replace("    srdf: arm.srdf\n", "")
                              .replace("group: arm", "base: base, tip: fore")
                              .replace("{state: up}", "{joints: [0, -1.4, 0.6]}"))
        self.assertIn("--suggest-pairs", Done("check", bare).out)
        text = self.ok("check", bare, "--suggest-pairs", "--samples", "500").out
        pairs = ElementTree.fromstring(f"<robot>{text}</robot>").findall("disable_collisions")
        named = {(pair.get("link1"), pair.get("link2")): pair.get("reason") for pair in pairs}
        self.assertEqual(named[("shoulder", "upper")], "Adjacent")
        self.assertEqual(named[("upper", "fore")], "Adjacent")
        self.assertEqual(text.count("<!-- arm: "), 1)  # Two robots of one description.
        self.assertEqual(text, self.ok("check", bare, "--suggest-pairs", "--samples", "500").out)
        answer = json.loads(self.ok("check", bare, "--suggest-pairs", "--json").out)
        self.assertEqual(answer["samples"], 10000)
        self.assertEqual(answer["robots"][0]["pairs"][0]["reason"], "Adjacent")
        # What the SRDF disables is not proposed again.
        self.assertNotIn('link1="upper" link2="fore"', self.ok("check", CELL, "--suggest-pairs").out)
        self.refused(2, "check", CELL, "--suggest-pairs", "--samples", "0", says="samples")


class Verify(CommandLine):
    def setUp(self):
        super().setUp()
        self.ok("plan", CELL, "swing", "-o", "p.json")

    def change(self, edit):
        plan = json.loads((self.folder / "p.json").read_text())
        edit(plan)
        (self.folder / "bad.json").write_text(json.dumps(plan))

    def test_good_plan(self):
        done = self.ok("verify", "p.json", "--rate", "500")
        for words in ("least clearance", "worst limit ratio", "verdict: good"):
            self.assertIn(words, done.out)
        report = json.loads(self.ok("verify", "p.json", "--json").out)
        self.assertTrue(report["ok"])
        self.assertGreater(report["least_clearance_m"], 0)
        self.assertLessEqual(report["worst_limit_ratio"], 1 + 1e-6)

    def test_a_motion_through_the_post_fails_with_time_and_pair(self):
        def through_the_post(plan):
            for arm in plan["arms"]:
                arm["knots"] = [0, 60]
                start, goal = ((plan[end][:3] if arm["name"] == "left" else plan[end][3:])
                               for end in ("start", "goal"))
                arm["coefficients"] = [[[a, 0, 3 * (b - a) / 60**2, -2 * (b - a) / 60**3]
                                        for a, b in zip(start, goal)]]
            plan["report"]["motion_duration_s"] = 60
        self.change(through_the_post)
        done = Done("verify", "bad.json", folder=self.folder)
        self.assertEqual(done.code, 1, done)
        self.assertIn("verdict: bad", done.out)
        self.assertIn("failure: ", done.out)
        self.assertIn("tandem verify: bad.json fails: ", done.err)

    def test_too_fast_is_a_failure(self):
        def hurry(plan):
            for arm in plan["arms"]:
                arm["knots"] = [t / 2 for t in arm["knots"]]
                arm["coefficients"] = [[[c * 2**k for k, c in enumerate(row)] for row in segment]
                                       for segment in arm["coefficients"]]
            plan["report"]["motion_duration_s"] = max(arm["knots"][-1] for arm in plan["arms"])
        self.change(hurry)
        done = Done("verify", "bad.json", "--json", folder=self.folder)
        self.assertEqual(done.code, 1, done)
        report = json.loads(done.out)
        self.assertFalse(report["ok"])
        self.assertGreater(report["worst_limit_ratio"], 1)
        self.assertTrue(any("acceleration" in reason for reason in report["failures"]), report)

    def test_other_joints_or_arms_fail(self):
        def rename_joint(plan):
            plan["arms"][0]["joints"][1] = "left/wrist"

        def rename_arm(plan):
            plan["arms"][0]["name"] = "middle"
            plan["report"]["arms"]["middle"] = plan["report"]["arms"].pop("left")
        self.change(rename_joint)
        self.refused(1, "verify", "bad.json", says=("left/wrist", "left/lift"))
        self.change(rename_arm)
        self.refused(1, "verify", "bad.json", says=("middle", "left, right"))

    def test_workcell_that_is_not_there(self):
        self.change(lambda plan: plan.update(workcell="gone.yaml"))
        self.refused(2, "verify", "bad.json", says="gone.yaml")
        self.ok("verify", "bad.json", "--workcell", CELL)
        self.change(lambda plan: plan.update(workcell=""))
        self.refused(2, "verify", "bad.json", says="--workcell")


class Lists(CommandLine):
    """A cell with a list in which the left arm carries a stick."""
    LISTS = """lists:
  round:
    - name: swing
      start: {left: {joints: [0.9, -0.2, 0.3]}, right: {joints: [0.5, -0.9, 0.4]}}
      goal: {left: {joints: [-0.9, -0.2, 0.3]}}
    - name: carry
      attach: [{object: stick, arm: left, at: {xyz: [0.04, 0, 0]}}]
      goal: {left: {joints: [0.9, -0.2, 0.3]}}
    - name: leave
      detach: [{object: stick, place: {xyz: [-0.9, 0, 0.3]}}]
      goal: {left: {state: up}}
"""

    def setUp(self):
        super().setUp()
        stick = "  - {name: stick, pose: {xyz: [-0.9, 0, 0.3]}, sphere: {center: [0, 0, 0], radius: 0.02}}\n"
        self.cell = self.cell_with(
            lambda text: text.replace("padding:", stick + "padding:") + self.LISTS)

    def test_check_covers_all_lists(self):
        out = self.ok("check", self.cell).out
        for name in ("swing", "rise", "round/swing", "round/carry", "round/leave"):
            self.assertIn(f"query {name}: feasible", out)

    def test_plan_records_the_scene_and_verify_and_view_rebuild_it(self):
        self.ok("plan", self.cell, "round/carry", "-o", "p.json")
        plan = json.loads((self.folder / "p.json").read_text())
        self.assertEqual(plan["query"], "round/carry")
        stick, = plan["scene"]["objects"]
        self.assertEqual((stick["name"], stick["link"]), ("stick", "left/fore"))
        self.assertAlmostEqual(stick["pose"]["xyz"][0], 0.34)
        self.ok("verify", "p.json")
        # The same motion with the stick through the table all the way.
        stick["pose"]["xyz"] = [-0.1, 0, 0]
        stick["link"] = "left/shoulder"
        (self.folder / "bad.json").write_text(json.dumps(plan))
        done = Done("verify", "bad.json", folder=self.folder)
        self.assertEqual(done.code, 1, done)
        self.assertRegex(done.out, "failure: .*stick.* touch")
        stick["link"] = "left/for"
        (self.folder / "bad.json").write_text(json.dumps(plan))
        self.refused(2, "verify", "bad.json", says=("left/for", "did you mean 'left/fore'"))
        page = Done("view", "p.json", "--export", "p.html", folder=self.folder)
        if page.code == 0:
            text = (self.folder / "p.html").read_text()
            self.assertRegex(text, r'"name":"stick","kind":"attached"|"kind":"attached"[^}]*"name":"stick"')

    def test_bench_runs_one_list(self):
        self.assertIn("list round", self.ok("bench", self.cell, "--list", "round", "--json",
                                            "b.json").out)
        bench = json.loads((self.folder / "b.json").read_text())
        self.assertEqual((bench["list"], bench["queries"], bench["success"]), ("round", 3, 3))
        self.assertIn("round/carry", bench["per_query"])
        self.ok("bench", self.cell, "--json", "c.json")
        bench = json.loads((self.folder / "c.json").read_text())
        self.assertEqual((bench["list"], bench["queries"]), ("", 2))

    def test_names_that_do_not_exist(self):
        self.refused(2, "bench", self.cell, "--list", "runde", says="did you mean 'round'")
        self.refused(2, "plan", self.cell, "round/cary", says="did you mean 'round/carry'")
        self.refused(2, "plan", self.cell, "round", says=("a list of this name", "round/swing"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)

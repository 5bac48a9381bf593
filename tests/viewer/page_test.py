#!/usr/bin/python3
"""The page's own tests, alone or in a browser with plans.

usage: page_test.py unit|browser|pictures PROGRAM SOURCE_FOLDER

pictures: only the comparisons with tests/viewer/pictures. With TANDEM_UPDATE_PICTURES=1 in the
environment they take what they see for right; look at it before you commit it.

Exit codes: 0 passed, 77 skipped (the reason is printed), otherwise that of the tests.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PART, PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
CELL = SOURCE / "scenarios/gearbox/workcell.yaml"
SMALL_CELL = SOURCE / "tests/viewer/cell/workcell.yaml"
GUARDED = "TANDEM_PAGE_TEST_GUARDED"
DURATION = 1.6  # [s] of the motion in the pictures.


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def npm(script, *arguments, **environment):
    return subprocess.run(["npm", "run", "--silent", script, "--", *arguments], check=False,
                          cwd=SOURCE / "viewer", env={**os.environ, **environment}).returncode


def tandem(*arguments):
    return subprocess.run([PROGRAM, *arguments], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def exported(cell, folder, change=lambda plan: None):
    """A page with a plan of the cell's first query, after `change`."""
    query = json.loads(tandem("check", cell, "--json"))["queries"][0]["name"]
    plan, page = folder / f"{cell.parent.name}.json", folder / f"{cell.parent.name}.html"
    tandem("plan", cell, query, "-o", plan)
    content = json.loads(plan.read_text())
    change(content)
    plan.write_text(json.dumps(content))
    tandem("view", plan, "--workcell", cell, "--export", page)
    return page


def straighten(plan):
    """From start to goal in one cubic, at rest at both ends: the same whatever plans."""
    ends = iter(zip(plan["start"], plan["goal"]))
    for arm in plan["arms"]:
        steps = [next(ends) for _ in arm["joints"]]
        arm["knots"] = [0, DURATION]
        arm["coefficients"] = [[[a, 0, 3 * (b - a) / DURATION**2, -2 * (b - a) / DURATION**3]
                                for a, b in steps]]
    plan["phases"] = []
    plan["report"]["motion_duration_s"] = DURATION


def browser_tests(folder):
    chromium = os.environ.get("TANDEM_CHROMIUM") or shutil.which("chromium")
    if not chromium:
        skip("there is no chromium on the PATH; tools/setup installs it")
    small = str(exported(SMALL_CELL, folder, straighten))
    if PART == "pictures":
        return npm("test:browser", "pictures", TANDEM_SMALL_PAGE=small, CHROMIUM=chromium)
    page = str(exported(CELL, folder))
    with subprocess.Popen([PROGRAM, "view", CELL, "--no-open"], stdout=subprocess.PIPE,
                          text=True) as server:
        address = server.stdout.readline().strip()
        try:
            return npm("test:browser", TANDEM_PAGE=page, TANDEM_SMALL_PAGE=small,
                       TANDEM_URL=address, CHROMIUM=chromium)
        finally:
            server.terminate()


def main():
    if not shutil.which("npm") or not (SOURCE / "viewer/node_modules").is_dir():
        skip("the page's tools are not installed; run tools/setup")
    if PART == "unit":
        return npm("test")
    with tempfile.TemporaryDirectory() as folder:
        return browser_tests(Path(folder))


def guarded():
    """Runs the tests in a process group that ends with this process, however that ends."""
    command = [sys.executable, __file__, *sys.argv[1:]]
    environment = {**os.environ, GUARDED: "1"}
    with subprocess.Popen(command, start_new_session=True, env=environment) as tests:
        # The group is killed when nobody can write to the guard any more.
        guard = ["sh", "-c", 'read -r _; kill -KILL "-$0" 2>/dev/null', str(tests.pid)]
        with subprocess.Popen(guard, start_new_session=True, stdin=subprocess.PIPE):
            return tests.wait()


if __name__ == "__main__":
    sys.exit(main() if GUARDED in os.environ else guarded())

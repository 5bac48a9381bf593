#!/usr/bin/python3
"""The page's own tests, alone or in a browser with a plan of the gearbox cell.

usage: page_test.py unit|browser PROGRAM SOURCE_FOLDER

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


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def npm(script, **environment):
    return subprocess.run(["npm", "run", "--silent", script], cwd=SOURCE / "viewer", check=False,
                          env={**os.environ, **environment}).returncode


def tandem(*arguments):
    return subprocess.run([PROGRAM, *arguments], check=True, capture_output=True, text=True).stdout


def browser_tests(folder):
    chromium = os.environ.get("TANDEM_CHROMIUM") or shutil.which("chromium")
    if not chromium:
        skip("there is no chromium on the PATH; tools/setup installs it")
    query = json.loads(tandem("check", CELL, "--json"))["queries"][0]["name"]
    plan, page = folder / "plan.json", folder / "page.html"
    tandem("plan", CELL, query, "-o", plan)
    tandem("view", plan, "--export", page)
    with subprocess.Popen([PROGRAM, "view", CELL, "--no-open"], stdout=subprocess.PIPE,
                          text=True) as server:
        address = server.stdout.readline().strip()
        try:
            return npm("test:browser", TANDEM_PAGE=str(page), TANDEM_URL=address, CHROMIUM=chromium)
        finally:
            server.terminate()


def main():
    if not shutil.which("npm") or not (SOURCE / "viewer/node_modules").is_dir():
        skip("the page's tools are not installed; run tools/setup")
    if PART == "unit":
        return npm("test")
    with tempfile.TemporaryDirectory() as folder:
        return browser_tests(Path(folder))


if __name__ == "__main__":
    sys.exit(main())

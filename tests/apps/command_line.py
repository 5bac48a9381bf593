"""What tests of the tandem program share. Their usage: PROGRAM SOURCE_FOLDER"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
CELL = SOURCE / "tests/apps/cell/workcell.yaml"
COMMANDS = ("plan", "check", "verify", "bench", "fit", "view")


class Done:
    """A finished call of the program."""

    def __init__(self, *arguments, folder=None):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True,
                              check=False, cwd=folder, timeout=120, stdin=subprocess.DEVNULL)
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr

    def __str__(self):
        return f"exit {self.code}\n{self.out}\n{self.err}"


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.holder = tempfile.TemporaryDirectory()
        self.folder = Path(self.holder.name)
        self.addCleanup(self.holder.cleanup)

    def ok(self, *arguments):
        done = Done(*arguments, folder=self.folder)
        self.assertEqual(done.code, 0, done)
        return done

    def refused(self, code, *arguments, says=()):
        """Exit code, words on stderr, and nothing on stdout."""
        done = Done(*arguments, folder=self.folder)
        self.assertEqual(done.code, code, done)
        self.assertEqual(done.out, "", done)
        for words in (says,) if isinstance(says, str) else says:
            self.assertIn(words, done.err)
        return done

    def cell_with(self, change):
        """The small cell's text after `change`, beside its robot's files."""
        for source in CELL.parent.iterdir():
            (self.folder / source.name).write_text(source.read_text())
        file = self.folder / "workcell.yaml"
        file.write_text(change(file.read_text()))
        return file

"""Starts the program for the system tests, on a track so small that a run takes a moment."""

import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

PATIENCE = 120  # s until a test gives up on something; nothing is measured

PROGRAM = os.environ["MELTSCOPE_PROGRAM"]
SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "scenarios"
QUICK_LOOK = SCENARIOS / "quick_look.toml"

# quick_look with 2500 cells: about 70 steps of 4 us at most, seven outputs.
SMALL = ["--set", "domain.cell_size=40 um", "--set", "time.max_step=4 us", "--set", "time.end=0.28 ms",
         "--set", "output.every=40 us"]


def meltscope(*arguments, **options):
    """Runs the program to its end; the result has returncode, stdout and stderr (text)."""
    words = [PROGRAM, *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, timeout=2 * PATIENCE, stdin=subprocess.DEVNULL, **options)


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="meltscope_system_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_small(self, name, *arguments):
        """A run of the small track without pictures, into folder / name; it must succeed."""
        return self.must_succeed("run", QUICK_LOOK, *SMALL, "--no-render", "--output", self.folder / name, *arguments)

    def must_succeed(self, *arguments):
        result = meltscope(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def must_refuse(self, *arguments):
        """The program must end with exit code 2; returns what it said on standard error."""
        result = meltscope(*arguments, cwd=self.folder)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertNotIn("std::", result.stderr)
        self.assertNotIn("terminate", result.stderr)
        return result.stderr


def checkpoints(run):
    return sorted((run / "checkpoints").glob("step_*.h5"))


def stop_for_a_while(process):
    """Stops the process until SIGCONT lets it go on; returns once none of its threads runs."""
    process.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)

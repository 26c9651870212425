"""What a run does when the system fails it: no space, no permission, a folder that goes away, a quota."""

import json
import os
import resource
import shutil
import signal
import stat
import subprocess
import time
import unittest
import xml.etree.ElementTree as xml

from program import PATIENCE, PROGRAM, QUICK_LOOK, SMALL, ProgramTest, checkpoints, meltscope, stop_for_a_while

# Goes on until it is stopped, with files and a checkpoint every few steps.
ENDLESS = ["--set", "domain.cell_size=40 um", "--set", "time.max_step=1 us", "--set", "time.end=10 s", "--set",
           "output.every=40 us", "--set", "checkpoint.every=20 us", "--set", "checkpoint.keep=2"]


class Faults(ProgramTest):
    def setUp(self):
        super().setUp()
        self.run_folder = self.folder / "run"

    def mounted(self, path, *options):
        """Mounts something at `path` until the end of the test; skips the test where that cannot be done."""
        path.mkdir(parents=True, exist_ok=True)
        result = subprocess.run(["mount", *options, str(path)], capture_output=True, text=True)
        if result.returncode != 0:
            self.skipTest(f"mounting needs root and a kernel that lets it: {result.stderr.strip()}")
        self.addCleanup(subprocess.run, ["umount", "--lazy", str(path)], check=False)

    def start(self, *more):
        process = subprocess.Popen([PROGRAM, "run", str(QUICK_LOOK), *ENDLESS, "--no-render", "--output",
                                    str(self.run_folder), *more],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_for_checkpoint(self, process):
        deadline = time.monotonic() + PATIENCE
        while not checkpoints(self.run_folder):
            self.assertIsNone(process.poll(), "ended before its first checkpoint")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)

    def must_fail(self, process, *words):
        """Exit code 1, with an error that holds the words; returns it."""
        _, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 1, errors)
        self.assertIn("error: ", errors)
        for word in words:
            self.assertIn(word, errors)
        return errors

    def nothing_half_is_left(self, run):
        """All under a final name is whole; the last checkpoint can be gone on from. Returns the checkpoints."""
        found = checkpoints(run)
        self.assertTrue(found)
        for path in found:
            self.must_succeed("info", path)
        for path in run.glob("*.pvd"):
            for entry in xml.parse(path).getroot().iter("DataSet"):
                data = (run / entry.get("file")).read_bytes()
                self.assertTrue(data.rstrip().endswith(b"</VTKFile>"), entry.get("file"))
        self.must_succeed("run", "--restart", found[-1], "--no-render", "--steps", 1, "--output", self.folder / "on")
        return found

    def test_a_full_disk_stops_the_run_and_leaves_the_checkpoint_before(self):
        self.mounted(self.run_folder, "-t", "tmpfs", "-o", "size=6m", "tmpfs")
        self.must_fail(self.start(), "No space left on device", str(self.run_folder))
        self.nothing_half_is_left(self.run_folder)

    def test_a_checkpoint_over_the_quota_stops_the_run_and_leaves_the_one_before(self):
        process = self.start()
        self.wait_for_checkpoint(process)
        stop_for_a_while(process)
        before = {path: path.read_bytes() for path in checkpoints(self.run_folder)}
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (200_000, resource.RLIM_INFINITY))
        process.send_signal(signal.SIGCONT)
        self.must_fail(process, "cannot write checkpoint", "File too large", "step_")
        after = self.nothing_half_is_left(self.run_folder)
        self.assertLessEqual(len(after), len(before) + 1)  # one may have been under way
        for path in set(before) & set(after):
            self.assertEqual(path.read_bytes(), before[path])
        self.assertEqual([path.name for path in (self.run_folder / "checkpoints").glob(".*")], [])

    def test_checkpoints_that_become_read_only_stop_the_run_and_stay(self):
        process = self.start()
        self.wait_for_checkpoint(process)
        folder = self.run_folder / "checkpoints"
        stop_for_a_while(process)  # a file opened between the two mounts would keep the second from being read-only
        self.mounted(folder, "--bind", str(folder))
        subprocess.run(["mount", "-o", "remount,ro,bind", str(folder)], check=True)
        process.send_signal(signal.SIGCONT)
        self.must_fail(process, "Read-only file system", str(folder))
        self.nothing_half_is_left(self.run_folder)

    def test_a_folder_that_cannot_be_written_to_is_named_before_the_run(self):
        self.mounted(self.run_folder, "-t", "tmpfs", "-o", "ro", "tmpfs")
        self.must_fail(self.start(), "Read-only file system", str(self.run_folder))

    def test_a_folder_without_permission_is_named_before_the_run(self):
        self.run_folder.mkdir()
        self.run_folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
        if os.access(self.run_folder, os.W_OK):
            self.skipTest("root may write anywhere")
        self.must_fail(self.start(), "Permission denied", str(self.run_folder))

    def test_a_checkpoint_into_a_folder_that_was_removed_stops_the_run(self):
        process = self.start("--set", "output.every=10 s")  # an output would make the folder again
        self.wait_for_checkpoint(process)
        while self.run_folder.exists():
            shutil.rmtree(self.run_folder, ignore_errors=True)
        self.must_fail(process, "No such file or directory", str(self.run_folder))
        self.assertFalse(self.run_folder.exists())


class Results(ProgramTest):
    def test_results_of_a_command_that_cannot_be_written_are_an_error(self):
        self.run_small("run", "--steps", 1)
        for words in (["check", QUICK_LOOK, *SMALL], ["info", self.folder / "run"], ["report", self.folder / "run"]):
            with self.subTest(words=words), open("/dev/full", "w", encoding="ascii") as full:
                result = subprocess.run([PROGRAM, *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True,
                                        timeout=PATIENCE)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("standard output: No space left on device", result.stderr)


class Locks(ProgramTest):
    def test_what_a_killed_run_leaves_is_recognised_and_taken_up(self):
        run = self.folder / "run"
        process = subprocess.Popen([PROGRAM, "run", str(QUICK_LOOK), *ENDLESS, "--no-render", "--output", str(run)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + PATIENCE
        while not checkpoints(run):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        process.kill()
        process.wait()
        self.assertEqual((run / "run.lock").read_text(), f"{process.pid}\n")
        self.must_succeed("run", "--restart", checkpoints(run)[-1], "--no-render", "--steps", 1)
        self.assertIn(f"the run of process {process.pid} in this folder ended without cleaning up",
                      (run / "log.txt").read_text())
        self.assertFalse((run / "run.lock").exists())


class Numbers(ProgramTest):
    def test_an_impossible_energy_stops_the_run_and_keeps_the_state_aside(self):
        run = self.folder / "run"
        result = meltscope("run", QUICK_LOOK, *SMALL, "--set", "checkpoint.every=4 us", "--set", "laser.power=1e9 W",
                           "--no-render", "--output", run)
        self.assertEqual(result.returncode, 1, result.stdout)
        for word in ("after step", "particle", "of in625", "Likely cause", "inspect_step_"):
            self.assertIn(word, result.stderr)
        summary = json.loads((run / "run.json").read_text())
        self.assertEqual(summary["outcome"], "failed")
        self.assertIn("particle", summary["message"])
        kept = list(run.glob("inspect_step_*.h5"))
        self.assertEqual(len(kept), 1)
        self.assertIn(f"step {int(kept[0].stem.split('_')[-1])}", self.must_succeed("info", kept[0]).stdout)
        self.assertNotIn(kept[0].name, [path.name for path in checkpoints(run)])
        self.run_small("run", "--overwrite", "--steps", 1)
        self.assertFalse(kept[0].exists())

    def test_a_restart_says_what_was_changed(self):
        self.run_small("run", "--steps", 10)
        start = checkpoints(self.folder / "run")[-1]
        result = self.must_succeed("run", "--restart", start, "--no-render", "--steps", 1, "--set", "laser.power=250 W",
                                   "--output", self.folder / "hot")
        self.assertIn("laser", result.stdout)
        self.assertIn("179.2", result.stdout)
        self.assertIn("250", result.stdout)
        same = self.must_succeed("run", "--restart", start, "--no-render", "--steps", 1, "--output",
                                 self.folder / "same")
        self.assertNotIn("changed", same.stdout)


if __name__ == "__main__":
    unittest.main()

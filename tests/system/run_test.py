"""What a run leaves, says and answers to signals."""

import json
import os
import pty
import select
import shutil
import signal
import subprocess
import time
import unittest

from program import PATIENCE, PROGRAM, QUICK_LOOK, SMALL, ProgramTest, checkpoints, meltscope

ENDLESS = ["--set", "time.end=10 s", "--set", "output.every=1 s", "--set", "domain.cell_size=40 um", "--set",
           "time.max_step=1 us"]


class Outputs(ProgramTest):
    def test_run_leaves_its_files_and_a_balanced_ledger(self):
        text = self.run_small("run").stdout
        run = self.folder / "run"
        for name in ("run.toml", "run.json", "log.txt", "melt_pool.csv", "particles.pvd", "surface.pvd", "pool.pvd"):
            self.assertTrue((run / name).is_file(), name)
        summary = json.loads((run / "run.json").read_text())
        self.assertEqual(summary["outcome"], "done")
        self.assertAlmostEqual(summary["time"], 0.28e-3, places=15)
        self.assertGreater(summary["ledger"]["absorbed"], 0.0)
        self.assertLessEqual(abs(summary["ledger"]["relative_residual"]), 1e-12)
        self.assertGreater(summary["rendering"]["files"], 0)
        self.assertGreaterEqual(summary["rendering"]["waits"], 0)
        self.assertEqual(summary["rendering"]["drops"], 0)
        self.assertIn("relative residual", text)
        self.assertIn(str(run / "melt_pool.csv"), text)
        self.assertFalse((run / "frames").exists())

    def test_outputs_come_at_multiples_of_the_interval_and_at_the_end(self):
        self.run_small("run", "--set", "time.end=0.25 ms")
        rows = (self.folder / "run" / "melt_pool.csv").read_text().splitlines()[1:]
        self.assertEqual([float(row.split(",")[0]) for row in rows], [k * 4e-5 for k in range(7)] + [2.5e-4])

    def test_every_steps_counts_steps(self):
        self.must_succeed("run", QUICK_LOOK, *SMALL[:6], "--set", 'output={every_steps=30}', "--no-render", "--output",
                          self.folder / "run")
        rows = (self.folder / "run" / "melt_pool.csv").read_text().splitlines()[1:]
        self.assertEqual(len(rows), 4)  # steps 0, 30, 60 and the end

    def test_a_pipe_gets_plain_lines(self):
        text = self.run_small("run").stdout
        self.assertNotIn("\r", text)
        self.assertNotIn("\x1b", text)
        self.assertEqual(len([line for line in text.splitlines() if line.startswith("step ")]), 8)

    def test_quiet_says_nothing(self):
        result = self.run_small("run", "--quiet")
        self.assertEqual(result.stdout + result.stderr, "")
        self.assertIn("relative residual", (self.folder / "run" / "log.txt").read_text())

    def test_a_terminal_gets_a_progress_line_that_fits(self):
        lines = self.on_terminal("run", QUICK_LOOK, *SMALL, "--no-render", "--output", self.folder / "run")
        progress = [line for line in lines.split("\r") if "%" in line]
        self.assertTrue(progress)
        for line in progress:
            self.assertLess(len(line.split("\n")[0].replace("\x1b[K", "")), 80)

    def on_terminal(self, *arguments):
        master, slave = pty.openpty()
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=slave, stderr=slave,
                                   stdin=subprocess.DEVNULL)
        os.close(slave)
        text = b""
        while True:
            try:
                part = os.read(master, 65536) if select.select([master], [], [], PATIENCE)[0] else b""
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
        os.close(master)
        self.assertEqual(process.wait(timeout=PATIENCE), 0, text)
        return text.decode()


class RunFolder(ProgramTest):
    def test_existing_run_is_refused_and_overwritten_only_when_told(self):
        self.run_small("run", "--steps", "3")
        stranger = self.folder / "run" / "notes.txt"
        stranger.write_text("mine")
        before = (self.folder / "run" / "run.json").read_bytes()
        message = self.must_refuse("run", QUICK_LOOK, *SMALL, "--no-render", "--output", self.folder / "run")
        self.assertIn("--overwrite", message)
        self.assertEqual((self.folder / "run" / "run.json").read_bytes(), before)
        self.run_small("run", "--overwrite", "--steps", "2")
        self.assertEqual(stranger.read_text(), "mine")

    def test_resolved_scenario_gives_the_same_run(self):
        self.run_small("a", "--set", "checkpoint.every=1 s")
        self.must_succeed("run", self.folder / "a" / "run.toml", "--no-render", "--output", self.folder / "b")
        for name in ("melt_pool.csv", "run.toml"):
            self.assertEqual((self.folder / "a" / name).read_bytes(), (self.folder / "b" / name).read_bytes())
        self.assertEqual(*[checkpoints(self.folder / run)[-1].read_bytes() for run in "ab"])

    def test_default_folder_is_named_after_the_scenario(self):
        result = meltscope("run", QUICK_LOOK, *SMALL, "--no-render", "--steps", "1", cwd=self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "runs" / "quick_look" / "run.json").is_file())


class Stops(ProgramTest):
    def start_endless(self):
        process = subprocess.Popen([PROGRAM, "run", str(QUICK_LOOK), *ENDLESS, "--no-render", "--output",
                                    str(self.folder / "run")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.wait_for(lambda: (self.folder / "run" / "melt_pool.csv").is_file() and
                      len((self.folder / "run" / "melt_pool.csv").read_text().splitlines()) > 1)
        return process

    def wait_for(self, condition):
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def test_signals_stop_with_a_checkpoint_and_exit_code_3(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number=number):
                process = self.start_endless()
                process.send_signal(number)
                _, errors = process.communicate(timeout=PATIENCE)
                self.assertEqual(process.returncode, 3, errors)
                summary = json.loads((self.folder / "run" / "run.json").read_text())
                self.assertEqual(summary["outcome"], "stopped")
                self.assertEqual([path.name for path in checkpoints(self.folder / "run")],
                                 [f"step_{summary['steps']:09d}.h5"])
                for path in sorted((self.folder / "run").rglob("*"), reverse=True):
                    path.rmdir() if path.is_dir() else path.unlink()
                (self.folder / "run").rmdir()

    def test_sigusr1_makes_a_checkpoint_and_goes_on(self):
        process = self.start_endless()
        process.send_signal(signal.SIGUSR1)
        self.wait_for(lambda: checkpoints(self.folder / "run"))
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 3)

    def must_end_within_its_limit(self, *arguments, **options):
        """A run that would go on for hours ends with a checkpoint within 3 s, by its own clock.

        20 s more are granted to a machine that has other things to do. Its next output is hours away, too."""
        result = meltscope("run", QUICK_LOOK, *ENDLESS, "--output", self.folder / "run", "--wall-limit", "00:00:03",
                           *arguments, **options)
        self.assertEqual(result.returncode, 3, result.stderr)
        summary = json.loads((self.folder / "run" / "run.json").read_text())
        self.assertEqual(summary["outcome"], "stopped")
        self.assertIn("wall limit of 0:00:03", summary["message"])
        self.assertLess(summary["wall_seconds"]["total"], 3 + 20)
        self.assertEqual([path.name for path in checkpoints(self.folder / "run")], [f"step_{summary['steps']:09d}.h5"])
        return result.stdout

    def test_wall_limit_ends_a_run_in_time_with_a_checkpoint(self):
        self.must_end_within_its_limit("--no-render")

    @unittest.skipUnless(shutil.which("Xvfb"), "no Xvfb")
    def test_wall_limit_is_kept_though_the_movie_would_take_a_minute(self):
        (self.folder / "ffmpeg").write_text("#!/bin/sh\nsleep 60\n")
        (self.folder / "ffmpeg").chmod(0o755)
        path = os.pathsep.join([str(self.folder), os.environ["PATH"]])
        words = self.must_end_within_its_limit("--set", "render.size=[320,180]", env={**os.environ, "PATH": path})
        self.assertTrue(list((self.folder / "run" / "frames").glob("*.png")))
        self.assertIn(f"meltscope movie {self.folder / 'run'}", words)

    def test_a_second_run_cannot_have_the_folder(self):
        process = self.start_endless()
        message = self.must_refuse("run", QUICK_LOOK, *SMALL, "--no-render", "--overwrite", "--output",
                                   self.folder / "run")
        self.assertIn(str(process.pid), message)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=PATIENCE)


if __name__ == "__main__":
    unittest.main()

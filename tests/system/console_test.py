"""Runs are steered through pipes and scripts; replays end in the same bits."""

import subprocess
import unittest

from program import PATIENCE, PROGRAM, QUICK_LOOK, checkpoints, meltscope
from steered import Steered, journal_of, run_words


class Pipes(Steered):
    def test_lines_after_run_wait_and_answers_name_old_and_new(self):
        result = self.piped("run", ["run 10", "power 250 W", "status", "run"])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"laser\.power: 179\.2 W -> 250 W \(step 10, t = ")
        self.assertRegex(journal_of(self.folder / "run")[0], r"^at step 10 t=\S+: set laser\.power 250 W$")
        self.assertNotIn("\r", result.stdout)
        self.assertNotIn("\033", result.stdout)

    def test_the_end_of_the_pipe_stops_the_run_with_a_checkpoint(self):
        result = self.piped("run", ["step 7"])
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, "step_000000007.h5")

    def test_an_error_stops_with_its_line_a_checkpoint_and_exit_code_2(self):
        script = self.folder / "steer.txt"
        script.write_text("# first\nstep 5\npower 200 parsecs\nrun\n")
        result = subprocess.run(run_words(self.folder / "run", "--script", script), capture_output=True, text=True,
                                timeout=PATIENCE, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, 2)
        self.assertIn(f"{script}:3: power 200 parsecs: ", result.stderr)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, "step_000000005.h5")

    def test_after_a_script_the_run_goes_on_to_its_end(self):
        script = self.folder / "steer.txt"
        script.write_text("at 0.1 ms power 250 W\nstep 5\npool\n")
        result = subprocess.run(run_words(self.folder / "run", "--script", script), capture_output=True, text=True,
                                timeout=PATIENCE, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [row.split(",") for row in (self.folder / "run" / "melt_pool.csv").read_text().splitlines()[1:]]
        self.assertEqual([float(row[3]) for row in rows if 0 < float(row[0]) < 0.75e-3],
                         [179.2] * 2 + [250.0] * (len(rows) - 3))

    def test_a_reader_that_goes_away_does_not_take_the_run_along(self):
        process = subprocess.Popen(run_words(self.folder / "run", "--repl"), stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        process.stdout.close()
        process.stdin.write("run\n")
        process.stdin.close()
        self.assertEqual(process.wait(timeout=PATIENCE), 0)
        self.assertTrue(checkpoints(self.folder / "run"))

    def test_a_missing_script_is_refused_before_anything_is_touched(self):
        result = meltscope("run", QUICK_LOOK, "--script", "nowhere.txt", "--output", self.folder / "run")
        self.assertEqual(result.returncode, 2)
        self.assertFalse((self.folder / "run").exists())


class Replay(Steered):
    SESSION = ["run 5", "power 230 W", "at 0.15 ms spot 90 um", "run 30 us", "set output.every 30 us",
               "path line 0.4 mm 0.3 mm speed 1.2", "set boundary.z_min temperature 350 K", "step 9", "off", "step 2",
               "on", "set physics.radiation on", "run"]

    def test_a_session_replays_bit_for_bit_also_with_two_threads(self):
        result = self.piped("run", self.SESSION, "--threads", 1)
        self.assertEqual(result.returncode, 0, result.stderr)
        journal = self.folder / "run" / "journal.txt"
        self.assertGreaterEqual(len(journal_of(self.folder / "run")), 8)
        for threads in (1, 2):
            self.assert_same_end(self.folder / "run", self.replay(f"again_{threads}", journal, "--threads", threads))

    def test_a_session_that_is_quit_and_taken_up_replays_bit_for_bit(self):
        self.assertEqual(self.piped("run", [*self.SESSION[:8], "quit"]).returncode, 3)
        stopped = self.replay("stopped", self.folder / "run" / "journal.txt", code=3)
        self.assert_same_end(self.folder / "run", stopped)
        start = checkpoints(self.folder / "run")[-1]
        result = subprocess.run([PROGRAM, "run", "--restart", str(start), "--no-render", "--repl"],
                                input="power 200\nrun 5\nspot 95 um\nrun\n", capture_output=True, text=True,
                                timeout=PATIENCE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_same_end(self.folder / "run", self.replay("again", self.folder / "run" / "journal.txt"))

    def test_an_interval_between_outputs_replays_bit_for_bit(self):
        self.assertEqual(self.piped("run", ["power 200", "run"], "--until", "0.1 ms").returncode, 0)
        self.must_succeed("run", "--restart", checkpoints(self.folder / "run")[-1], "--no-render")
        self.assert_same_end(self.folder / "run", self.replay("again", self.folder / "run" / "journal.txt"))

    def test_restore_goes_back_and_the_replay_leads_to_the_same_end(self):
        kept = self.folder / "kept.h5"
        result = self.piped("run", ["run 20", "power 210", f"save {kept}", "power 300", "run 30", f"restore {kept}",
                                    "step 3", "spot 90 um", "run"])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_same_end(self.folder / "run", self.replay("again", self.folder / "run" / "journal.txt"))
        times = [float(row.split(",")[0]) for row in
                 (self.folder / "run" / "melt_pool.csv").read_text().splitlines()[1:]]
        self.assertEqual(times, sorted(set(times)))

    def test_restore_to_an_output_leaves_its_row_where_it_was(self):
        kept = self.folder / "kept.h5"
        result = self.piped("run", ["until t=80 us", f"save {kept}", "step 5", f"restore {kept}", "run"])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.run_small("plain")
        tables = [(self.folder / name / "melt_pool.csv").read_text() for name in ("run", "plain")]
        self.assertEqual(*tables)

    HOTTER = ["--set", "laser.power=260 W", "--set", "material.in625.latent_heat=250 kJ/kg",
              "--set", 'render.views=["top", "section"]', "--set", "time.end=0.2 ms"]

    def stopped_after(self, name, steps):
        self.assertEqual(self.piped(name, ["power 200", f"step {steps}"]).returncode, 3)
        return checkpoints(self.folder / name)[-1]

    def test_a_restart_with_changed_values_is_in_the_journal_and_replays_bit_for_bit(self):
        start = self.stopped_after("run", 17)
        result = subprocess.run([PROGRAM, "run", "--restart", str(start), "--no-render", "--repl", *self.HOTTER],
                                input="step 4\nspot 90 um\nrun\n", capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(result.returncode, 0, result.stderr)
        journal = self.folder / "run" / "journal.txt"
        entries = journal_of(self.folder / "run")
        self.assertEqual(len(entries), 3)
        self.assertRegex(entries[1], r'^at step 17 t=\S+: adopt "laser\.power=260 W" .* under [0-9a-f]{16}$')
        for threads in (1, 2):
            self.assert_same_end(self.folder / "run", self.replay(f"again_{threads}", journal, "--threads", threads))
        # run.toml is the scenario that the journal goes on from
        self.must_succeed("run", self.folder / "run" / "run.toml", "--no-render", "--replay", journal, "--output",
                          self.folder / "kept")
        self.assert_same_end(self.folder / "run", self.folder / "kept")

    def test_a_replay_from_another_scenario_than_the_journal_began_with_is_refused(self):
        start = self.stopped_after("run", 5)
        self.must_succeed("run", "--restart", start, "--no-render", *self.HOTTER)
        result = subprocess.run(run_words(self.folder / "again", "--set", "laser.power=260 W", "--replay",
                                          self.folder / "run" / "journal.txt"),
                                capture_output=True, text=True, timeout=PATIENCE, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, 2)
        self.assertIn("another scenario", result.stderr)

    def test_a_restart_under_another_file_replays_from_its_checkpoint_only(self):
        start = self.stopped_after("run", 5)
        kept = self.folder / "kept.h5"
        kept.write_bytes(start.read_bytes())
        other = self.folder / "other.toml"
        other.write_text((self.folder / "run" / "run.toml").read_text().replace("power = 179.2", "power = 150.0"))
        self.must_succeed("run", other, "--restart", kept, "--no-render", "--output", self.folder / "rest")
        journal = self.folder / "rest" / "journal.txt"
        self.assertIn("adopt scenario", journal.read_text())
        result = subprocess.run(run_words(self.folder / "again", "--replay", journal), capture_output=True, text=True,
                                timeout=PATIENCE, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, 2)
        self.assertIn("which the journal does not hold", result.stderr)
        self.must_succeed("run", other, "--restart", kept, "--no-render", "--replay", journal, "--output",
                          self.folder / "same")
        self.assert_same_end(self.folder / "rest", self.folder / "same")

    def test_adopt_at_the_prompt_is_the_same_as_a_restart_with_set(self):
        result = self.piped("run", ["power 200", "step 17", "adopt 'laser.power=260 W' time.end=0.2ms",
                                    "step 4", "run"])
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("laser.power: 200 W -> 260 W", result.stdout)
        start = self.stopped_after("cut", 17)
        self.must_succeed("run", "--restart", start, "--no-render", "--set", "laser.power=260 W", "--set",
                          "time.end=0.2ms")
        self.assert_same_end(self.folder / "run", self.folder / "cut")

    def test_a_journal_of_another_run_is_refused(self):
        journal = self.folder / "other.txt"
        journal.write_text("at step 4 t=1: set laser.power 200 W\n")
        self.replay("run", journal, code=2)
        journal.write_text("rubbish\n")
        self.replay("run2", journal, code=2)


if __name__ == "__main__":
    unittest.main()

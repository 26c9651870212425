"""Runs are steered by a person at a pseudo-terminal; what its screen shows is told by a terminal emulator."""

import os
import pty
import select
import subprocess
import termios
import time
import unittest

from program import PATIENCE, checkpoints
from steered import Steered, run_words
from terminal import Terminal


class Prompt(Steered):
    def start(self, name="run", *arguments, **options):
        os.environ["XDG_STATE_HOME"] = str(self.folder / "state")
        terminal = Terminal(run_words(self.folder / name, "--repl", *arguments), **options)
        terminal.expect("meltscope> ")
        return terminal

    def test_keys_completion_history_and_the_end(self):
        terminal = self.start()
        terminal.type("sta\t\r")
        terminal.expect(r"paused at step 0")
        terminal.type("set laser.pow\t 250 W\r")
        terminal.expect(r"179\.2 W -> 250 W")
        terminal.type("set laser.\t")
        terminal.expect_row(r"laser\.power +laser\.speed +laser\.spot_radius.*")
        terminal.type("\x03")  # drops the line
        terminal.type("get laser.power\r")
        terminal.expect(r"laser\.power = 250 W")
        terminal.type("\x1b[A\x1b[A\r")  # the line before the last one
        terminal.expect(r"250 W -> 250 W")
        terminal.type("powr 3\x1b[D\x1b[D\x1b[De\r")  # an e put into the word
        terminal.expect(r"250 W -> 3 W")
        terminal.type("step 3\r")
        terminal.expect(r"paused at step 3")
        terminal.type("\x04")
        self.assertEqual(terminal.wait(), 3)
        self.assertIn("get laser.power", (self.folder / "state/meltscope/history").read_text())

    def test_history_is_kept_over_sessions(self):
        terminal = self.start("first")
        terminal.type("power 222\r")
        terminal.expect("-> 222 W")
        terminal.type("quit\r")
        terminal.wait()
        terminal = self.start("second")
        terminal.type("\x1b[A\x1b[A\r")
        terminal.expect("-> 222 W")
        terminal.type("\x04")
        terminal.wait()

    def test_ctrl_c_pauses_and_again_stops_with_a_checkpoint(self):
        terminal = self.start("run", "--set", "time.end=1 s")
        terminal.type("run\r")
        terminal.expect("running from")
        terminal.type("\x03")
        step = int(terminal.expect(r"paused at step (\d+)").group(1))
        terminal.type("\x03")
        self.assertEqual(terminal.wait(), 3)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, f"step_{step:09d}.h5")

    def test_the_prompt_is_usable_while_the_run_goes_on_and_output_does_not_tear_the_line(self):
        terminal = self.start("run", "--set", "time.end=1 s")
        terminal.type("step 60\r")
        terminal.type("power 2")  # not finished when the pause is announced
        terminal.expect(r"paused at step 60")
        terminal.expect_row(r"meltscope> power 2( +paused \d+% step 60 .*)?")
        terminal.expect_row(r"paused at step 60, .*")
        terminal.type("22\r")
        terminal.expect(r"-> 222 W")
        terminal.type("run\r")
        terminal.type("power 111\r")
        terminal.expect(r"222 W -> 111 W \(step \d+")
        terminal.type("quit\r")
        self.assertEqual(terminal.wait(), 3)
        self.assertIn("meltscope> power 222", terminal.rows())  # without the status that stood beside it

    def test_a_line_of_several_rows_stays_whole_when_output_comes(self):
        terminal = self.start("run", "--set", "time.end=1 s", columns=40)
        terminal.type("step 60\r")
        line = "at 900 ms path line 0.4 mm 0.3 mm speed 1.2 m/s power 150 W"
        terminal.type(line)
        terminal.expect(r"paused at step 60")
        prompt = f"meltscope> {line}"
        for row in (prompt[:40], prompt[40:]):
            terminal.expect_row(row.rstrip())
        terminal.type("\r")
        terminal.expect("waits for 900 ms")
        self.assertEqual(1, sum(row.startswith("meltscope> at 900 ms") for row in terminal.rows()))
        terminal.type("quit\r")
        self.assertEqual(terminal.wait(), 3)

    def test_a_change_of_the_windows_size_keeps_what_is_typed(self):
        terminal = self.start()
        terminal.expect_row(r"meltscope> +paused 0% step 0 t 0 s")
        terminal.type("power 2")
        terminal.resize(36)
        terminal.expect_row(r"meltscope> power 2")  # no room for the status
        terminal.type("2")
        terminal.expect_row(r"meltscope> power 22")
        terminal.resize(120)
        terminal.expect_row(r"meltscope> power 22 +paused 0% step 0 t 0 s")
        terminal.type("2\r")
        terminal.expect("-> 222 W")
        terminal.type("quit\r")
        self.assertEqual(terminal.wait(), 3)

    def test_a_window_that_is_closed_ends_the_run_with_a_checkpoint(self):
        terminal = self.start("run", "--set", "time.end=1 s")
        terminal.type("step 3\r")
        terminal.expect("paused at step 3")
        terminal.hang_up()
        self.assertEqual(terminal.wait(reads=False), 3)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, "step_000000003.h5")

    def test_ctrl_d_deletes_within_a_line_and_ends_the_input_on_an_empty_one(self):
        terminal = self.start()
        terminal.expect("meltscope> ")  # until then the terminal itself would act on Ctrl-D
        terminal.type("power 2002\x1b[D\x04\r")  # the last 2 is deleted
        terminal.expect("-> 200 W")
        terminal.type("\x04")
        self.assertEqual(terminal.wait(), 3)

    def test_the_prompt_stays_at_the_end_until_it_is_left(self):
        terminal = self.start()
        terminal.type("run\r")
        terminal.expect("the run has reached its end")
        terminal.type("pool\r")
        terminal.expect("length")
        terminal.type("\x04")
        self.assertEqual(terminal.wait(), 0)

    def test_a_dumb_terminal_reads_plain_lines(self):
        terminal = self.start(term="dumb")
        terminal.type("power 200\n")
        terminal.expect("-> 200 W")
        terminal.expect_row("meltscope>")  # asked again after the answer
        terminal.type("quit\n")
        self.assertEqual(terminal.wait(), 3)
        self.assertNotIn("\033", terminal.seen)

    def test_ctrl_c_pauses_and_again_stops_at_a_dumb_terminal(self):
        terminal = self.start("run", "--set", "time.end=1 s", term="dumb")
        terminal.type("run\n")
        terminal.expect("running from")
        terminal.type("\x03")
        step = int(terminal.expect(r"paused at step (\d+)").group(1))
        terminal.type("get laser.power\n")
        terminal.expect(r"laser\.power = ")
        terminal.type("\x03")
        terminal.expect(r"Ctrl-C again")  # a command came between
        terminal.type("\x03")
        self.assertEqual(terminal.wait(), 3)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, f"step_{step:09d}.h5")

    def test_the_terminal_is_left_as_it_was_found(self):
        master, slave = pty.openpty()
        before = termios.tcgetattr(slave)
        process = subprocess.Popen(run_words(self.folder / "run", "--repl"), stdin=slave, stdout=slave, stderr=slave,
                                   env=dict(os.environ, TERM="xterm"))
        os.write(master, b"quit\r")
        end = time.monotonic() + PATIENCE
        while process.poll() is None and time.monotonic() < end:
            if select.select([master], [], [], 0.05)[0]:
                os.read(master, 65536)
        self.assertEqual(process.wait(timeout=1), 3)
        self.assertEqual(termios.tcgetattr(slave), before)


if __name__ == "__main__":
    unittest.main()

"""Runs are steered through pipes, scripts, a pseudo-terminal and the socket; replays end in the same bits."""

import os
import pty
import re
import select
import signal
import socket
import stat
import subprocess
import time
import unittest

from program import PROGRAM, QUICK_LOOK, SMALL, ProgramTest, checkpoints, meltscope

AT_END = ["--set", "checkpoint.every=1 s"]
PATIENCE = 60  # s until a test gives up; nothing is measured


def run_words(folder, *arguments):
    return [PROGRAM, "run", str(QUICK_LOOK), *SMALL, *AT_END, "--no-render", "--output", str(folder),
            *map(str, arguments)]


def journal_of(run):
    return [line for line in (run / "journal.txt").read_text().splitlines() if not line.startswith("#")]


class Steered(ProgramTest):
    def piped(self, name, lines, *arguments):
        return subprocess.run(run_words(self.folder / name, "--repl", *arguments), input="\n".join(lines) + "\n",
                              capture_output=True, text=True, timeout=PATIENCE)

    def replay(self, name, journal, *arguments, code=0):
        result = subprocess.run(run_words(self.folder / name, "--replay", journal, *arguments), capture_output=True,
                                text=True, timeout=PATIENCE, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return self.folder / name

    def assert_same_end(self, first, second):
        a, b = checkpoints(first)[-1], checkpoints(second)[-1]
        self.assertEqual(a.name, b.name)
        self.assertEqual(a.read_bytes(), b.read_bytes())
        self.assertEqual((first / "journal.txt").read_bytes(), (second / "journal.txt").read_bytes())


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

    def test_a_journal_of_another_run_is_refused(self):
        journal = self.folder / "other.txt"
        journal.write_text("at step 4 t=1: set laser.power 200 W\n")
        self.replay("run", journal, code=2)
        journal.write_text("rubbish\n")
        self.replay("run2", journal, code=2)


class Terminal:
    """A program at a pseudo-terminal."""

    def __init__(self, words, term="xterm", columns=100):
        environment = dict(os.environ, TERM=term, COLUMNS=str(columns), LINES="40")
        self.pid, self.master = pty.fork()
        if self.pid == 0:
            os.execve(words[0], words, environment)
        import fcntl
        import struct
        import termios
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
        self.seen = ""
        self.mark = 0

    def type(self, text):
        os.write(self.master, text.encode())

    def read(self, seconds=0.05):
        ready, _, _ = select.select([self.master], [], [], seconds)
        if not ready:
            return True
        try:
            data = os.read(self.master, 65536)
        except OSError:
            return False
        self.seen += data.decode(errors="replace")
        return bool(data)

    def expect(self, pattern):
        """Waits for the pattern in what came since the last match."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            match = re.compile(pattern, re.S).search(self.seen, self.mark)
            if match:
                self.mark = match.end()
                return match
            if not self.read():
                break
        raise AssertionError(f"{pattern!r} did not come; there is\n{self.seen[self.mark:]!r}")

    def wait(self):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                while self.read(0) and select.select([self.master], [], [], 0)[0]:
                    pass
                os.close(self.master)
                return os.waitstatus_to_exitcode(status)
            self.read()
        os.kill(self.pid, signal.SIGKILL)
        raise AssertionError(f"the program does not end:\n{self.seen[-2000:]}")


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
        terminal.expect(r"laser\.power  laser\.speed")
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
        terminal = self.start("run", "--set", "time.end=40 ms")
        terminal.type("run\r")
        terminal.expect("running from")
        terminal.type("\x03")
        step = int(terminal.expect(r"paused at step (\d+)").group(1))
        terminal.type("\x03")
        self.assertEqual(terminal.wait(), 3)
        self.assertEqual(checkpoints(self.folder / "run")[-1].name, f"step_{step:09d}.h5")

    def test_the_prompt_is_usable_while_the_run_goes_on_and_output_does_not_tear_the_line(self):
        terminal = self.start("run", "--set", "time.end=40 ms")
        terminal.type("step 60\r")
        terminal.type("power 2")  # not finished when the pause is announced
        terminal.expect(r"paused at step 60.*meltscope> power 2")
        terminal.type("22\r")
        terminal.expect(r"-> 222 W")
        terminal.type("run\r")
        terminal.type("power 111\r")
        terminal.expect(r"222 W -> 111 W \(step \d+")
        terminal.type("quit\r")
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
        terminal.type("quit\n")
        self.assertEqual(terminal.wait(), 3)
        self.assertNotIn("\033", terminal.seen)

    def test_the_terminal_is_left_as_it_was_found(self):
        import termios
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


class Attach(Steered):
    def start(self, name="run", *arguments):
        """A run that waits for commands; its own pipe is kept open."""
        process = subprocess.Popen(run_words(self.folder / name, "--repl", "--set", "time.end=40 ms", *arguments),
                                   stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdin.close(), process.stderr.close()))
        path = self.folder / name / "console.sock"
        end = time.monotonic() + PATIENCE
        while not path.exists() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        self.assertTrue(path.exists(), "no socket came")
        return process

    def attach(self, lines, *arguments, name="run"):
        return subprocess.run([PROGRAM, "attach", str(self.folder / name), *arguments], input="\n".join(lines) + "\n",
                              capture_output=True, text=True, timeout=PATIENCE)

    def connect(self, hello=b"meltscope 1 watch prompt\n"):
        client = socket.socket(socket.AF_UNIX)
        self.addCleanup(client.close)
        client.settimeout(PATIENCE)
        here = os.getcwd()
        os.chdir(self.folder / "run")
        client.connect("console.sock")
        os.chdir(here)
        client.sendall(hello)
        return client

    def everything_from(self, client):
        data = b""
        try:
            while part := client.recv(65536):
                data += part
        except ConnectionResetError:
            pass
        return data

    def test_commands_are_carried_out_and_journalled(self):
        process = self.start()
        result = self.attach(["step 4", "power 200", "get laser.power"])
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("179.2 W -> 200 W (step 4", result.stdout)
        self.assertIn("laser.power = 200 W", result.stdout)
        self.assertRegex(journal_of(self.folder / "run")[0], r"^at step 4 ")
        self.assertEqual(self.attach(["nonsense"]).returncode, 2)
        self.attach(["quit"])
        self.assertEqual(process.wait(timeout=PATIENCE), 3)
        self.assertFalse((self.folder / "run" / "console.sock").exists())
        self.assert_same_end(self.folder / "run",
                             self.replay("again", self.folder / "run" / "journal.txt", "--set", "time.end=40 ms", code=3))

    def test_the_socket_is_the_owners_alone(self):
        self.start()
        mode = stat.S_IMODE((self.folder / "run" / "console.sock").stat().st_mode)
        self.assertEqual(mode, 0o600)

    def test_one_writes_and_the_others_watch(self):
        self.start()
        writer = self.connect(b"meltscope 1 write prompt\n")
        self.assertTrue(writer.recv(4096).startswith(b"w"))
        second = self.attach(["power 3", "get laser.power"])
        self.assertIn("laser.power = 179.2 W", second.stdout)
        self.assertIn("another console has the say", second.stdout)
        self.assertEqual(second.returncode, 2)
        watcher = self.connect()
        watcher.recv(4096)
        writer.sendall(b"power 123\n")
        heard = b""
        while b"-> 123 W" not in heard:
            heard += watcher.recv(4096)
        self.assertTrue(heard.startswith(b"n(power 123)"))

    def test_junk_endless_lines_and_strangers_are_refused_and_harm_nothing(self):
        self.start()
        for rubbish in (b"meltscope 1 watch prompt\n\x00\x01\x02\n", b"GET / HTTP/1.1\n", b"x" * 1_000_000,
                        b"meltscope 1 watch prompt\n" + b"y" * 1_000_000 + b"\n", b"\xff\xfe\n"):
            client = self.connect(b"")
            try:
                client.sendall(rubbish)
            except (BrokenPipeError, ConnectionResetError):
                pass
            self.everything_from(client)  # comes to an end
        self.assertIn("laser.power = 179.2 W", self.attach(["get laser.power"]).stdout)

    def test_clients_that_do_not_read_do_not_hold_the_run_up(self):
        self.start()
        sleeper = self.connect()  # never reads
        for _ in range(30):
            try:
                sleeper.sendall(b"help\n" * 100)
            except (BrokenPipeError, ConnectionResetError):
                break
        result = self.attach(["step 3", "status"])
        self.assertIn("at step 3", result.stdout)

    def test_a_long_folder_name_does_not_matter(self):
        name = "/".join(["a_rather_long_folder_name_for_a_run"] * 5)
        self.start(name)
        self.assertIn("laser.power", self.attach(["get laser.power"], name=name).stdout)

    def test_without_a_run_there_is_a_reason_and_exit_code_2(self):
        result = self.attach(["status"], name="nowhere")
        self.assertEqual(result.returncode, 2)
        (self.folder / "empty").mkdir()
        result = self.attach(["status"], name="empty")
        self.assertEqual(result.returncode, 2)
        self.assertIn("no run is under way", result.stderr)


if __name__ == "__main__":
    unittest.main()

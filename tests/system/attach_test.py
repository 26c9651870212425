"""Runs are steered through the socket in their folder."""

import os
import pathlib
import random
import shutil
import signal
import socket
import stat
import subprocess
import time
import unittest

from program import PATIENCE, PROGRAM, checkpoints
from steered import Steered, journal_of, run_words
from terminal import Terminal


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

    def test_a_script_of_more_lines_than_may_wait_is_carried_out_to_its_end(self):
        self.start()
        result = self.attach(["get laser.power"] * 2500 + ["power 200"])
        self.assertEqual(result.returncode, 0, result.stdout[-500:] + result.stderr)
        self.assertEqual(result.stdout.count("laser.power = 179.2 W"), 2500)
        self.assertIn("179.2 W -> 200 W", result.stdout)

    def test_the_socket_is_the_owners_alone(self):
        self.start()
        mode = stat.S_IMODE((self.folder / "run" / "console.sock").stat().st_mode)
        self.assertEqual(mode, 0o600)

    def test_a_run_opens_no_port(self):
        process = self.start()
        sockets = set()
        for descriptor in os.listdir(f"/proc/{process.pid}/fd"):
            try:
                sockets.add(os.readlink(f"/proc/{process.pid}/fd/{descriptor}"))
            except FileNotFoundError:  # closed meanwhile
                pass
        self.assertTrue([name for name in sockets if name.startswith("socket:")])
        for protocol in ("tcp", "tcp6", "udp", "udp6", "raw", "raw6"):
            table = pathlib.Path(f"/proc/{process.pid}/net/{protocol}")
            if table.exists():  # some kernels lack one or the other
                for row in table.read_text().splitlines()[1:]:
                    self.assertNotIn(f"socket:[{row.split()[9]}]", sockets, protocol + row)

    def run_on(self):
        """A run is taken up in its folder for one step; its log."""
        result = subprocess.run([PROGRAM, "run", "--restart", str(checkpoints(self.folder / "run")[-1]), "--no-render",
                                 "--steps", "1"], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(result.returncode, 0, result.stderr)
        return (self.folder / "run" / "log.txt").read_text()

    def test_what_else_is_called_like_the_socket_stays(self):
        self.run_small("run", "--steps", 1)
        other = self.folder / "run" / "console.sock"
        other.write_text("mine")
        self.assertIn("console.sock is in the way", self.run_on())
        self.assertEqual(other.read_text(), "mine")

    def test_a_run_in_the_folder_of_somebody_else_has_no_socket(self):
        if os.geteuid() != 0:
            self.skipTest("needs root, to give a folder away")
        self.run_small("run", "--steps", 1)
        os.chown(self.folder / "run", 65534, 65534)
        self.assertIn("belongs to another user", self.run_on())
        self.assertFalse((self.folder / "run" / "console.sock").exists())

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
        self.assertIn(b"\nn(power 123)", b"\n" + heard)

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

    def test_tab_completes_the_names_of_the_run(self):
        path = "path = [{move = [2e-4, 2e-4, 0]}, {to = [8e-4, 2e-4, 0], speed = 0.8}]"
        laser = "{name = \"%s\", power = 100, d4sigma = 170e-6, absorptivity = 0.3, " + path + "}"
        self.start("run", "--set", "laser=[" + laser % "left" + ", " + laser % "right" + "]")
        os.environ["XDG_STATE_HOME"] = str(self.folder / "state")
        terminal = Terminal([PROGRAM, "attach", str(self.folder / "run")])
        terminal.expect("meltscope> ")
        terminal.expect_row(r"meltscope> +paused 0% step 0 t 0 s")
        terminal.type("set laser.ri\tpow\t120 W\r")
        terminal.expect(r"laser\.right\.power: 100 W -> 120 W")
        terminal.type("power le\t130\r")
        terminal.expect(r"laser\.left\.power: 100 W -> 130 W")
        terminal.type("det\r")
        self.assertEqual(terminal.wait(), 0)

    def test_a_client_that_is_stopped_or_killed_does_not_hold_the_run_up(self):
        self.start()
        words = [PROGRAM, "attach", str(self.folder / "run"), "--watch"]
        sleeper, dead = (subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) for _ in range(2))
        for client in (sleeper, dead):
            self.addCleanup(lambda c=client: (c.kill(), c.wait(), c.stdin.close(), c.stdout.close()))
        for client in (sleeper, dead):
            client.stdin.write(b"status\n")
            client.stdin.flush()
            client.stdout.readline()  # it is attached
        sleeper.send_signal(signal.SIGSTOP)
        dead.kill()
        # More news than the sleeper's buffers can hold.
        lines = [f"set render.color_range {300 + n} K {2000 + n} K" for n in range(900)]
        for _ in range(4):
            self.assertEqual(self.attach(lines).returncode, 0)
        self.assertIn("at step 3", self.attach(["step 3", "status"]).stdout)

    def test_others_than_the_owner_are_refused(self):
        if os.geteuid() != 0:
            self.skipTest("needs root, to be another user for a moment")
        self.start()
        nobody = 65534
        program = self.folder / "meltscope"
        shutil.copy(PROGRAM, program)
        for folder in (self.folder, self.folder / "run"):
            folder.chmod(0o755)
        result = subprocess.run([str(program), "attach", str(self.folder / "run")], input="power 3\n", user=nobody,
                                group=nobody, extra_groups=[], capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(result.returncode, 2)
        self.assertIn("belongs to another user", result.stderr)

        # One that does without the program: the mode of the socket, then the server itself.
        client = """import os, socket
os.chdir(%r)
client = socket.socket(socket.AF_UNIX)
try:
    client.connect("console.sock")
    client.sendall(b"meltscope 1 write script\\npower 3\\n")
    print("heard", client.recv(4096))
except OSError as error:
    print(type(error).__name__)
""" % str(self.folder / "run")

        def knock():
            return subprocess.run(["/usr/bin/python3", "-c", client], user=nobody, group=nobody, extra_groups=[],
                                  capture_output=True, text=True, timeout=PATIENCE).stdout.strip()

        self.assertEqual(knock(), "PermissionError")
        (self.folder / "run" / "console.sock").chmod(0o666)
        self.assertIn(knock(), ("heard b''", "ConnectionResetError", "BrokenPipeError"))
        self.assertIn("laser.power = 179.2 W", self.attach(["get laser.power"]).stdout)

        # And a folder of somebody else is no place to look for a run.
        os.chown(self.folder / "run", nobody, nobody)
        result = self.attach(["get laser.power"])
        self.assertEqual(result.returncode, 2)
        self.assertIn("belongs to another user", result.stderr)


class Sessions(Steered):
    """Random commands, through attach, over an interruption, with other numbers of threads."""

    def random_line(self, random):
        um = lambda low, high: f"{random.uniform(low, high):.4f} um"
        return random.choice([
            lambda: f"power {random.uniform(0, 300):.3f} W",
            lambda: f"speed {random.uniform(0.2, 2):.3f}",
            lambda: f"spot {um(60, 120)}",
            lambda: f"set laser.absorptivity {random.random():.3f}",
            lambda: random.choice(["on", "off"]),
            lambda: f"path line {um(100, 900)} {um(100, 300)} speed {random.uniform(0.2, 2):.3f}",
            lambda: f"path dwell {random.uniform(1, 30):.3f} us power 120",
            lambda: f"path goto {um(100, 900)} {um(100, 300)}",
            lambda: "path clear",
            lambda: f"set output.every {random.uniform(20, 90):.3f} us",
            lambda: f"set time.cfl {random.uniform(0.2, 0.9):.3f}",
            lambda: f"set boundary.z_min temperature {random.uniform(280, 600):.2f}",
            lambda: "set physics.radiation on",
            lambda: "set physics.evaporation on",
            lambda: f"layer thickness 30 um homogenised packing {random.uniform(0.4, 0.7):.3f}",
            lambda: f"at {random.uniform(0, 280):.3f} us power {random.uniform(0, 300):.3f}",
            lambda: f"adopt laser.absorptivity={random.uniform(0.2, 0.5):.3f}",
            lambda: f"land {random.uniform(0, 280):.3f} us",
            lambda: "pool",
            lambda: f"step {random.randrange(1, 8)}",
            lambda: f"run {random.uniform(1, 20):.3f} us"])()

    def attach_and_say(self, folder, lines):
        """Each line by a client of its own, as some may be refused (a time that has passed)."""
        for line in lines:
            subprocess.run([PROGRAM, "attach", str(folder)], input=line + "\n", capture_output=True, text=True,
                           timeout=PATIENCE)

    def steer(self, words, folder, lines):
        process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdin.close(), process.stderr.close()))
        end = time.monotonic() + PATIENCE
        while not (folder / "console.sock").exists() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.01)
        self.attach_and_say(folder, lines)
        return process

    def test_random_sessions_over_an_interruption_replay_bit_for_bit_with_other_threads(self):
        for seed in range(4):
            with self.subTest(seed=seed):
                numbers = random.Random(seed)
                folder = self.folder / f"run_{seed}"
                lines = [self.random_line(numbers) for _ in range(16)]
                process = self.steer(run_words(folder, "--repl", "--threads", 1 + seed % 2), folder,
                                     [*lines[:8], "step 2", "quit"])
                self.assertEqual(process.wait(timeout=PATIENCE), 3, process.stderr.read())
                process = self.steer([PROGRAM, "run", "--restart", str(checkpoints(folder)[-1]), "--no-render",
                                      "--repl", "--set", "laser.power=170 W"], folder, [*lines[8:], "step 2", "quit"])
                self.assertEqual(process.wait(timeout=PATIENCE), 3, process.stderr.read())
                self.assertGreater(len(journal_of(folder)), 5)
                again = self.replay(f"again_{seed}", folder / "journal.txt", "--threads", 2 - seed % 2, code=3)
                self.assert_same_end(folder, again)


if __name__ == "__main__":
    unittest.main()

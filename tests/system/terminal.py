"""A program at a pseudo-terminal, as a person would use it."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import termios
import time

import pyte

from program import PATIENCE

ROWS = 40


def set_size(terminal, columns):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, columns, 0, 0))


class Terminal:
    """Types, and reads what comes back: as text since the last match, and as the screen that a person sees."""

    def __init__(self, words, term="xterm", columns=100):
        environment = dict(os.environ, TERM=term)
        environment.pop("COLUMNS", None)
        environment.pop("LINES", None)
        self.pid, self.master = pty.fork()
        if self.pid == 0:
            set_size(pty.STDIN_FILENO, columns)
            os.execve(words[0], words, environment)
        self.seen = ""
        self.mark = 0
        self.screen = pyte.Screen(columns, ROWS)
        self.stream = pyte.Stream(self.screen)

    def resize(self, columns):
        self.screen.resize(ROWS, columns)
        set_size(self.master, columns)

    def rows(self):
        """The rows of the screen that hold something."""
        return [row.rstrip() for row in self.screen.display if row.strip()]

    def type(self, text):
        os.write(self.master, text.encode())

    def hang_up(self):
        os.close(self.master)

    def read(self, seconds=0.05):
        ready, _, _ = select.select([self.master], [], [], seconds)
        if not ready:
            return True
        try:
            data = os.read(self.master, 65536)
        except OSError:
            return False
        text = data.decode(errors="replace")
        self.seen += text
        self.stream.feed(text)
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

    def expect_row(self, pattern):
        """Waits until a row of the screen is the pattern and nothing else."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            for row in self.rows():
                if re.fullmatch(pattern, row):
                    return row
            if not self.read():
                break
        raise AssertionError(f"no row is {pattern!r}; there are\n" + "\n".join(self.rows()))

    def wait(self, reads=True):
        """The exit code at the end of the program."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                if reads:
                    while select.select([self.master], [], [], 0)[0] and self.read(0):
                        pass
                    os.close(self.master)
                return os.waitstatus_to_exitcode(status)
            if reads:
                self.read()
            else:
                time.sleep(0.02)
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)
        raise AssertionError(f"the program does not end:\n{self.seen[-2000:]}")

#!/usr/bin/env python3
"""How soon the prompt echoes a key, and how soon a command takes effect, while a run uses all cores.

usage: console_latency.py PROGRAM [SCENARIO [KEY=VALUE ...]]    (default: the scenario of the demo, 2 million particles)
Prints milliseconds; no test depends on them.
"""

import os
import pathlib
import pty
import re
import select
import statistics
import sys
import tempfile
import time

KEYS, COMMANDS = 40, 10


class Prompt:
    def __init__(self, words):
        self.pid, self.master = pty.fork()
        if self.pid == 0:
            os.execve(words[0], words, dict(os.environ, TERM="xterm", XDG_STATE_HOME=tempfile.mkdtemp()))
        self.seen = ""

    def send_and_wait(self, text, pattern, patience=300.0):
        """Seconds from typing the text to the pattern on the screen."""
        self.seen = ""
        start = time.monotonic()
        os.write(self.master, text.encode())
        while not re.search(pattern, self.seen):
            if time.monotonic() - start > patience:
                sys.exit(f"{pattern!r} did not come:\n{self.seen[-500:]}")
            if select.select([self.master], [], [], 0.001)[0]:
                self.seen += os.read(self.master, 65536).decode(errors="replace")
        return time.monotonic() - start


def main():
    program = sys.argv[1]
    root = pathlib.Path(__file__).resolve().parents[2]
    scenario = sys.argv[2] if len(sys.argv) > 2 else str(root / "scenarios/in625_single_track.toml")
    changes = [word for change in sys.argv[3:] for word in ("--set", change)]
    folder = tempfile.mkdtemp(prefix="meltscope_latency_")
    prompt = Prompt([program, "run", scenario, *changes, "--repl", "--no-render", "--output", folder, "--overwrite"])
    prompt.send_and_wait("", "meltscope> ")
    prompt.send_and_wait("step 4\r", "paused at step 4")
    step = prompt.send_and_wait("step 10\r", "paused at step 14") / 10
    prompt.send_and_wait("run\r", "running from")
    echoes = []
    for n in range(KEYS):
        key = "abcdefghij"[n % 10]
        echoes.append(prompt.send_and_wait(key, key))
        time.sleep(0.02)
    prompt.send_and_wait("\x03", r"meltscope> ")
    effects = [prompt.send_and_wait(f"power {180 + n} W\r", rf"-> {180 + n} W") for n in range(COMMANDS)]
    os.write(prompt.master, b"quit\r")
    ms = 1000.0
    print(f"one step                     {ms * step:8.1f} ms")
    print(f"key to echo        median    {ms * statistics.median(echoes):8.1f} ms, longest {ms * max(echoes):.1f} ms")
    print(f"command to effect  median    {ms * statistics.median(effects):8.1f} ms, longest {ms * max(effects):.1f} ms")


if __name__ == "__main__":
    main()

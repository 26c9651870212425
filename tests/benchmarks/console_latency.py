#!/usr/bin/env python3
"""How soon the prompt echoes a key, and how soon a command takes effect, while a run uses all cores.

usage: console_latency.py PROGRAM [SCENARIO [KEY=VALUE ...]]    (default: the scenario of the demo, 2 million particles)
Outputs are on, as the scenario says; pictures are off. Prints milliseconds; no test depends on them.
"""

import os
import pathlib
import pty
import random
import re
import select
import shutil
import statistics
import sys
import tempfile
import time

KEYS, COMMANDS, STEPS = 100, 60, 20


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

    def wait(self):
        try:
            while os.read(self.master, 65536):
                pass
        except OSError:  # the program has ended
            pass
        os.waitpid(self.pid, 0)


def main():
    program = sys.argv[1]
    root = pathlib.Path(__file__).resolve().parents[2]
    scenario = sys.argv[2] if len(sys.argv) > 2 else str(root / "scenarios/in625_single_track.toml")
    changes = [word for change in sys.argv[3:] for word in ("--set", change)]
    folder = tempfile.mkdtemp(prefix="meltscope_latency_")
    prompt = Prompt([program, "run", scenario, *changes, "--repl", "--no-render", "--output", folder, "--overwrite"])
    prompt.send_and_wait("", "meltscope> ")
    prompt.send_and_wait("step 4\r", "paused at step 4,")
    step = prompt.send_and_wait(f"step {STEPS}\r", f"paused at step {4 + STEPS},") / STEPS
    prompt.send_and_wait("run\r", "running from")
    echoes = []
    for n in range(KEYS):
        key = "QXZWKB"[n % 6]  # in no message
        echoes.append(prompt.send_and_wait(key, key))
        time.sleep(random.uniform(0.005, 0.03))
        if n % 30 == 29:
            prompt.send_and_wait("\x03", r"meltscope> ")  # drops the line
    prompt.send_and_wait("\x03", r"meltscope> ")
    effects = []
    for n in range(COMMANDS):
        effects.append(prompt.send_and_wait(f"power {180 + n} W\r", rf"-> {180 + n} W"))
        time.sleep(random.uniform(0.0, step))  # at any moment of a step
    prompt.send_and_wait("quit\r", "stopping at")
    prompt.wait()
    shutil.rmtree(folder)
    ms = 1000.0
    late = sum(effect > step + 0.05 for effect in effects)
    print(f"one step, outputs included   {ms * step:8.1f} ms")
    print(f"key to echo        median    {ms * statistics.median(echoes):8.1f} ms, longest {ms * max(echoes):.1f} ms")
    print(f"command to effect  median    {ms * statistics.median(effects):8.1f} ms, longest {ms * max(effects):.1f} ms")
    print(f"later than a step and 50 ms  {late} of {COMMANDS}")


if __name__ == "__main__":
    main()

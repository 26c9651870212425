"""What the tests of steering have in common: runs with commands, their journals, the comparison of their ends."""

import subprocess

from program import PATIENCE, PROGRAM, QUICK_LOOK, SMALL, ProgramTest, checkpoints

AT_END = ["--set", "checkpoint.every=1 s"]


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

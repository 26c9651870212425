"""Kills runs with SIGKILL at random moments and looks at what is left.

soak.py [MOMENTS] [--seed N] [--pictures]; the program is $MELTSCOPE_PROGRAM.

One run after another is killed, taken up from its last checkpoint, killed again, until that many moments are made. After each:
every checkpoint opens; every PVD file is XML that names whole files; and a copy of the folder, taken up from its last
checkpoint (or begun anew if there was none yet), ends with the bits of a run that was never interrupted.
"""

import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as xml

PROGRAM = os.environ["MELTSCOPE_PROGRAM"]
QUICK_LOOK = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "quick_look.toml"
# 2500 cells, an output every step or two, a checkpoint every third output.
BUSY = ["--set", "domain.cell_size=40 um", "--set", "time.max_step=4 us", "--set", "time.end=0.28 ms", "--set",
        "output.every=5 us", "--set", 'output.particles="all"', "--set", "checkpoint.every=15 us", "--set",
        "output.solidification=true"]
OF_THE_MACHINE = ("run.json", "log.txt", "run.lock")  # wall times and process ids


def command(folder, pictures, checkpoint=None):
    start = ["--restart", checkpoint] if checkpoint else [QUICK_LOOK, *BUSY]
    return [PROGRAM, "run", *map(str, start), "--output", str(folder), *([] if checkpoint else ["--overwrite"]),
            *([] if pictures else ["--no-render"])]


def to_the_end(words):
    result = subprocess.run(words, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=300)
    if result.returncode != 0:
        raise AssertionError(f"exit code {result.returncode}: {' '.join(words)}\n{result.stderr}")
    return result.stdout


def last_checkpoint(folder):
    return max((folder / "checkpoints").glob("step_*.h5"), default=None)


def contents(folder):
    """What a run must leave bit for bit."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.name not in OF_THE_MACHINE and path.suffix != ".mp4"}


def must_be_whole(folder):
    """Looks at a folder as the kill left it; the number of checkpoints and of files that the PVD files name."""
    opened = 0
    for checkpoint in (folder / "checkpoints").glob("*.h5"):
        to_the_end([PROGRAM, "info", str(checkpoint)])
        opened += 1
    named = 0
    for collection in folder.glob("*.pvd"):
        for entry in xml.parse(collection).getroot().iter("DataSet"):
            data = (folder / entry.get("file")).read_bytes()
            if not data.rstrip().endswith(b"</VTKFile>"):
                raise AssertionError(f"{collection} names {entry.get('file')}, which is cut off")
            named += 1
    for frame in (folder / "frames").glob("*.png"):
        if not frame.read_bytes().endswith(b"IEND\xaeB`\x82"):
            raise AssertionError(f"{frame} is cut off")
    return opened, named


def must_equal(got, expected, where):
    if list(got) != list(expected):
        raise AssertionError(f"{where}: missing {sorted(set(expected) - set(got))}, too many {sorted(set(got) - set(expected))}")
    for name, data in expected.items():
        if got[name] != data:
            raise AssertionError(f"{where}: {name} differs from that of the uninterrupted run")


def kill_at(words, moment):
    """Starts the program and kills it after so many seconds; false if it had ended by then."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
    try:
        code = process.wait(timeout=moment)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.wait()
        return True
    if code != 0:
        raise AssertionError(f"exit code {code}: {' '.join(words)}")
    return False


def soak(moments, seed, pictures, folder):
    dice = random.Random(seed)
    whole = folder / "whole"
    begin = time.monotonic()
    to_the_end(command(whole, pictures))
    duration = time.monotonic() - begin
    expected = contents(whole)
    print(f"seed {seed}; uninterrupted: {duration:.2f} s, {len(expected)} files", flush=True)
    latest = duration  # of the moments; follows the speed of the machine, on which others may be busy

    run, copy = folder / "killed", folder / "copy"
    made, without_checkpoint, tries = 0, 0, 0
    while made < moments:
        tries += 1
        if tries > 4 * moments + 20:
            raise AssertionError(f"only {made} of {tries} runs were still going when they were to be killed")
        checkpoint = last_checkpoint(run) if run.exists() else None
        if not kill_at(command(run, pictures, checkpoint), dice.uniform(0.02, latest)):
            must_equal(contents(run), expected, "a run that was killed again and again")
            shutil.rmtree(run)
            latest = max(0.05, 0.8 * latest)
            continue
        made += 1
        latest *= 1.1
        opened, named = must_be_whole(run) if run.exists() else (0, 0)
        without_checkpoint += opened == 0
        shutil.rmtree(copy, ignore_errors=True)
        if run.exists():
            shutil.copytree(run, copy, ignore=shutil.ignore_patterns("console.sock"))
        to_the_end(command(copy, pictures, last_checkpoint(copy)))
        must_equal(contents(copy), expected, f"moment {made}")
        print(f"moment {made}: {opened} checkpoints open, {named} files named; taken up, ends with the same bits", flush=True)
    print(f"{made} moments, {without_checkpoint} of them before the first checkpoint: nothing lost")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("moments", nargs="?", type=int, default=50)
    parser.add_argument("--seed", type=int, default=None, help="of the moments; default another one each time")
    parser.add_argument("--pictures", action="store_true", help="draw, too")
    request = parser.parse_args()
    seed = random.SystemRandom().randrange(10**6) if request.seed is None else request.seed
    with tempfile.TemporaryDirectory(prefix="meltscope_soak_") as folder:
        soak(request.moments, seed, request.pictures, pathlib.Path(folder))


if __name__ == "__main__":
    try:
        main()
    except AssertionError as error:
        sys.exit(f"failed: {error}")

#!/usr/bin/env python3
"""Instructions that each kernel takes on a small fixed case, counted by callgrind, against those on record.

usage: count_instructions.py PROGRAM [--update]     PROGRAM: meltscope_kernel_counts of a build for x86-64-v3

Counts do not depend on what else the machine does, but on the compiler: the record names it. Prints every kernel's
count and change; ends with 1 if one has more than 2 % more than on record. --update writes the record anew.
"""

import csv
import pathlib
import re
import subprocess
import sys
import tempfile

RECORD = pathlib.Path(__file__).with_name("kernel_instructions.csv")
ALLOWED = 0.02
FORMS = ("affine", "flip")
KERNELS = (
    "diffuse", "update_grid_energy", "grid_to_particles_to_grid", "favre_mean", "particles_to_grid",
    "absorb", "deposit", "deposit_losses",
    "signed_distance", "find_free_surface", "make_light_map", "make_lane_layout", "make_nodes", "fill_scenario",
)


def count(program, form):
    """Instructions of each kernel, what it calls included."""
    with tempfile.TemporaryDirectory() as folder:
        profile = f"{folder}/callgrind.out"
        subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", program, form],
                       check=True, stderr=subprocess.PIPE)
        table = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", "--show-percs=no", profile],
                               check=True, capture_output=True, text=True).stdout
    counts = {}
    for line in table.splitlines():
        found = re.match(r"\s*([\d,]+)\s.*:meltscope::(\w+)\(", line)
        if found and found[2] in KERNELS and "[clone" not in line:
            # overloads call each other: the outer one counts
            counts[found[2]] = max(counts.get(found[2], 0), int(found[1].replace(",", "")))
    missing = [kernel for kernel in KERNELS if kernel not in counts]
    if missing:
        sys.exit(f"callgrind saw nothing of {', '.join(missing)}")
    return counts


def compiler():
    return subprocess.run(["c++", "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]


def main():
    words = [word for word in sys.argv[1:] if word != "--update"]
    if len(words) != 1:
        sys.exit(__doc__)
    now = {(form, kernel): n for form in FORMS for kernel, n in count(words[0], form).items()}
    if "--update" in sys.argv:
        with RECORD.open("w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(["form", "kernel", "instructions", compiler()])
            rows.writerows([form, kernel, n] for (form, kernel), n in now.items())
        return
    with RECORD.open(newline="") as file:
        head, *rows = csv.reader(file)
    if head[3] != compiler():
        print(f"the record is of another compiler: {head[3]}")
    moved = []
    for form, kernel, before in rows:
        change = now[form, kernel] / int(before) - 1.0
        print(f"{form:8}{kernel:28}{now[form, kernel]:>14,}{100.0 * change:>+9.2f} %")
        if change > ALLOWED:
            moved.append(f"{kernel} ({form})")
    if moved:
        sys.exit(f"more instructions than on record: {', '.join(moved)}")


if __name__ == "__main__":
    main()

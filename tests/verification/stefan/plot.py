#!/usr/bin/python3
"""Plots what meltscope_stefan_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Melting front, two phases")
for case in ("1_1", "2_1"):
    data = read(f"stefan_{case}_front")
    axes.plot(data["time"], data["exact_cells"], "k-")
    axes.plot(data["time"], data["computed_cells"], "o", mfc="none", label="St " + case.replace("_", ", "))
axes.set(xlabel="t alpha / dx^2", ylabel="front (cells)")
save(axes, "stefan")

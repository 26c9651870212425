#!/usr/bin/python3
"""Plots what meltscope_two_slabs_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Two slabs of different materials in contact")
data = read("two_slabs_profile")
axes.plot(data["x"], data["exact"], "k-", label="exact")
axes.plot(data["x"], data["computed"], "o", mfc="none", ms=4, label="80 cells")
axes.set(xlabel="x", ylabel="T (K)")
save(axes, "two_slabs")

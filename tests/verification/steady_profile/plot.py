#!/usr/bin/python3
"""Plots what meltscope_steady_profile_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Steady profile between two faces of fixed temperature")
data = read("steady_profile_profile")
axes.plot(data["x"], data["exact"], "k-", label="exact")
axes.plot(data["x"], data["computed"], "o", mfc="none", label="16 cells")
axes.set(xlabel="x", ylabel="T (K)")
save(axes, "steady_profile")

#!/usr/bin/python3
"""Plots what meltscope_step_at_a_wall_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Sudden step at a wall of fixed temperature")
data = read("step_at_a_wall_profile")
axes.plot(data["depth"], data["exact"], "k-", label="erfc")
axes.plot(data["depth"], data["computed"], "o", mfc="none", label="25 cells")
axes.set(xlabel="depth", ylabel="T (K)")
save(axes, "step_at_a_wall")

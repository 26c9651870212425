#!/usr/bin/python3
"""Plots what meltscope_level_set_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Signed distance and surface area")
data = read("level_set_radius")
axes.loglog(data["radius_cells"], data["rms_error_cells"] / data["radius_cells"], "o-", label="rms error / R")
axes.loglog(data["radius_cells"], data["max_error_by_radius"], "s--", label="largest error / R")
axes.set(xlabel="R / dx", ylabel="error of the distance to a sphere")
save(axes, "level_set")

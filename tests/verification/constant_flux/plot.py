#!/usr/bin/python3
"""Plots what meltscope_constant_flux_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Constant flux into a half space")
data = read("constant_flux_profile")
axes.plot(data["depth"], data["exact"], "k-", label="exact")
axes.plot(data["depth"], data["computed"], "o", mfc="none", label="25 cells")
axes.set(xlabel="depth", ylabel="rise (K)")
save(axes, "constant_flux")

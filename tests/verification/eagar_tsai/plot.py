#!/usr/bin/python3
"""Plots what meltscope_eagar_tsai_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Moving Gaussian beam on a plate")
for peclet in (1, 2, 7):
    data = read(f"eagar_tsai_pe{peclet}_4dx_profiles")
    surface = data["depth"] == 0
    axes.plot(data["x"][surface], data["exact"][surface], "k-")
    axes.plot(data["x"][surface], data["computed"][surface], "o", mfc="none", ms=4, label=f"Pe {peclet}, sigma = 4 dx")
axes.set(xlabel="x from the beam / sigma", ylabel="rise / steady peak")
save(axes, "eagar_tsai")

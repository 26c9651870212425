#!/usr/bin/python3
"""Plots what meltscope_evaporation_rate_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

rows = read("evaporation_rate")
axes = figure("Evaporation of 316L into vacuum")
axes.semilogy(rows["temperature_K"], rows["reference_W_per_m2"], "k-", label="Hertz and Knudsen, reference.csv")
axes.semilogy(rows["temperature_K"], rows["computed_W_per_m2"], "o", fillstyle="none", markersize=9, label="plate of particles")
axes.set_xlabel("temperature (K)")
axes.set_ylabel("heat flux (W/m$^2$)")
save(axes, "evaporation_rate")

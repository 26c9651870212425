#!/usr/bin/python3
"""Plots what meltscope_repeated_passes_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Ten passes over the same track")
for form in ("affine", "flip"):
    data = read(f"repeated_passes_{form}")
    axes.semilogy(data["pass"], data["spread_percent"], "o-", label=form)
axes.set(xlabel="pass", ylabel="spread of the particles about the nodes, % of the peak")
save(axes, "repeated_passes")

#!/usr/bin/python3
"""Plots what meltscope_heat_kernel_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

axes = figure("Heat kernel in an adiabatic box")
for form in ("affine", "flip"):
    data = read(f"heat_kernel_{form}")
    axes.loglog(1 / data["cells"], data["max_error"], "o-", label=f"{form}, largest")
    axes.loglog(1 / data["cells"], data["rms_error"], "s--", label=f"{form}, rms")
axes.loglog([1 / 48, 1 / 12], [1e-4, 1.6e-3], "k:", label="second order")
axes.set(xlabel="cell size", ylabel="error by the peak rise")
save(axes, "heat_kernel")

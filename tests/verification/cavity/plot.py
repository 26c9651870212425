#!/usr/bin/python3
"""Plots what meltscope_cavity_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

rows = read("cavity")
axes = figure("A ball at 2000 K in a hollow at 300 K, radii 6 and 11 cells")
emissivity = np.linspace(0.05, 1.0, 200)
ratio = (6.0 / 11.0) ** 2
black = rows["exact_W"][rows["emissivity"] == 1.0][0]
axes.plot(emissivity, 1e3 * black / (1.0 / emissivity + ratio * (1.0 / emissivity - 1.0)), "k-",
          label="concentric grey spheres")
axes.plot(rows["emissivity"], 1e3 * rows["computed_W"], "o", fillstyle="none", markersize=9, label="exchange by rays")
axes.set_xlabel("emissivity")
axes.set_ylabel("power (mW)")
save(axes, "cavity")

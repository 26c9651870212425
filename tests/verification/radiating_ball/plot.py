#!/usr/bin/python3
"""Plots what meltscope_radiating_ball_verification wrote: plot.py [FOLDER WITH THE CSV FILES]."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reference"))
from plotting import figure, read, save

rows = read("radiating_ball")
axes = figure("A black ball of 0.2 mm radiates into surroundings at 300 K")
for cells in np.unique(rows["cells_in_radius"]):
    mine = rows[rows["cells_in_radius"] == cells]
    axes.plot(mine["time_s"], mine["computed_K"], "o", fillstyle="none", markersize=4 + cells, label=f"R = {cells:.0f} dx")
axes.plot(mine["time_s"], mine["exact_K"], "k-", label="lumped equation")
axes.set_xlabel("time (s)")
axes.set_ylabel("mean temperature (K)")
save(axes, "radiating_ball")

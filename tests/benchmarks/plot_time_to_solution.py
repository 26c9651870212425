#!/usr/bin/python3
"""Draws wall time against error: plot_time_to_solution.py CSV SVG. CSV: what meltscope_time_to_solution printed."""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SERIES = [
    ("differences", 0, "none", 0.0, "finite differences, 7 points", "k", "s"),
    ("particles", 1, "affine", 1e-6, "1 particle a cell, affine", "C0", "o"),
    ("particles", 8, "affine", 1e-6, "8 particles a cell, affine", "C1", "o"),
    ("particles", 8, "affine", 0.1, "8 particles a cell, affine, quiescent below 0.1 K", "C2", "."),
    ("particles", 1, "flip", 1e-6, "1 particle a cell, flip", "C0", "x"),
    ("particles", 8, "flip", 1e-6, "8 particles a cell, flip", "C1", "x"),
]

data = np.genfromtxt(sys.argv[1], delimiter=",", names=True, dtype=None, encoding="utf-8",
                     skip_header=1)
plt.rcParams["svg.hashsalt"] = "meltscope"
figure, axes = plt.subplots(figsize=(7.5, 5.0), layout="constrained")
for method, per_cell, transfer, tolerance, label, colour, marker in SERIES:
    rows = data[(data["method"] == method) & (data["particles_per_cell"] == per_cell)
                & (data["transfer"] == transfer) & (data["quiescent_tolerance_k"] == tolerance)]
    axes.plot(rows["error_percent"], rows["seconds"], marker, color=colour, mfc="none", label=label)
    for row in rows:
        axes.annotate(f"{row['cell_um']:g}", (row["error_percent"], row["seconds"]), xytext=(4, 3),
                      textcoords="offset points", fontsize=7, color=colour)
axes.set(xscale="log", yscale="log", xlabel="largest error at a node, % of the peak rise",
         ylabel="wall time of the time loop, s", title="Track on a plate: time against error (figures: cell size in um)")
axes.grid(True, which="both", lw=0.3)
axes.legend()
figure.savefig(sys.argv[2], metadata={"Date": None})

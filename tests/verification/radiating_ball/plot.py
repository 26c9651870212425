"""Draws the cooling curves: plot.py radiating_ball.csv picture.png"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

rows = list(csv.DictReader(open(sys.argv[1])))
figure, axes = plt.subplots(figsize=(6, 4))
for cells in sorted({float(r["cells_in_radius"]) for r in rows}):
    mine = [r for r in rows if float(r["cells_in_radius"]) == cells]
    axes.plot([float(r["time_s"]) for r in mine], [float(r["computed_K"]) for r in mine], "o", fillstyle="none",
              ms=4 + cells, label=f"R = {cells:.0f} dx")
axes.plot([float(r["time_s"]) for r in mine], [float(r["exact_K"]) for r in mine], "k-", label="lumped")
axes.set_xlabel("time (s)")
axes.set_ylabel("mean temperature (K)")
axes.legend()
figure.tight_layout()
figure.savefig(sys.argv[2], dpi=150)

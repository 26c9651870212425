"""What the plot scripts of the verification cases share."""
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

FOLDER = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("build/release/tests/verification")


def read(name):
    """The columns of NAME.csv by their headings."""
    return np.genfromtxt(FOLDER / f"{name}.csv", delimiter=",", names=True)


def figure(title):
    _, axes = plt.subplots(figsize=(7, 4.5))
    axes.set_title(title)
    return axes


def save(axes, name):
    axes.grid(alpha=0.3)
    axes.legend()
    axes.figure.savefig(FOLDER / f"{name}.png", dpi=120, bbox_inches="tight")
    print(FOLDER / f"{name}.png")

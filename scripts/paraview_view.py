#!/usr/bin/env pvpython
"""Shows a run folder of meltscope in ParaView 5.11 or later, with the views of its own pictures.

    pvpython scripts/paraview_view.py RUN_FOLDER [--view overview|section|top|pool] [--time SECONDS] [--image FILE.png]
    MELTSCOPE_RUN=RUN_FOLDER paraview --script=scripts/paraview_view.py

Without --image, pvpython writes RUN_FOLDER/plots/paraview_VIEW.png.
"""

import argparse
import csv
import os
import sys

from paraview import simple

LIQUIDUS_MARGIN = 1.2  # the colours end this many times above liquidus, as in meltscope's own pictures


def parse_arguments():
    parser = argparse.ArgumentParser(description="Show a run folder of meltscope in ParaView.")
    parser.add_argument("run", nargs="?", default=os.environ.get("MELTSCOPE_RUN"))
    parser.add_argument("--view", choices=["overview", "section", "top", "pool"], default="overview")
    parser.add_argument("--time", type=float, help="seconds; the last time by default")
    parser.add_argument("--image", help="write this picture")
    parser.add_argument("--size", type=int, nargs=2, default=[1280, 720])
    arguments, _ = parser.parse_known_args()
    if not arguments.run:
        parser.error("which run folder? Give it as argument or in MELTSCOPE_RUN")
    return arguments


def open_collection(run, kind):
    path = os.path.join(run, kind + ".pvd")
    if not os.path.exists(path):
        return None
    reader = simple.PVDReader(registrationName=kind, FileName=path)
    reader.UpdatePipeline()
    return reader


def laser_position(run, time):
    """x and y of the laser nearest to that time, from melt_pool.csv; None without the table."""
    path = os.path.join(run, "melt_pool.csv")
    if not os.path.exists(path):
        return None
    with open(path, newline="") as table:
        rows = [row for row in csv.DictReader(table) if row.get("laser_x_m")]
    if not rows:
        return None
    row = min(rows, key=lambda entry: abs(float(entry["time_s"]) - time))
    return float(row["laser_x_m"]), float(row["laser_y_m"])


def color_by_temperature(source, view, temperatures):
    simple.ColorBy(simple.Show(source, view), ("POINTS", "temperature"))
    table = simple.GetColorTransferFunction("temperature")
    table.ApplyPreset("Inferno (matplotlib)", True)
    table.RescaleTransferFunction(*temperatures)


def coldest(source):
    """The lowest temperature in a data set, K; None if it is empty or there is none."""
    if source is None:
        return None
    information = source.GetDataInformation().GetPointDataInformation().GetArrayInformation("temperature")
    return information.GetComponentRange(0)[0] if information else None


def show_isotherm(source, temperature, view):
    line = simple.Contour(registrationName="liquidus", Input=source)
    line.ContourBy = ["POINTS", "temperature"]
    line.Isosurfaces = [temperature]
    shown = simple.Show(line, view)
    shown.ColorArrayName = ["POINTS", ""]
    shown.AmbientColor = shown.DiffuseColor = [1, 1, 1]
    shown.LineWidth = 2


def add_color_bar(view):
    bar = simple.GetScalarBar(simple.GetColorTransferFunction("temperature"), view)
    bar.Title = "temperature (K)"
    bar.ComponentTitle = ""
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = "%.0f"
    bar.Visibility = 1


def center_of(source):
    x0, x1, y0, y1, z0, z1 = source.GetDataInformation().GetBounds()
    return [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2], max(x1 - x0, y1 - y0, z1 - z0)


def look(view, center, offset, up, parallel):
    view.CameraFocalPoint = center
    view.CameraPosition = [c + o for c, o in zip(center, offset)]
    view.CameraViewUp = up
    view.CameraParallelProjection = 1 if parallel else 0


def main():
    arguments = parse_arguments()
    surface = open_collection(arguments.run, "surface")
    if surface is None:
        sys.exit(f"{arguments.run} has no surface.pvd: is it a run folder of meltscope with output.surface on?")
    pool = open_collection(arguments.run, "pool")
    grid = open_collection(arguments.run, "grid")

    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(surface.TimestepValues) or [0.0]
    time = arguments.time if arguments.time is not None else times[-1]
    scene.AnimationTime = time
    for reader in (surface, pool, grid):
        if reader is not None:
            reader.UpdatePipeline(time)

    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = arguments.size
    view.ViewTime = time
    liquidus = coldest(pool)  # the pool's surface is the liquidus isotherm
    temperatures = (coldest(surface), LIQUIDUS_MARGIN * liquidus if liquidus else 2000.0)
    center, size = center_of(surface)
    laser = laser_position(arguments.run, time)
    if laser is None and liquidus:
        laser = tuple(center_of(pool)[0][:2])

    if arguments.view == "section":
        if grid is None:
            sys.exit("the section view needs grid.pvd: run with output.grid = true")
        material = simple.Threshold(registrationName="material", Input=grid)
        material.Scalars = ["POINTS", "phi"]
        material.LowerThreshold = -1e9
        material.UpperThreshold = 0.0
        material.ThresholdMethod = "Between"
        cut = simple.Slice(registrationName="section", Input=material)
        cut.SliceType.Origin = [center[0], laser[1] if laser else center[1], center[2]]
        cut.SliceType.Normal = [0, 1, 0]
        cut.UpdatePipeline(time)
        color_by_temperature(cut, view, temperatures)
        if liquidus:
            show_isotherm(cut, liquidus, view)
        look(view, center_of(cut)[0], [0, -2 * size, 0], [0, 0, 1], True)
    elif arguments.view == "pool":
        if not liquidus:
            sys.exit("nothing is molten at that time; choose another with --time")
        color_by_temperature(pool, view, temperatures)
        pool_center, pool_size = center_of(pool)
        look(view, pool_center, [0.3 * pool_size, -1.6 * pool_size, -0.9 * pool_size], [0, 0, 1], False)
    else:
        color_by_temperature(surface, view, temperatures)
        if liquidus:
            show_isotherm(surface, liquidus, view)
        if arguments.view == "top":
            look(view, center, [0, 0, 2 * size], [0, 1, 0], True)
        else:
            look(view, center, [-0.6 * size, -1.9 * size, 1.6 * size], [0, 0, 1], False)
    add_color_bar(view)
    simple.ResetCamera(view)
    simple.GetActiveCamera().Zoom(1.5)
    simple.Render(view)

    image = arguments.image
    if image is None and os.path.basename(sys.executable).startswith(("pvpython", "pvbatch", "python")):
        image = os.path.join(arguments.run, "plots", f"paraview_{arguments.view}.png")
    if image is not None:
        os.makedirs(os.path.dirname(os.path.abspath(image)), exist_ok=True)
        simple.SaveScreenshot(image, view, ImageResolution=arguments.size)
        print(image)


main()

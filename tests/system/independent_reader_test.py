"""Programs that know nothing of meltscope read every kind of file it writes, and find arrays, times and sane values."""

import json
import subprocess
import sys
import tomllib
import unittest
import xml.etree.ElementTree as ElementTree

try:
    import h5py
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from program import QUICK_LOOK, SMALL, ProgramTest

TIMES = [k * 4e-5 for k in range(8)]
COLD, HOT = 200.0, 6000.0  # K; cells of 40 um leave wiggles at the edge of the spot
POWER = 179.2  # W


def point_arrays(data):
    arrays = data.GetPointData()
    return {arrays.GetArrayName(n): vtk_to_numpy(arrays.GetArray(n)) for n in range(arrays.GetNumberOfArrays())}


class IndependentReader(ProgramTest):
    def setUp(self):
        super().setUp()
        self.run_folder = self.folder / "run"
        self.must_succeed("run", QUICK_LOOK, *SMALL, "--set", "output.grid=true", "--set", "output.particles=all", "--set",
                          "render.size=[640,360]", "--set", "checkpoint.every=0.08 ms", "--output", self.run_folder)

    def test_every_kind_of_file_can_be_read(self):
        # One run serves all: it is the dearest part.
        for check in (self.series, self.table, self.checkpoint, self.texts, self.pictures, self.movie):
            with self.subTest(check=check.__name__):
                check()

    def absorbed_power(self):
        """W, but for the little light that misses the plate."""
        laser = tomllib.loads((self.run_folder / "run.toml").read_text())["laser"][0]
        return laser["absorptivity"] * POWER

    def read_series(self, name):
        """Yields time, data set and arrays of every file that NAME.pvd lists."""
        root = ElementTree.parse(self.run_folder / f"{name}.pvd").getroot()
        entries = [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in root.iter("DataSet")]
        self.assertEqual([time for time, _ in entries], TIMES)
        for time, file in entries:
            reader = vtkXMLImageDataReader() if name == "grid" else vtkXMLPolyDataReader()
            complaints = []
            reader.AddObserver("ErrorEvent", lambda *_: complaints.append(file))
            reader.AddObserver("WarningEvent", lambda *_: complaints.append(file))
            reader.SetFileName(str(self.run_folder / file))
            reader.Update()
            self.assertEqual(complaints, [])
            data = reader.GetOutput()
            self.assertEqual(data.GetFieldData().GetArray("TimeValue").GetValue(0), time)
            yield time, data, point_arrays(data)

    def series(self):
        for _, data, arrays in self.read_series("particles"):
            self.assertEqual(data.GetNumberOfPoints(), 10000)
            self.assertTrue(np.array_equal(arrays["id"], np.arange(10000)))
            self.assert_sane(arrays["temperature"])
            self.assertTrue(np.all((arrays["liquid_fraction"] >= 0) & (arrays["liquid_fraction"] <= 1)))
            self.assertLessEqual({"specific_energy", "phi_hat", "material"}, set(arrays))
        for _, data, arrays in self.read_series("surface"):
            self.assertGreater(data.GetNumberOfPolys(), 400)
            self.assert_sane(arrays["temperature"])
            points = vtk_to_numpy(data.GetPoints().GetData())
            self.assertLess(np.abs(points[:, 2]).max(), 1e-5)  # the plate's top, within a quarter of a cell
            self.assertTrue(np.allclose(arrays["normals"][:, 2], 1.0, atol=1e-2))
        for time, data, arrays in self.read_series("pool"):
            if time > 1e-4:
                self.assertGreater(data.GetNumberOfPolys(), 10)
        for _, data, arrays in self.read_series("grid"):
            self.assertEqual(data.GetDimensions(), (26, 11, 7))
            self.assertLessEqual({"phi", "phi_hat", "temperature", "mass"}, set(arrays))
            # Ghost nodes beyond the cold faces, which are no part of the file, hold a little.
            self.assertAlmostEqual(arrays["mass"].sum() / (7569.92 * 1e-3 * 0.4e-3 * 0.2e-3), 1.0, delta=0.02)

    def assert_sane(self, temperature):
        self.assertTrue(np.all(np.isfinite(temperature)))
        self.assertGreater(temperature.min(), COLD)
        self.assertLess(temperature.max(), HOT)

    def table(self):
        table = np.genfromtxt(self.run_folder / "melt_pool.csv", delimiter=",", names=True)
        self.assertEqual(list(table["time_s"]), TIMES)
        self.assertTrue(np.allclose(table["laser_x_m"], 2e-4 + 0.8 * table["time_s"], rtol=0, atol=1e-12))
        self.assertTrue(np.allclose(table["absorbed_J"], self.absorbed_power() * table["time_s"], rtol=1e-3))
        last = table[-1]
        for figure, least, most in (("length_m", 1e-4, 5e-4), ("width_m", 4e-5, 3e-4), ("depth_m", 5e-6, 1e-4),
                                    ("peak_K", 1563.0, HOT)):
            self.assertTrue(least < last[figure] < most, f"{figure} = {last[figure]}")

    def checkpoint(self):
        files = sorted((self.run_folder / "checkpoints").glob("*.h5"))
        self.assertEqual(len(files), 2)  # keep = 2
        with h5py.File(files[-1]) as file:
            self.assertAlmostEqual(file.attrs["time"], 0.28e-3, places=15)
            self.assertEqual(file["particles/position"].shape, (10000, 3))
            self.assertEqual(file["grid/mass_energy"].shape, (9, 13, 28))
            ledger = dict(file["ledger"].attrs)
            held = float(np.sum(file["particles/mass"][:] * file["particles/specific_energy"][:]))
            self.assertAlmostEqual(held / ledger["stored"], 1.0, places=12)
            self.assertAlmostEqual(ledger["absorbed"] / (self.absorbed_power() * 0.28e-3), 1.0, places=3)
            resolved = tomllib.loads(file["scenario"].asstr()[0])
            self.assertEqual(resolved, tomllib.loads((self.run_folder / "run.toml").read_text()))

    def texts(self):
        summary = json.loads((self.run_folder / "run.json").read_text())
        self.assertEqual(summary["outcome"], "done")
        self.assertEqual(summary["particles"], 10000)
        resolved = tomllib.loads((self.run_folder / "run.toml").read_text())
        self.assertEqual(resolved["laser"][0]["power"], POWER)

    def pictures(self):
        files = sorted((self.run_folder / "frames").glob("overview_*.png"))
        if not files and "no picture" in (self.run_folder / "log.txt").read_text():
            self.skipTest("nothing to draw on")
        self.assertEqual(len(files), len(TIMES))
        reader = vtkPNGReader()
        reader.SetFileName(str(files[-1]))
        reader.Update()
        self.assertEqual(reader.GetOutput().GetDimensions()[:2], (640, 360))
        pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
        self.assertGreater(len(np.unique(pixels, axis=0)), 100)

    def movie(self):
        said = subprocess.run(["ffprobe", "-v", "error", "-show_streams", "-of", "json", self.run_folder / "overview.mp4"],
                              capture_output=True, text=True, check=True).stdout
        stream = json.loads(said)["streams"][0]
        self.assertEqual((stream["codec_name"], stream["pix_fmt"]), ("h264", "yuv420p"))
        self.assertEqual((stream["width"], stream["height"]), (640, 360))
        self.assertEqual(int(stream["nb_frames"]), len(TIMES))


if __name__ == "__main__":
    unittest.main()

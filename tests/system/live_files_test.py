"""Data files as other programs meet them: while the run goes on, in every format, and after restarts."""

import signal
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from program import PATIENCE, PROGRAM, QUICK_LOOK, SMALL, ProgramTest

READERS = {".vtp": vtkXMLPolyDataReader, ".vti": vtkXMLImageDataReader, ".vtu": vtkXMLUnstructuredGridReader}


def entries(collection):
    """Times and files that a PVD names."""
    root = ElementTree.parse(collection).getroot()
    assert root.tag == "VTKFile" and root.attrib["type"] == "Collection"
    return [(float(entry.attrib["timestep"]), collection.parent / entry.attrib["file"]) for entry in
            root.iter("DataSet")]


class Files(ProgramTest):
    def read(self, path, time):
        """The data set of a file, which must be whole and of that time."""
        complaints = []
        reader = READERS[path.suffix]()
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, lambda *_: complaints.append(path))
        reader.SetFileName(str(path))
        reader.Update()
        self.assertEqual(complaints, [])
        data = reader.GetOutput()
        self.assertEqual(data.GetFieldData().GetArray("TimeValue").GetValue(0), time)
        return data

    def test_collections_are_valid_at_every_moment_of_the_run(self):
        folder = self.folder / "run"
        process = subprocess.Popen(
            [PROGRAM, "run", str(QUICK_LOOK), "--set", "domain.cell_size=40 um", "--set", "time.max_step=1 us", "--set",
             "time.end=1 s", "--set", "output.every=4 us", "--set", "output.grid=true", "--no-render", "--output",
             str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        collections = [folder / f"{kind}.pvd" for kind in ("particles", "surface", "pool", "grid")]
        deadline = time.monotonic() + PATIENCE
        while not all(path.exists() for path in collections):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        looks, counts = 0, set()
        deadline = time.monotonic() + PATIENCE
        while looks < 100 or len(counts) < 10:  # the collections grow meanwhile
            self.assertLess(time.monotonic(), deadline, f"{looks} looks, {len(counts)} lengths")
            for collection in collections:
                listed = entries(collection)  # fails for a torn file
                self.assertEqual(listed, sorted(listed))
                for _, path in listed:
                    self.assertTrue(path.exists(), path)
                if listed:
                    self.read(listed[-1][1], listed[-1][0])
                counts.add(len(listed))
                looks += 1
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=PATIENCE), 3, process.stderr.read())
        process.stderr.close()

    def test_all_particles_come_as_unstructured_grid_when_asked(self):
        self.run_small("run", "--set", "output.particles=all", "--set", "output.particles_format=vtu", "--set",
                       "output.compression=lz4", "--set", "output.precision=float64")
        listed = entries(self.folder / "run" / "particles.pvd")
        self.assertEqual(len(listed), 8)
        for moment, path in listed:
            self.assertEqual(path.suffix, ".vtu")
            data = self.read(path, moment)
            self.assertEqual((data.GetNumberOfPoints(), data.GetNumberOfCells()), (10000, 10000))
            self.assertEqual(vtk_to_numpy(data.GetPointData().GetArray("temperature")).itemsize, 8)
        self.assertIn('compressor="vtkLZ4DataCompressor"', listed[0][1].read_bytes()[:400].decode(errors="replace"))

    def test_precisions_and_compressions_hold_the_same_numbers(self):
        found = {}
        for precision, size in (("float32", 4), ("float64", 8)):
            for compression in ("none", "lz4", "zlib"):
                name = f"{precision}_{compression}"
                self.run_small(name, "--until", "40 us", "--set", f"output.precision={precision}", "--set",
                               f"output.compression={compression}")
                moment, path = entries(self.folder / name / "surface.pvd")[-1]
                text = path.read_bytes()[:400].decode(errors="replace")
                self.assertEqual("compressor=" in text, compression != "none")
                temperature = vtk_to_numpy(self.read(path, moment).GetPointData().GetArray("temperature"))
                self.assertEqual(temperature.itemsize, size)
                found.setdefault(precision, []).append(temperature.tolist())
        for same in found.values():
            self.assertEqual(same[0], same[1])
            self.assertEqual(same[0], same[2])
        for single, double in zip(found["float32"][0], found["float64"][0]):
            self.assertAlmostEqual(single / double, 1.0, places=6)

    def test_restart_names_no_time_twice(self):
        self.run_small("run", "--set", "checkpoint.every=0.1 ms", "--set", "checkpoint.keep=9")
        before = {kind: entries(self.folder / "run" / f"{kind}.pvd") for kind in ("particles", "surface", "pool")}
        for checkpoint in sorted((self.folder / "run" / "checkpoints").iterdir())[:2]:
            self.must_succeed("run", "--restart", checkpoint, "--no-render")
        for kind, listed in before.items():
            times = [moment for moment, _ in entries(self.folder / "run" / f"{kind}.pvd")]
            self.assertEqual(len(times), len(set(times)))
            self.assertEqual(times, [moment for moment, _ in listed])


class Tables(ProgramTest):
    def rows(self, name, table="melt_pool.csv"):
        header, *rows = (self.folder / name / table).read_text().splitlines()
        return [dict(zip(header.split(","), row.split(","))) for row in rows]

    def test_pool_rows_come_by_step_when_asked_and_survive_a_restart(self):
        by_step = ["--set", "output.pool_rows=step", "--set", "checkpoint.every=1 s"]
        self.run_small("outputs")
        self.run_small("steps", *by_step)
        rows = self.rows("steps")
        times = [float(row["time_s"]) for row in rows]
        self.assertEqual(times, sorted(set(times)))
        self.assertGreater(len(rows), 60)
        for row in self.rows("outputs"):
            self.assertIn(row, rows)
        self.run_small("cut", *by_step, "--steps", "17")
        [checkpoint] = (self.folder / "cut" / "checkpoints").iterdir()
        self.must_succeed("run", "--restart", checkpoint, "--no-render")
        for table in ("melt_pool.csv", "melt_pools.csv"):
            self.assertEqual((self.folder / "steps" / table).read_bytes(), (self.folder / "cut" / table).read_bytes())

    def test_each_laser_has_its_columns_and_each_pool_its_row(self):
        scenario = QUICK_LOOK.parent / "coarse" / "two_lasers.toml"
        self.must_succeed("run", scenario, "--no-render", "--output", self.folder / "run")
        apart = [row for row in self.rows("run") if float(row["length_m"]) > 0 and float(row["time_s"]) < 0.2e-3]
        self.assertTrue(apart)
        for row in apart:  # the scene is its own mirror image
            for figure in ("length_m", "width_m", "depth_m", "volume_m3", "power_W", "speed_m_s"):
                self.assertAlmostEqual(float(row[figure]) / float(row[figure + "_right"]), 1.0, places=3)
            self.assertLess(float(row["length_m"]), 0.3e-3)
        pools = [row for row in self.rows("run", "melt_pools.csv") if row["time_s"] == apart[-1]["time_s"]]
        self.assertEqual(sorted(pool["lasers"] for pool in pools), ["left", "right"])
        for pool in pools:
            suffix = "" if pool["lasers"] == "left" else "_right"
            self.assertEqual(pool["length_m"], apart[-1]["length_m" + suffix])
            self.assertLess(abs(float(pool["x_m"]) - float(apart[-1]["laser_x_m" + suffix])), 0.15e-3)


class DiskSpace(ProgramTest):
    def test_the_need_is_told_before_the_run_and_is_about_right(self):
        text = self.run_small("run", "--set", "output.grid=true").stdout
        [line] = [line for line in text.splitlines() if "on the disk" in line]
        self.assertLess(text.index("on the disk"), text.index("step "))
        amount, unit = line.split("data files ")[1].split(",")[0].split()
        told = float(amount) * {"kB": 1e3, "MB": 1e6, "GB": 1e9}[unit]
        written = sum(path.stat().st_size for kind in ("particles", "surface", "pool", "grid")
                      for path in (self.folder / "run" / kind).iterdir())
        self.assertLess(0.5 * written, told)
        self.assertLess(told, 2.0 * written)
        self.assertIn("# disk", self.must_succeed("check", QUICK_LOOK, *SMALL).stdout)

    def test_a_disk_that_is_too_small_is_told(self):
        result = self.must_succeed("run", QUICK_LOOK, *SMALL, "--set", "output.every=0.5 ns", "--set",
                                   "output.particles=all", "--set", "output.grid=true", "--set", "render.every=1 ns",
                                   "--set", "render.size=[8192,8192]", "--steps", "1", "--render-backend", "none",
                                   "--output", self.folder / "run")
        self.assertIn("the disk may be too small", result.stderr)


if __name__ == "__main__":
    unittest.main()

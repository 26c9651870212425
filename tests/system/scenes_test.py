"""The coarse twins of the scenarios run, melt something and keep their energy; bad input to each part is refused."""

import csv
import json
import unittest

from program import SCENARIOS, ProgramTest

TWINS = sorted((SCENARIOS / "coarse").glob("*.toml"))

# Share of the energy that may go unaccounted for.
RESIDUAL = 1e-12


class Scenes(ProgramTest):
    def run_twin(self, name, *arguments):
        folder = self.folder / name
        self.must_succeed("run", SCENARIOS / "coarse" / f"{name}.toml", "--no-render", "--output", folder, *arguments)
        return folder

    def test_every_scenario_has_a_coarse_twin_and_a_picture(self):
        shown = (SCENARIOS / "README.md").read_text()
        names = {path.stem for path in TWINS}
        for path in SCENARIOS.glob("*.toml"):
            if path.stem not in ("in625_single_track", "quick_look"):
                self.assertIn(path.stem, names)
            self.assertIn(f"{path.stem}.toml", shown)
        for name in names:
            self.assertTrue((SCENARIOS / "pictures" / f"{name}.png").exists(), name)

    def test_every_coarse_twin_melts_and_keeps_its_energy(self):
        for path in TWINS:
            with self.subTest(path.stem):
                folder = self.run_twin(path.stem)
                run = json.loads((folder / "run.json").read_text())
                self.assertLessEqual(abs(run["ledger"]["relative_residual"]), RESIDUAL)
                with open(folder / "melt_pool.csv", newline="") as table:
                    rows = list(csv.DictReader(table))
                self.assertGreater(max(float(row["peak_K"]) for row in rows), 1400.0)
                for row in rows:
                    self.assertLess(float(row["peak_K"]), 6000.0)
                if path.stem != "powder_reabsorption":
                    self.assertGreater(max(float(row["width_m"]) for row in rows), 20e-6)

    def test_full_scenarios_are_valid(self):
        for path in SCENARIOS.glob("*.toml"):
            with self.subTest(path.stem):
                self.must_succeed("check", path)

    def test_solidification_table_is_on_the_grid_and_in_order_of_time(self):
        folder = self.run_twin("raster_hatch", "--set", "laser.pattern.hatch=40 um")
        with open(folder / "solidification.csv", newline="") as table:
            self.assertEqual(table.readline().strip(), "x,y,z,tm,tl,cr")
            rows = [tuple(map(float, row)) for row in csv.reader(table)]
        self.assertGreater(len(rows), 10)
        for x, y, z, tm, tl, cr in rows:
            for place in (x, y, z):
                cells = place / 20e-6
                self.assertAlmostEqual(cells, round(cells), places=4)
            self.assertLessEqual(tm, tl)
            self.assertGreater(cr, 0.0)
        places = [row[:3] for row in rows]
        self.assertLess(len(set(places)), len(places), "hatches overlap, so some nodes melt again")
        self.assertTrue((folder / "solidification.vtp").read_text(errors="replace").count('Name="G"'))

    def test_without_solidification_there_is_no_table(self):
        folder = self.run_twin("two_lasers")
        self.assertFalse((folder / "solidification.csv").exists())

    def test_a_layer_adds_particles_once_also_over_a_restart(self):
        whole = self.run_twin("two_layers", "--set", "checkpoint.every=0.4 ms", "--set", "checkpoint.keep=9",
                              "--set", "output.solidification=true")
        layers = json.loads((whole / "run.json").read_text())
        self.assertGreater(layers["ledger"]["added"], 0.0)
        first = sorted((whole / "checkpoints").glob("*.h5"))[0]
        again = self.folder / "again"
        self.must_succeed("run", "--restart", first, "--no-render", "--output", again)
        part = json.loads((again / "run.json").read_text())
        self.assertEqual(part["particles"], layers["particles"])
        self.assertEqual(part["ledger"], layers["ledger"])
        last = sorted((whole / "checkpoints").glob("*.h5"))[-1]
        self.assertEqual(last.read_bytes(), (again / "checkpoints" / last.name).read_bytes())
        self.assertEqual((whole / "solidification.csv").read_bytes(), (again / "solidification.csv").read_bytes())

    def test_reabsorption_keeps_heat_in_the_powder(self):
        on = json.loads((self.run_twin("powder_reabsorption") / "run.json").read_text())
        folder = self.folder / "off"
        self.must_succeed("run", SCENARIOS / "coarse" / "powder_reabsorption.toml", "--no-render", "--output", folder,
                          "--set", "physics.reabsorption=false")
        off = json.loads((folder / "run.json").read_text())
        self.assertLess(on["ledger"]["radiated"], off["ledger"]["radiated"])
        self.assertGreater(on["ledger"]["radiated"], 0.0)


BODY = 'title = "bad"\nmaterials = ["{materials}/{material}.toml"]\n' \
       '[domain]\nmin = [0, 0, 0]\nmax = ["400 um", "400 um", "200 um"]\ncell_size = "20 um"\n' \
       '[[body]]\nmaterial = "{material}"\n{body}\n' \
       '[[laser]]\npower = "100 W"\nabsorptivity = 0.4\nspot_radius = "50 um"\n{path}\n' \
       '[physics]\n{physics}\n[time]\nend = "0.1 ms"\n'

TETRAHEDRON = [((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
               ((0, 0, 0), (0, 0, 1), (0, 1, 0)), ((1, 0, 0), (0, 1, 0), (0, 0, 1))]


def stl(triangles):
    lines = ["solid part"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {} {} {}".format(*(0.1 * c for c in corner)) for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid part"]) + "\n"


class BadInput(ProgramTest):
    BOX = 'shape = "box"\nmin = [0, 0, 0]\nmax = ["400 um", "400 um", "100 um"]'
    PATH = 'path = [{move = ["100 um", "200 um", 0]}, {dwell = "50 us"}]'

    def write(self, body=BOX, path=PATH, physics="", material="in625", extra="", materials=SCENARIOS / "materials"):
        text = BODY.format(materials=materials, material=material, body=body, path=path, physics=physics)
        (self.folder / "bad.toml").write_text(text + extra)

    def refuse(self, *words, **scenario):
        self.write(**scenario)
        message = self.must_refuse("run", "bad.toml", "--no-render", "--overwrite")
        for word in words:
            self.assertIn(word, message)

    def test_an_open_solid_is_refused(self):
        (self.folder / "part.stl").write_text(stl(TETRAHEDRON[:3]))
        self.refuse("part.stl", "closed", body='shape = "stl"\nfile = "part.stl"\nscale = 0.001')

    def test_a_ball_with_a_negative_radius_is_refused_with_its_line(self):
        (self.folder / "balls.csv").write_text("x,y,z,r\n1e-4,1e-4,1e-4,2e-5\n2e-4,1e-4,1e-4,-2e-5\n")
        self.refuse("balls.csv:3", "radius", body='shape = "balls"\nfile = "balls.csv"')

    def test_a_ball_outside_the_domain_is_refused_with_its_line(self):
        (self.folder / "balls.csv").write_text("x,y,z,r\n1e-4,1e-4,1e-4,2e-5\n2,1e-4,1e-4,2e-5\n")
        self.refuse("balls.csv:3", "domain", body='shape = "balls"\nfile = "balls.csv"')

    def test_a_path_file_with_a_wrong_mode_is_refused_with_its_line(self):
        (self.folder / "path.txt").write_text("Mode X Y Z Power Param\n1 1e-4 2e-4 0 100 1e-5\n7 2e-4 2e-4 0 100 0.8\n")
        self.refuse("path.txt:3", "Mode must be 0", path='path_file = "path.txt"')

    def test_a_path_file_with_a_missing_column_is_refused_with_its_line(self):
        (self.folder / "path.txt").write_text("Mode X Y Z Power Param\n1 1e-4 2e-4 0 100 1e-5\n0 2e-4 2e-4 0 100\n")
        self.refuse("path.txt:3", "6", path='path_file = "path.txt"')

    def test_powder_that_cannot_be_packed_is_refused_with_what_can(self):
        self.refuse("packed", "reached", body='shape = "powder"\nmin = [0, 0, 0]\nmax = ["400 um", "400 um", "100 um"]\n'
                    'd10 = "40 um"\nd50 = "40 um"\nd90 = "40 um"\npacking = 0.73')

    def test_a_loss_names_the_key_that_the_material_lacks(self):
        for effect, key in (("evaporation", "boiling_point"), ("radiation", "emissivity")):
            lines = (SCENARIOS / "materials" / "in625.toml").read_text().splitlines(keepends=True)
            (self.folder / "bare.toml").write_text("".join(line for line in lines if not line.startswith(key)))
            self.refuse(key, '"bare"', physics=f"{effect} = true", material="bare", materials=self.folder)

    def test_homogenised_powder_names_the_key_that_the_material_lacks(self):
        self.refuse("conductivity.powder", "ss316l", body=self.BOX + '\nstate = "powder"', material="ss316l")

    LAYER = '[[layer]]\ntime = "{} us"\nthickness = "{} um"\nmaterial = "in625"\n'

    def test_layers_that_do_not_fit_are_refused_before_the_first_step(self):
        self.refuse("does not fit", extra=self.LAYER.format(20, 150) + 'state = "powder"\n')
        self.assertFalse((self.folder / "runs" / "bad" / "melt_pool.csv").exists())
        three = "".join(self.LAYER.format(time, 40) + 'state = "powder"\n' for time in (60, 20, 40))
        self.refuse("does not fit", "6e-05", extra=three)

    def test_check_lays_the_layers(self):
        self.write(extra=self.LAYER.format(20, 60) + 'd10 = "20 um"\nd50 = "25 um"\nd90 = "30 um"\npacking = 0.7\n')
        self.assertIn("packed", self.must_refuse("check", "bad.toml"))
        self.write(extra=self.LAYER.format(20, 60) + 'state = "powder"\n')
        self.assertIn("# layer      at t = 20.0 us: 9600 particles", self.check())

    def check(self):
        return self.must_succeed("check", self.folder / "bad.toml").stdout

    def test_check_says_what_is_not_run(self):
        self.write(path='path = [{move = ["100 um", "200 um", 0]}, {dwell = "5 ms"}]')
        self.assertIn("# note       laser \"laser\": its path ends at t = 0.005 s", self.check())

    def test_a_body_without_a_particle_is_refused(self):
        self.refuse("body[0] holds not one particle", body=self.BOX + '\n[[body]]\nmaterial = "in625"\n' + self.BOX)


if __name__ == "__main__":
    unittest.main()

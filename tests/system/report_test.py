"""The report: one page that needs nothing but itself and holds what the run folder does."""

import base64
import html.parser
import os
import shutil
import subprocess
import unittest

try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
except ImportError:
    CHROMIUM = None  # its picture could not be judged

from program import QUICK_LOOK, SMALL, ProgramTest

VOID = {"meta", "img", "line", "br", "link", "polyline"}


class Page(html.parser.HTMLParser):
    """Parses a page; its tags must be closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.texts = [], [], []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, (tag, self.open)
        self.open.pop()

    def handle_data(self, data):
        self.texts.append((self.open[-1] if self.open else "", data))

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]

    def text_of(self, tag):
        return "".join(data for name, data in self.texts if name == tag)


class Report(ProgramTest):
    def report(self, name):
        output = self.must_succeed("report", self.folder / name).stdout
        path = self.folder / name / "report.html"
        self.assertEqual(output.strip(), str(path))
        return Page(path.read_text(encoding="utf-8"))

    def must_stand_alone(self, page):
        self.assertFalse(page.all("script") + page.all("link") + page.all("iframe"))
        for tag, attributes in page.elements:
            for key in ("src", "href", "poster", "data", "srcset"):
                if key in attributes:
                    self.assertTrue(attributes[key].startswith("data:"), (tag, key))
        for word in ("url(", "@import", "http"):
            self.assertNotIn(word, page.text_of("style"))

    def test_page_holds_the_run_and_needs_nothing_else(self):
        self.run_small("run")
        run = self.folder / "run"
        movie, picture = b"movie\x00\xff", b"picture"
        (run / "overview.mp4").write_bytes(movie)
        (run / "frames").mkdir()
        (run / "frames" / "overview_000000.png").write_bytes(picture)
        (run / "journal.txt").write_text("at step 3 t=1e-05: power 90 <W> & more\n")
        page = self.report("run")
        self.must_stand_alone(page)
        [video] = page.all("video")
        self.assertEqual(video["src"], "data:video/mp4;base64," + base64.b64encode(movie).decode())
        self.assertEqual(video["poster"], "data:image/png;base64," + base64.b64encode(picture).decode())
        for title in ("Pool length", "Pool width", "Pool depth", "Pool volume", "Peak temperature", "Laser power"):
            self.assertIn(title, page.text_of("figcaption"))
        self.assertIn("cooling", page.text_of("figcaption"))
        self.assertIn((run / "run.toml").read_text(), page.text_of("pre"))
        self.assertIn("power 90 <W> & more", page.text_of("pre"))
        self.assertIn("absorbed", page.text_of("td"))
        [table] = [link["href"] for link in page.all("a")]
        self.assertEqual(base64.b64decode(table.split(",")[1]), (run / "melt_pool.csv").read_bytes())

    def test_plots_have_a_point_for_every_row(self):
        self.run_small("run")
        header, *rows = (self.folder / "run" / "melt_pool.csv").read_text().splitlines()
        isotherms = sum(name.startswith("length_m") for name in header.split(","))
        curves = self.report("run").all("polyline")
        self.assertEqual(len(curves), 4 * isotherms + 5)  # peak, its rate, power, energy absorbed and lost
        for curve in curves:
            self.assertEqual(len(curve["points"].split()), len(rows))

    def test_titles_cannot_break_the_page(self):
        self.run_small("run", "--set", 'title="<script>alert(1)</script> \\" & ü"')
        page = self.report("run")
        self.must_stand_alone(page)
        self.assertEqual(page.text_of("title"), '<script>alert(1)</script> " & ü')

    def test_missing_and_broken_parts_are_left_out(self):
        self.run_small("run")
        for name in ("run.toml", "run.json", "melt_pool.csv"):
            with self.subTest(missing=name):
                shutil.copytree(self.folder / "run", self.folder / ("without_" + name))
                (self.folder / ("without_" + name) / name).unlink()
                self.must_stand_alone(self.report("without_" + name))
        (self.folder / "run" / "run.json").write_text("{")
        result = self.must_succeed("report", self.folder / "run")
        self.assertIn("run.json", result.stderr)

    @unittest.skipUnless(CHROMIUM, "no Chromium")
    def test_a_browser_opens_the_page_from_the_disk_and_draws_it(self):
        movie = bool(shutil.which("ffmpeg") and (shutil.which("Xvfb") or os.environ.get("DISPLAY")))
        if movie:
            self.must_succeed("run", QUICK_LOOK, *SMALL, "--set", "render.size=[640,360]", "--output", self.folder / "run")
        else:
            self.run_small("run")
        self.report("run")
        page = self.folder / "run" / "report.html"
        picture = self.folder / "page.png"
        command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
                   "--disable-dev-shm-usage", f"--user-data-dir={self.folder / 'profile'}", "--hide-scrollbars",
                   "--virtual-time-budget=4000"]
        # The browser's own view of the page: what it parsed, and whether the movie can be played.
        probe = self.folder / "run" / "probe.html"
        probe.write_text(page.read_text(encoding="utf-8").replace("</body>", """<script>
            const movie = document.querySelector("video");
            const tell = () => { document.title = ["plots", document.querySelectorAll("svg polyline").length, "movie",
                movie ? movie.videoWidth + "x" + movie.videoHeight : "none"].join(" "); };
            if (movie) movie.addEventListener("loadedmetadata", tell);
            tell(); </script></body>"""), encoding="utf-8")
        dump = subprocess.run([*command, "--dump-dom", probe.as_uri()], capture_output=True, text=True, timeout=120)
        self.assertEqual(dump.returncode, 0, dump.stderr)
        title = dump.stdout.split("<title>")[1].split("</title>")[0]
        header = (self.folder / "run" / "melt_pool.csv").read_text().splitlines()[0]
        isotherms = sum(name.startswith("length_m") for name in header.split(","))
        self.assertIn(f"plots {4 * isotherms + 5} ", title)
        self.assertIn("movie 640x360" if movie else "movie none", title)
        shot = subprocess.run([*command, "--window-size=1200,2400", f"--screenshot={picture}", page.as_uri()],
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(shot.returncode, 0, shot.stderr)
        image = vtkPNGReader()
        image.SetFileName(str(picture))
        image.Update()
        width, height, _ = image.GetOutput().GetDimensions()
        self.assertEqual((width, height), (1200, 2400))
        pixels = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())[:, :3].reshape(height, width, 3)
        self.assertGreater(len(np.unique(pixels.reshape(-1, 3), axis=0)), 200)
        # Something is drawn in each sixth of the page's height.
        for part in np.array_split(pixels, 6):
            self.assertGreater(part.std(), 2.0)

    def test_a_folder_without_a_run_is_refused(self):
        (self.folder / "empty").mkdir()
        for name in ("empty", "absent"):
            self.assertIn("run folder", self.must_refuse("report", name).replace("folder of a run", "run folder"))
            self.assertFalse((self.folder / name / "report.html").exists())


if __name__ == "__main__":
    unittest.main()

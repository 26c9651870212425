"""Pictures made again from checkpoints and from saved files."""

import os
import shutil
import struct
import unittest

from program import QUICK_LOOK, SMALL, ProgramTest

SETTINGS = ["--set", "checkpoint.every=0.1 ms", "--set", "checkpoint.keep=9"]


@unittest.skipUnless(os.environ.get("DISPLAY") or shutil.which("Xvfb"), "neither a display nor Xvfb")
class Render(ProgramTest):
    def test_every_checkpoint_gives_a_picture_of_each_view_asked_for(self):
        self.run_small("run", *SETTINGS)
        count = len(list((self.folder / "run" / "checkpoints").iterdir()))
        self.assertGreater(count, 1)
        again = self.folder / "again"
        command = ["render", self.folder / "run", "--views", "top,section", "--size", "320", "180", "--output", again]
        self.must_succeed(*command)
        for view in ("top", "section"):
            pictures = sorted((again / "frames").glob(view + "_*.png"))
            self.assertEqual(len(pictures), count)
            self.assertEqual(struct.unpack(">2I", pictures[0].read_bytes()[16:24]), (320, 180))
            self.assertNotEqual(pictures[0].read_bytes(), pictures[-1].read_bytes())
            self.assertTrue((again / (view + ".mp4")).is_file())
        self.assertFalse((self.folder / "run" / "frames").exists())
        self.assertIn("--overwrite", self.must_refuse(*command))
        self.must_succeed(*command, "--overwrite", "--colormap", "viridis")
        self.assertEqual(len(list((again / "frames").iterdir())), 2 * count)


    def pictures(self, folder, view):
        return sorted((folder / "frames").glob(view + "_*.png"))

    def test_saved_grids_give_the_pictures_of_the_run_itself(self):
        self.must_succeed("run", QUICK_LOOK, *SMALL, "--set", "output.grid=true", "--set", "output.precision=float64", "--set",
                          'render.views=["overview","section","dashboard"]', "--set", "render.size=[320,180]", "--output",
                          self.folder / "run")
        again = self.folder / "again"
        self.must_succeed("render", self.folder / "run", "--output", again)
        for view in ("overview", "section", "dashboard"):
            first, second = self.pictures(self.folder / "run", view), self.pictures(again, view)
            self.assertEqual([path.name for path in first], [path.name for path in second])
            self.assertEqual(len(first), 8)
            for a, b in zip(first, second):
                self.assertEqual(a.read_bytes(), b.read_bytes(), a.name)
        self.must_succeed("render", self.folder / "run", "--output", again, "--overwrite", "--views", "pool", "--size", "640",
                          "360", "--color-range", "300", "1000", "--background", "light")
        self.assertEqual(len(self.pictures(again, "pool")), 8)

    def test_saved_surfaces_give_views_from_outside(self):
        self.run_small("run")
        again = self.folder / "again"
        self.must_succeed("render", self.folder / "run", "--views", "overview,top", "--size", "320", "180", "--output", again)
        for view in ("overview", "top"):
            pictures = self.pictures(again, view)
            self.assertEqual(len(pictures), 8)
            self.assertNotEqual(pictures[0].read_bytes(), pictures[-1].read_bytes())
        message = self.must_refuse("render", self.folder / "run", "--views", "section", "--output", again)
        self.assertIn("output.grid = true", message)
        self.assertIn("overview,top", message)


class Refusals(ProgramTest):
    def test_unknown_views_and_folders_without_checkpoints_are_refused(self):
        self.run_small("run", "--set", "output.surface=false")
        for source in ("auto", "checkpoints", "files"):
            self.assertIn("[checkpoint]", self.must_refuse("render", self.folder / "run", "--from", source))
        self.run_small("saved", *SETTINGS)
        self.assertIn("overview", self.must_refuse("render", self.folder / "saved", "--views", "overvew"))
        self.assertFalse((self.folder / "saved" / "frames").exists())


if __name__ == "__main__":
    unittest.main()

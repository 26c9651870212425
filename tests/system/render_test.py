"""Pictures made again from checkpoints."""

import os
import shutil
import struct
import unittest

from program import ProgramTest

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


class Refusals(ProgramTest):
    def test_unknown_views_and_folders_without_checkpoints_are_refused(self):
        self.run_small("run")
        self.assertIn("[checkpoint]", self.must_refuse("render", self.folder / "run"))
        self.run_small("saved", *SETTINGS)
        self.assertIn("overview", self.must_refuse("render", self.folder / "saved", "--views", "overvew"))
        self.assertFalse((self.folder / "saved" / "frames").exists())


if __name__ == "__main__":
    unittest.main()

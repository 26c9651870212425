"""Whatever befalls pictures and files, the run is told so clearly and its results are the same bits."""

import os
import shutil
import signal
import subprocess
import time
import unittest

from program import PATIENCE, PROGRAM, QUICK_LOOK, SMALL, ProgramTest, checkpoints, stop_for_a_while

# Two hundred steps and more, so that something can happen meanwhile; the end is the only checkpoint.
RUN = [*SMALL, "--set", "time.max_step=1 us", "--set", "checkpoint.every=1 s", "--set", "render.size=[320,180]"]


def environment(**changes):
    """That of this process with changes; None takes a variable away."""
    result = dict(os.environ)
    for name, value in changes.items():
        result.pop(name, None)
        if value is not None:
            result[name] = str(value)
    return result


class Faults(ProgramTest):
    def setUp(self):
        super().setUp()
        self.must_succeed("run", QUICK_LOOK, *RUN, "--no-render", "--output", self.folder / "sound")

    def run_with(self, name, *arguments, before=(), **options):
        words = [*before, PROGRAM, "run", QUICK_LOOK, *RUN, "--output", self.folder / name, *arguments]
        result = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=PATIENCE,
                                stdin=subprocess.DEVNULL, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stderr

    def must_be_unharmed(self, name, *tables):
        sound, faulty = (checkpoints(self.folder / run)[-1] for run in ("sound", name))
        self.assertEqual(sound.name, faulty.name)
        self.assertEqual(sound.read_bytes(), faulty.read_bytes())
        for table in tables:
            self.assertEqual((self.folder / "sound" / table).read_bytes(), (self.folder / name / table).read_bytes())

    def test_no_display_and_no_xvfb(self):
        errors = self.run_with("run", env=environment(DISPLAY=None, PATH="/nonexistent"))
        self.assertEqual(errors.count("Xvfb"), 1, errors)
        self.assertIn("install the package xvfb", errors)
        self.must_be_unharmed("run", "melt_pool.csv", "melt_pools.csv", "surface.pvd", "pool.pvd", "particles.pvd")

    def test_a_backend_that_is_not_there(self):
        for backend, word in (("x11", "DISPLAY"), ("egl", "9.4"), ("osmesa", "9.4")):
            with self.subTest(backend=backend):
                errors = self.run_with(backend, "--render-backend", backend, env=environment(DISPLAY=None))
                if backend == "x11" or errors:  # a later VTK may have the others
                    self.assertIn(word, errors)
                self.must_be_unharmed(backend, "melt_pool.csv", "surface.pvd")

    @unittest.skipUnless(shutil.which("Xvfb"), "no Xvfb")
    def test_no_ffmpeg(self):
        (self.folder / "bin").mkdir()
        (self.folder / "bin" / "Xvfb").symlink_to(shutil.which("Xvfb"))
        errors = self.run_with("run", env=environment(DISPLAY=None, PATH=self.folder / "bin"))
        self.assertIn("no movie of overview", errors)
        self.assertIn("ffmpeg", errors)
        self.assertEqual(len(list((self.folder / "run" / "frames").glob("overview_*.png"))), 8)
        self.must_be_unharmed("run", "melt_pool.csv", "surface.pvd")

    def test_no_space_left_for_pictures_and_files(self):
        """In a mount name space of its own, where these folders are disks of 40 kB."""
        if subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "true"], capture_output=True).returncode:
            self.skipTest("no name spaces to mount a small disk in")
        small = 'for folder in frames surface; do mkdir -p "$RUN/$folder" && ' \
                'mount -t tmpfs -o size=40k small "$RUN/$folder" && echo mine > "$RUN/$folder/notes" || exit 77; ' \
                'done; exec "$@"'
        errors = self.run_with("run", "--overwrite", env=environment(RUN=self.folder / "run"),
                               before=["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", small, "sh"])
        self.assertIn("data files: cannot write", errors)
        if shutil.which("Xvfb"):
            self.assertIn("pictures: cannot write", errors)
        self.assertIn("No space left on device", errors)
        self.assertIn("the run goes on without", errors)
        self.must_be_unharmed("run", "melt_pool.csv")

    def test_output_folder_removed_while_running(self):
        folder = self.folder / "run"
        process = subprocess.Popen([PROGRAM, "run", str(QUICK_LOOK), *RUN, "--no-render", "--repl", "--output", str(folder)],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        process.stdin.write("step 100\nstatus\n")
        process.stdin.flush()
        for line in process.stdout:
            if "at step 100" in line:
                break
        deadline = time.monotonic() + PATIENCE
        while not (folder / "surface.pvd").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        stop_for_a_while(process)  # more files may be on their way
        shutil.rmtree(folder)
        process.send_signal(signal.SIGCONT)
        process.stdin.write("run\n")
        errors = process.communicate(timeout=PATIENCE)[1]
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn("was removed during the run", errors)
        self.must_be_unharmed("run")
        # What is there now is whole: every file that is named exists, and the table has its header.
        for collection in folder.glob("*.pvd"):
            for line in collection.read_text().splitlines():
                if "file=" in line:
                    self.assertTrue((folder / line.split('file="')[1].split('"')[0]).exists(), line)
        self.assertEqual((folder / "melt_pool.csv").read_text().split(",")[0], "time_s")
        self.must_succeed("report", folder)

    def test_a_view_that_does_not_exist_is_refused_before_anything_is_made(self):
        message = self.must_refuse("run", QUICK_LOOK, *RUN, "--set", 'render.views=["overveiw"]', "--output",
                                   self.folder / "run")
        self.assertIn("overview", message)
        self.assertIn("render.views", message)
        self.assertFalse((self.folder / "run").exists())
        self.assertIn("xvfb", self.must_refuse("run", QUICK_LOOK, *RUN, "--render-backend", "xfvb", "--output",
                                               self.folder / "run"))
        self.assertFalse((self.folder / "run").exists())


if __name__ == "__main__":
    unittest.main()

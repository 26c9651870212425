"""Whatever a scenario, a journal or a checkpoint says: nothing is written outside the run folder."""

import hashlib
import unittest

from program import QUICK_LOOK, ProgramTest, meltscope

MATERIAL = (QUICK_LOOK.parent / "materials" / "in625.toml").read_text()


def scenario(title="t", material="metal", laser="red", view="overview"):
    text = "\n".join(line for line in MATERIAL.splitlines() if not line.startswith("#"))
    return f'''title = "{title}"
[domain]
min = [0, 0, 0]
max = [4e-4, 2e-4, 1e-4]
cell_size = 2e-5
particles_per_cell = 1
[[body]]
shape = "box"
material = "{material}"
min = [0, 0, 0]
max = [4e-4, 2e-4, 1e-4]
[[laser]]
name = "{laser}"
power = 50
absorptivity = 0.4
spot_radius = 4e-5
path = [{{move = [1e-4, 1e-4, 1e-4]}}, {{to = [3e-4, 1e-4, 1e-4], speed = 1.0}}]
[time]
end = 4e-5
[output]
every = 1e-5
particles = "all"
solidification = true
[render]
views = ["{view}"]
[checkpoint]
every = 2e-5
[material."{material}"]
{text}
'''


class Outside(ProgramTest):
    def setUp(self):
        super().setUp()
        self.work = self.folder / "a" / "b" / "work"
        self.work.mkdir(parents=True)

    def everything(self):
        """Name and contents of every file but those of the run."""
        return {path: hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None
                for path in self.folder.rglob("*") if "runs" not in path.parts}

    def run_in_work(self, *arguments):
        before = self.everything()
        result = meltscope(*arguments, "--no-render", cwd=self.work)
        self.assertEqual(self.everything(), before, result.stderr)
        return result

    def run_text(self, text):
        (self.work / "hostile.toml").write_text(text)
        return self.run_in_work("run", "hostile.toml")

    def test_titles_and_names_of_materials_lead_nowhere(self):
        for name in ("../../../x", "/tmp/meltscope_outside", "a/b", "..", "x.h5"):
            result = self.run_text(scenario(title=name, material=name))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertTrue((self.work / "runs" / "hostile" / "run.json").exists())
            for path in sorted((self.work / "runs").rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()

    def test_names_that_become_parts_of_file_names_are_refused_with_slashes(self):
        for words in ({"laser": "../../x"}, {"laser": "a/b"}, {"view": "../../x"}, {"view": "/tmp/x"}):
            result = self.run_text(scenario(**words))
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertFalse((self.work / "runs").exists())

    def test_a_scenario_called_like_a_folder_above_needs_an_output_folder(self):
        (self.work / "...toml").write_text(scenario())
        result = meltscope("run", "...toml", "--no-render", cwd=self.work)
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("--output", result.stderr)
        self.assertEqual([path.name for path in self.work.iterdir()], ["...toml"])

    def test_journals_write_no_files(self):
        (self.work / "good.toml").write_text(scenario())
        for command in ("save ../x.h5", "at 0 s save ../x.h5", "record ../x.txt", "snapshot ../x.png"):
            (self.work / "journal.txt").write_text(f"at step 0 t=0: {command}\n")
            result = self.run_in_work("run", "good.toml", "--replay", "journal.txt", "--overwrite")
            self.assertNotEqual(result.returncode, 0, command)
            self.assertIn("journal.txt:1", result.stderr)

    def test_a_script_writes_where_it_says(self):
        (self.work / "good.toml").write_text(scenario())
        (self.work / "script.txt").write_text("save ../x.h5\n")
        result = meltscope("run", "good.toml", "--script", "script.txt", "--no-render", cwd=self.work)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.work.parent / "x.h5").exists())


if __name__ == "__main__":
    unittest.main()

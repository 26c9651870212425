"""What the program says to right and wrong usage, and its exit codes."""

import json
import os
import re
import resource
import tomllib
import unittest

from program import QUICK_LOOK, SMALL, ProgramTest, meltscope

COMMANDS = ["run", "check", "bench", "info", "movie"]


class Help(ProgramTest):
    def test_version_names_compiler_width_and_libraries(self):
        text = self.must_succeed("--version").stdout
        for word in ("meltscope", "SIMD width", "VTK 9", "HDF5 1"):
            self.assertIn(word, text)
        self.assertRegex(text, "GNU|Clang")

    def test_help_of_every_command_has_an_example(self):
        self.assertIn("Exit codes", self.must_succeed("--help").stdout)
        for command in COMMANDS:
            self.assertIn(f"meltscope {command} ", self.must_succeed(command, "--help").stdout, command)


class Refusals(ProgramTest):
    def refuse_scenario(self, text, *words):
        (self.folder / "bad.toml").write_text(text)
        message = self.must_refuse("check", "bad.toml")
        for word in ("bad.toml:", *words):
            self.assertIn(word, message)

    def test_unknown_option_and_command_are_answered_with_the_nearest(self):
        self.assertIn("did you mean --output", self.must_refuse("run", QUICK_LOOK, "--ouput", "x"))
        self.assertIn("did you mean check", self.must_refuse("chekc", QUICK_LOOK))

    def test_no_command_is_refused(self):
        self.must_refuse()

    def test_missing_scenario_is_named(self):
        self.assertIn("nowhere.toml", self.must_refuse("run", "nowhere.toml"))

    def test_unknown_key_is_placed_and_the_nearest_named(self):
        text = QUICK_LOOK.read_text().replace('"materials/', f'"{QUICK_LOOK.parent}/materials/')
        self.refuse_scenario(text.replace("cell_size", "cel_size"), "cel_size", "cell_size")

    def test_wrong_unit_is_refused(self):
        self.assertIn("power", self.must_refuse("check", QUICK_LOOK, "--set", "laser.power=200 um"))

    def test_text_that_is_no_toml_is_refused(self):
        self.refuse_scenario("\x00\x01 [[[", "1:")
        self.refuse_scenario("")

    def test_unknown_override_is_refused(self):
        self.assertIn('"power"', self.must_refuse("run", QUICK_LOOK, "--set", "laser.powr=200 W"))

    def test_more_memory_than_there_is_is_refused(self):
        message = self.must_refuse("run", QUICK_LOOK, "--set", "domain.cell_size=50 nm")
        self.assertIn("memory", message)
        self.assertFalse((self.folder / "runs").exists())

    def test_400_million_particles_are_refused_with_an_estimate_before_memory_is_taken(self):
        if os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") > 50e9:
            self.skipTest("this machine can hold them")
        if "ASAN_OPTIONS" in os.environ or "TSAN_OPTIONS" in os.environ:
            self.skipTest("the sanitizers reserve more than any limit for themselves")
        gigabytes = 4  # what the arrays need would break this limit, and the program would end otherwise
        refused = meltscope("bench", "--scene", "block", "--particles", "400000000", preexec_fn=lambda:
                            resource.setrlimit(resource.RLIMIT_AS, (gigabytes << 30, gigabytes << 30)))
        self.assertEqual(refused.returncode, 2, refused.stderr)
        particles = re.search(r"up to (\d+) particles", refused.stderr)
        self.assertAlmostEqual(int(particles[1]) / 4e8, 1.0, delta=0.05)
        for word in ("GB", "domain.cell_size", "domain.particles_per_cell"):
            self.assertIn(word, refused.stderr)

    def test_times_and_limits_without_sense_are_refused(self):
        self.assertIn("--until", self.must_refuse("run", QUICK_LOOK, "--until", "soon"))
        self.assertIn("HH:MM:SS", self.must_refuse("run", QUICK_LOOK, "--wall-limit", "1h"))
        self.assertIn("--steps", self.must_refuse("run", QUICK_LOOK, "--steps", "0"))
        self.assertIn("xvfb", self.must_refuse("run", QUICK_LOOK, "--render-backend", "paper"))

    def test_foreign_files_are_no_checkpoints_and_no_runs(self):
        (self.folder / "rubbish.h5").write_bytes(b"\x89HDF" + bytes(1000))
        self.assertIn("rubbish.h5", self.must_refuse("info", "rubbish.h5"))
        self.assertIn("rubbish.h5", self.must_refuse("run", "--restart", "rubbish.h5"))
        self.must_refuse("info", "missing.h5")
        self.must_refuse("info", ".")
        self.must_refuse("movie", ".")


class Check(ProgramTest):
    def test_prints_a_scenario_that_can_be_run_and_what_it_needs(self):
        text = self.must_succeed("check", QUICK_LOOK, *SMALL).stdout
        resolved = tomllib.loads(text)
        self.assertEqual(resolved["domain"]["cell_size"], 4e-5)
        self.assertEqual(resolved["time"]["cfl"], 0.5)
        for word in ("# particles  10000", "# nodes", "# memory", "# dt", "# steps", "# time"):
            self.assertIn(word, text)
        (self.folder / "resolved.toml").write_text(text)
        again = self.must_succeed("check", self.folder / "resolved.toml").stdout
        self.assertEqual([line for line in again.splitlines() if not line.startswith("#")],
                         [line for line in text.splitlines() if not line.startswith("#")])


class Bench(ProgramTest):
    def test_json_has_the_speed_the_probes_and_the_phases(self):
        figures = json.loads(self.must_succeed("bench", "--particles", "20000", "--scene", "block", "--json").stdout)
        for key in ("particle_steps_per_s", "fma_gflops", "triad_gb_per_s"):
            self.assertGreater(figures[key], 0.0, key)
        self.assertEqual(figures["threads"], 1)
        self.assertGreater(figures["particles"], 10000)
        self.assertLessEqual({"favre", "diffuse", "laser", "losses", "update", "g2p"}, set(figures["seconds"]))
        [block] = figures["scenes"]
        self.assertEqual([form["transfer"] for form in block["forms"]], ["affine", "flip"])
        self.assertGreater(block["memory"]["held_bytes_a_particle"], 50.0)
        self.assertGreater(block["setup"]["nodes_in_band"], 0)

    def test_a_scenario_can_be_measured(self):
        figures = json.loads(self.must_succeed("bench", "--scene", QUICK_LOOK, "--transfer", "flip", "--json",
                                               "--set", "domain.cell_size=40 um").stdout)
        [scene] = figures["scenes"]
        self.assertEqual([form["transfer"] for form in scene["forms"]], ["flip"])
        self.assertEqual(figures["particles"], 10000)


if __name__ == "__main__":
    unittest.main()

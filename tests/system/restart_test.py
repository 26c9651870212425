"""A run that was interrupted, or that has another number of threads, gives the same bits."""

import os
import unittest

from program import QUICK_LOOK, SMALL, ProgramTest, checkpoints

AT_END = ["--set", "checkpoint.every=1 s"]  # the end is the first checkpoint


def results(run):
    """All data files of a run but those that tell of the machine and of wall time."""
    told = ("run.json", "log.txt", "run.lock")
    return {path.relative_to(run): path.read_bytes() for path in sorted(run.rglob("*"))
            if path.is_file() and path.name not in told and path.parent.name != "checkpoints"}


class Restart(ProgramTest):
    def assert_same(self, first, second):
        a, b = results(first), results(second)
        self.assertEqual(list(a), list(b))
        for name in a:
            self.assertEqual(a[name], b[name], name)
        self.assertEqual(checkpoints(first)[-1].name, checkpoints(second)[-1].name)
        self.assertEqual(checkpoints(first)[-1].read_bytes(), checkpoints(second)[-1].read_bytes())

    def interrupted(self, name, steps):
        """The small run, stopped after so many steps and taken up again in the same folder."""
        self.run_small(name, *AT_END, "--steps", steps)
        checkpoint = self.folder / name / "checkpoints" / f"step_{steps:09d}.h5"
        self.must_succeed("run", "--restart", checkpoint, "--no-render")

    def test_a_restarted_run_equals_the_uninterrupted_one_bit_for_bit(self):
        self.run_small("whole", *AT_END)
        for steps in (1, 17, 20, 50):  # before the first output, between outputs, on one
            with self.subTest(steps=steps):
                self.interrupted(f"after_{steps}", steps)
                self.assert_same(self.folder / "whole", self.folder / f"after_{steps}")

    def test_two_restarts_equal_none_also_with_another_number_of_threads(self):
        self.run_small("whole", *AT_END)
        self.run_small("twice", *AT_END, "--steps", 9)
        self.must_succeed("run", "--restart", checkpoints(self.folder / "twice")[-1], "--no-render", "--steps", 20,
                          "--threads", 2)
        self.must_succeed("run", "--restart", checkpoints(self.folder / "twice")[-1], "--no-render")
        self.assert_same(self.folder / "whole", self.folder / "twice")

    def test_restart_at_an_output_makes_that_output_once(self):
        self.run_small("whole", *AT_END)
        self.run_small("cut", *AT_END, "--until", "0.12 ms")
        self.must_succeed("run", "--restart", checkpoints(self.folder / "cut")[-1], "--no-render")
        self.assert_same(self.folder / "whole", self.folder / "cut")

    def test_an_interval_that_ends_between_outputs_keeps_their_instants(self):
        self.run_small("whole", *AT_END)
        self.run_small("cut", *AT_END, "--until", "0.1 ms")  # no instant of the schedule: the steps differ from there on
        self.must_succeed("run", "--restart", checkpoints(self.folder / "cut")[-1], "--no-render")
        whole, cut = ((self.folder / name / "melt_pool.csv").read_text().splitlines() for name in ("whole", "cut"))
        self.assertEqual([row.split(",")[0] for row in whole], [row.split(",")[0] for row in cut])

    def test_the_number_of_threads_changes_no_bit(self):
        self.run_small("one", *AT_END, "--threads", 1)
        self.run_small("two", *AT_END, "--threads", 2)
        self.assert_same(self.folder / "one", self.folder / "two")

    def test_a_restart_takes_up_changed_values_and_keeps_the_others(self):
        self.run_small("run", *AT_END, "--steps", 10)
        start = checkpoints(self.folder / "run")[-1]
        self.must_succeed("run", "--restart", start, "--no-render", "--output", self.folder / "hot", "--set",
                          "laser.power=250 W", "--set", "time.end=0.2 ms")
        self.must_succeed("run", "--restart", start, "--no-render", "--output", self.folder / "same", "--set",
                          "time.end=0.2 ms")
        last = [(self.folder / name / "melt_pool.csv").read_text().splitlines()[-1].split(",")
                for name in ("hot", "same")]
        self.assertEqual([float(row[0]) for row in last], [2e-4, 2e-4])
        self.assertEqual([float(row[3]) for row in last], [250.0, 179.2])

    def test_another_grid_is_refused(self):
        self.run_small("run", *AT_END, "--steps", 2)
        start = checkpoints(self.folder / "run")[-1]
        message = self.must_refuse("run", "--restart", start, "--set", "domain.cell_size=20 um", "--output", "other")
        self.assertIn("domain", message)

    def test_a_damaged_checkpoint_is_refused(self):
        self.run_small("run", *AT_END, "--steps", 2)
        start = checkpoints(self.folder / "run")[-1]
        data = bytearray(start.read_bytes())
        data[len(data) // 2] ^= 1
        start.write_bytes(data)
        self.assertIn(os.path.basename(start), self.must_refuse("run", "--restart", start))


if __name__ == "__main__":
    unittest.main()

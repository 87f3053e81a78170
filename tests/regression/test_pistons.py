#!/usr/bin/python3
"""Rigid slabs that go along their axis, as pistons: what they push, the same bits, and what is refused."""
import pathlib
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import BINARY, SceneCase  # noqa: E402

OPEN = "-boundary_xmin pressure -boundary_xmax pressure -boundary_y wall"
PISTON = ("-species piston -piston_shape slab -piston_axis x -piston_law rigid -piston_interval .8,1.1 -grid_cells 60,20,1 "
          "-grid_length 3,1,1 -fluid_viscosity 2")


class Pistons(SceneCase):
    def test_pushes_and_draws_a_channel(self):
        """Away from its ends the flow is Poiseuille's with the piston's velocity as mean, whatever is behind the sides; its force
        is that of both columns of fluid and of what is at its ends, some channel heights' worth."""
        V, mu = .2, 2
        for solver in ("acm", "smac"):
            run = self.run_program(solver, *PISTON.split(), *OPEN.split(), "-piston_velocity", f"{V},0,0", "-time_end", "1",
                                   "-snapshot_interval", "1", "-snapshot_precision", "double", "-pressure_solver", solver)
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                u, p = file["velocity_x"][0], file["pressure"][0]
            y = (numpy.arange(20) + .5) / 20
            self.assertLess(abs(u[:, 50] / V - 6 * y * (1 - y)).max(), .01)
            self.assertAlmostEqual((p[10, 45] - p[10, 55]) / (10 / 20 * 12 * mu * V), 1, delta=.01)
            for name, sign in (("flow_rate_xmin", 1), ("flow_rate_xmax", -1)):
                self.assertLess(abs(numpy.array(run.series[name])[1:] - sign * V).max(), 1e-5 * V)
            self.assertAlmostEqual(run.bodies.centroid[-1, 0, 0], .95 + V, delta=1e-9)
            column = -12 * mu * V * (3 - .3)
            force = run.bodies.force[-1, 0]
            print(f"    {force[0] / column:.3f}")
            self.assertTrue(1 < force[0] / column < 1.6, force[0] / column)
            self.assertLess(abs(force[1]), 1e-3 * abs(force[0]))

    def test_force_does_not_lag(self):
        """The force on a piston that swings in a viscous fluid, at automatic steps, against that at short ones: with a pressure
        that is some steps late it was .12 of its amplitude off."""
        forces = []
        for name, step in ("automatic", "0"), ("short", ".004"):
            run = self.run_program(name, *PISTON.split(), *OPEN.split(), *("-piston_velocity .5,0,0 -piston_velocity_angular_frequency 4 "
                                   "-series_interval 1e-12 -time_end 1.6 -time_step").split(), step)
            time = numpy.array(run.series.time)
            forces.append(((time[1:] + time[:-1]) / 2, run.bodies.force[1:, 0, 0]))
            self.assertLess(run.summary["energy_made_share"], .02, name)
        late = forces[0][0] > .2
        off = (forces[0][1] - numpy.interp(*[forces[0][0], *forces[1]]))[late]
        share = numpy.sqrt((off**2).mean()) / abs(forces[1][1][forces[1][0] > .2]).max()
        print(f"    force {share:.3f} of its amplitude off in {len(forces[0][0])} steps")
        self.assertLess(share, .06)

    def test_in_a_tube(self):
        """It displaces the fluid of the lumen, whose section is that of the stair of faces."""
        V, radius, cells = .3, .4, 24
        run = self.run_program("syringe", *f"-grid_cells 40,{cells},{cells} -grid_length 1.6666666666666667,1,1 -boundary_y wall "
                               "-boundary_z wall -fluid_viscosity .5 -species tube,piston -tube_shape tube -tube_axis x -tube_radius "
                               f"{radius} -tube_law rigid -piston_shape slab -piston_axis x -piston_interval .5,.8 -piston_law rigid "
                               f"-piston_velocity {V},0,0 -time_end .4 -series_interval .1".split(), *OPEN.split()[:4])
        at = (numpy.arange(cells) + .5) / cells - .5
        section = (at[:, None] ** 2 + at ** 2 < radius ** 2).sum() / cells ** 2
        for name, sign in (("flow_rate_xmin", 1), ("flow_rate_xmax", -1)):
            self.assertLess(abs(numpy.array(run.series[name])[1:] - sign * V * section).max(), 1e-5 * V)
        self.assertAlmostEqual(section / (numpy.pi * radius ** 2), 1, delta=.03)

    def test_same_bits_and_mirrored(self):
        across = "-boundary_y wall -piston_velocity 1.5,0,0 -piston_velocity_angular_frequency .7 -time_end .6"  # back over the side
        swinging = f"{OPEN} -piston_velocity .5,0,0 -piston_velocity_angular_frequency 4 -time_end .6"
        deep = "-boundary_ymin pressure -boundary_ymax wall -boundary_x wall -boundary_z wall -grid_cells 24,16,12 -piston_velocity .5,0,0 -time_end .2"
        for name, scene in (("across", across), ("swinging", swinging), ("deep", deep)):
            options = [*PISTON.split(), *scene.split()]
            if name == "deep":
                at = options.index("-grid_cells")
                del options[at:at + 2]
            runs = self.run_together({f"{name}{ranks}": (options, {"ranks": ranks}) for ranks in (1, 2, 3)} |
                                     {f"{name}_half": ([*options, "-time_steps_max", "8", "-checkpoint_interval", "1"], {})})
            hashes = {runs[f"{name}{ranks}"].summary["state_hash"] for ranks in (1, 2, 3)}
            hashes.add(self.run_program(f"{name}_rest", *options, "-restart", self.room / f"{name}_half",
                                        ranks=2).summary["state_hash"])
            self.assertEqual(len(hashes), 1, name)
        fields = []
        for interval, V in ((".8,1.1", ".5"), ("1.9,2.2", "-.5")):  # surfaces on faces, too
            options = PISTON.replace(".8,1.1", interval).split()
            run = self.run_program(f"mirror{V}", *options, *OPEN.split(), "-piston_velocity", f"{V},0,0", "-time_end", ".3",
                                   "-snapshot_interval", ".3", "-snapshot_precision", "double", "-pressure_solver", "smac")
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                fields.append([file[name][0] for name in ("velocity_x", "velocity_y")])
        scale = abs(fields[0][0]).max()
        self.assertLess(abs(fields[0][0][:, 1:] + fields[1][0][:, :0:-1]).max(), 1e-6 * scale)
        self.assertLess(abs(fields[0][1] - fields[1][1][:, ::-1]).max(), 1e-6 * scale)

    def test_refused(self):
        other = " -species piston,plug -plug_shape slab -plug_axis x -plug_law rigid -plug_interval 2,2.2"
        for options, says in ((PISTON + " -boundary_x wall -boundary_y wall", "cannot leave"),
                              (PISTON + " -boundary_xmin inflow -boundary_xmin_velocity 1 -boundary_xmax pressure", "cannot leave"),
                              (PISTON.replace("-species piston", "") + other + " -boundary_y wall", "cannot leave"),
                              (PISTON.replace(".8,1.1", "-1,1") + " " + OPEN, "two cells from the boundaries")):
            done = subprocess.run([BINARY, *options.split(), "-piston_velocity", "1,0,0", "-time_end", ".1", "-output_dir",
                                   self.room / "refused"], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("-piston_velocity: ", done.stderr)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()

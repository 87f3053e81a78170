#!/usr/bin/python3
"""Loads of rigid bodies: the momentum that the fluid lacks in every step of a start-up at automatic steps, and what drives the
fluid as soon as the flow is steady; the pressure in cells that the surface cuts; the same of bodies that travel and turn, and the
energy that these give the fluid."""
import math
import pathlib
import sys
import typing
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import SceneCase  # noqa: E402

DRIVEN = "-species part -part_law rigid -body_force 1,0,0"
EVERY_STEP = "-series_interval 1e-12"
FINER = 16  # points of tilted walls per cell


class Scene(typing.NamedTuple):
    options: str
    end: float  # when the flow is steady, also with a viscosity of 1
    fluid: float  # its volume
    torque: float = math.inf  # at most, in parts of the force


def tilted_walls(cells):
    """Solid fraction of walls along (2, 1), half of a box of 2 x 1."""
    n = cells * FINER
    across = ((numpy.arange(n)[:, None] + .5) / n - (numpy.arange(2 * n) + .5) / (2 * n) + .137) % 1
    return (across < .5).reshape(cells, FINER, 2 * cells, FINER).mean(axis=(1, 3))


class Journey(typing.NamedTuple):
    """A scene in which one body, of the species part, travels with velocity cos(frequency t + phase)."""
    options: str
    volume: float  # of the body
    fluid: float  # volume of it
    velocity: typing.Tuple[float, float, float]
    frequency: float = 0
    phase: float = 0

    def all_options(self, viscosity, end, solver="acm"):
        words = {"velocity": ",".join(map(str, self.velocity)), "velocity_angular_frequency": self.frequency, "velocity_phase": self.phase}
        motion = " ".join(f"-part_{name} {value}" for name, value in words.items() if self.velocity != (0, 0, 0))
        return (f"-species part {self.options} -part_law rigid {motion} {EVERY_STEP} -fluid_viscosity {viscosity} -time_end {end} "
                f"-pressure_solver {solver}").split()

    def momentum(self, time):
        return self.volume * numpy.outer(numpy.cos(self.frequency * time + self.phase), self.velocity)


FLAT = "-grid_cells 32,32,1 "
CYLINDER = FLAT + "-part_shape cylinder -part_axis z -part_radius .25 -part_centre .33,.48,.5"
ELLIPSE = FLAT + "-part_shape ellipsoid -part_semi_axes .3,.15,.15 -part_centre .33,.48,.5"
FROM_REST = -math.pi / 2
JOURNEYS = {
    "cylinder": Journey(CYLINDER, math.pi / 16, 1 - math.pi / 16, (.5, .2, 0), 6, FROM_REST),
    "ellipse that turns": Journey(ELLIPSE + " -part_angular_velocity 0,0,2 -part_angular_velocity_angular_frequency 4",
                                  math.pi * .045, 1 - math.pi * .045, (0, 0, 0)),
    "ellipse that swings and turns": Journey(ELLIPSE + " -part_angular_velocity 0,0,1.5 -part_angular_velocity_angular_frequency 3", math.pi * .045, 1 - math.pi * .045,
                                             (.3, -.4, 0), 5, FROM_REST),
    "sphere": Journey("-grid_cells 14,14,14 -part_shape sphere -part_radius .3 -part_centre .52,.47,.51", .036 * math.pi,
                      1 - .036 * math.pi, (.4, -.2, .3), 6, FROM_REST),
}


class RigidLoads(SceneCase):
    def tilted(self):
        solid = tilted_walls(24)
        with h5py.File(self.room / "tilted.h5", "w") as file:
            file["solid"] = solid[None]
        return Scene(f"-grid_cells 48,24,1 -grid_length 2,1,1 -part_shape voxels -part_voxels {self.room}/tilted.h5:solid", .3,
                     2 * (1 - solid.mean()))

    @staticmethod
    def tube(y, z):
        return Scene("-grid_cells 4,16,16 -grid_length .25,1,1 -part_shape tube -part_axis x -part_radius .385 -part_centre "
                     f"0,{y},{z}", .5, math.pi * .385**2 / 4, 1e-3)

    @staticmethod
    def spheres(part):
        return Scene(f"-grid_cells 12,12,12 -part_shape sphere -part_radius {(.75 * part / math.pi)**(1 / 3)} -part_centre "
                     ".52,.47,.51", .2, 1 - part, math.inf if part > .5 else .01)  # above .5 they touch

    cylinder = Scene("-grid_cells 32,32,1 -part_shape cylinder -part_axis z -part_radius .25 -part_centre .33,.98,.5", 1,
                     1 - math.pi / 16, 1e-3)

    def test_momentum_in_every_step(self):
        """The force is what drives the fluid less what its momentum gains, and all that drives it as soon as the flow is steady."""
        scenes = {"tilted channel": self.tilted(), "tube": self.tube(.513, .487), "tube elsewhere": self.tube(.55, .54),
                  "cylinder": self.cylinder, **{f"spheres {part}": self.spheres(part) for part in (.343, .45, .5236)}}
        runs = {}
        for name, scene in scenes.items():
            options = f"{scene.options} {DRIVEN} {EVERY_STEP} -time_end {scene.end}".split()
            runs[name, "viscous"] = options + ["-fluid_viscosity", "20"]
            if name in ("tilted channel", "cylinder"):
                runs[name, "with inertia"] = options
                runs[name, "smac"] = runs[name, "viscous"] + ["-pressure_solver", "smac"]
        plan = {" ".join(name): (options, {}) for name, options in runs.items()}
        results = self.run_together(plan)
        for name, how in runs:
            run, scene = results[f"{name} {how}"], scenes[name]
            time = numpy.array(run.series.time)
            speed = numpy.array([run.series[f"bulk_velocity_{axis}"] for axis in "xyz"]).T
            gains = numpy.prod(run.length) * numpy.diff(speed, axis=0) / numpy.diff(time)[:, None]
            force, torque = (loads.sum(axis=1)[1:] / scene.fluid for loads in (run.bodies.force, run.bodies.torque))
            balance = abs(force + gains / scene.fluid - [1, 0, 0]).max()
            first = numpy.nonzero(abs(speed[1:, 0] / speed[-1, 0] - 1) > .005)[0][-1] + 1
            off, twist = abs(force[first:] - [1, 0, 0]).max(), abs(torque[first:]).max()
            print(f"    {name}, {how}: {len(time) - 1} steps, balance off {balance:.1e}; from {first + 1} on force off {off:.1e}, torque {twist:.1e}")
            self.assertLess(balance, .01, name)
            self.assertLess(first, len(force) - 1, name)
            self.assertLess(off, .01, name)
            self.assertLess(twist, scene.torque, name)

    def test_momentum_where_bodies_travel(self):
        """The same in a start-up in which a body travels or turns, whose own momentum is not the fluid's."""
        plan, made = {}, {}
        for name, journey in JOURNEYS.items():
            for solver in "acm", "smac":
                for how, viscosity, end in ("viscous", 20, .4), ("with inertia", 1, .4):
                    options = [*journey.all_options(viscosity, end, solver), "-body_force", "1,0,0"]
                    plan[f"{name}, {solver}, {how}"], made[f"{name}, {solver}, {how}"] = (options, {}), journey
        for name, run in self.run_together(plan).items():
            journey, time = made[name], numpy.array(run.series.time)
            momentum = numpy.array([run.series[f"bulk_velocity_{axis}"] for axis in "xyz"]).T * numpy.prod(run.length)
            gains = numpy.diff(momentum - journey.momentum(time), axis=0) / numpy.diff(time)[:, None]
            force = run.bodies.force.sum(axis=1)[1:]
            off = abs(force + gains - [journey.fluid, 0, 0]).max() / journey.fluid
            print(f"    {name}: {len(time) - 1} steps, balance off {off:.1e}, force at most {abs(force).max():.3g}")
            self.assertGreater(len(time), 22, name)
            self.assertLess(off, .01, name)

    def test_energy_where_bodies_travel(self):
        """What they supply is what viscosity dissipates and the flow stores, within what a verdict calls fine."""
        piston = ("-boundary_xmin pressure -boundary_xmax pressure -boundary_y wall -grid_cells 60,20,1 -grid_length 3,1,1 -part_shape slab "
                  "-part_axis x -part_interval .8,1.1")
        plate = FLAT + "-body_force 1,0,0 -part_shape slab -part_axis y -part_interval .41,.67"  # slides along itself
        journeys = dict(JOURNEYS, piston=Journey(piston, .3, 2.7, (.5, 0, 0), 4, FROM_REST),
                        plate=Journey(plate, .26, .74, (1, 0, 0), 5, FROM_REST))
        turns = ["-part_angular_velocity_phase", str(FROM_REST)]
        plan = {name: ([*journey.all_options(.2, 1.2), "-time_step", ".006", *(turns if "turns" in name else [])], {})
                for name, journey in journeys.items()}
        for name, run in self.run_together(plan).items():
            summary, verdict = run.summary, run.summary["verdicts"][0]
            supplied = numpy.trapz(abs(numpy.array(run.series.wall_power)), run.series.time)
            share = summary["energy_lost"] / supplied
            print(f"    {name}: {share:+.4f} of {supplied:.3g} supplied lost, {summary['energy_made_share']:.4f} made, {verdict['why']}")
            self.assertLess(abs(share), .01, name)
            self.assertEqual((verdict["of"], verdict["verdict"]), ("energy", "fine"), verdict)

    def test_a_body_that_swings_in_a_viscous_fluid_makes_little_energy(self):
        """At automatic steps the pressure is late where it turns round, and the fluid still dissipates: a few per cent, for which
        the guard stopped such runs."""
        options = ("-boundary_y wall -species part -part_law rigid -part_shape cylinder -part_axis z -part_radius .2 -part_centre .33,.3,.5 "
                   f"-part_angular_velocity 0,0,2 -part_angular_velocity_angular_frequency 4 -fluid_viscosity 20 -time_end .85 {FLAT}{EVERY_STEP}")
        made = self.run_program("swings", *options.split()).summary["energy_made_share"]
        print(f"    made {made:.4f}")
        self.assertLess(made, .06)

    def test_pressure_settles_with_the_flow(self):
        """After 18 steps it is what it stays, in cells that the surface cuts too."""
        solid, scene = tilted_walls(24), self.tilted()
        options = f"{scene.options} {DRIVEN} -fluid_viscosity 20 -snapshot_interval 100 -snapshot_precision double"
        runs = self.run_together({f"{solver} {end}": (f"{options} -time_end {end} -pressure_solver {solver}".split(), {})
                                  for solver in ("acm", "smac") for end in (.3, 5)})
        for solver in "acm", "smac":
            early, late = (runs[f"{solver} {end}"].snapshots[-1]["pressure"][0][solid < .5] for end in (.3, 5))
            off = abs(early - late).max() / numpy.ptp(late)
            print(f"    {solver}: pressure off {off:.4f} of its range after {runs[f'{solver} 0.3'].summary['steps']} steps")
            self.assertLess(off, .01)

    def test_same_bits(self):
        """On any ranks, and in the rows after a restart, the first one included; power, too."""
        scenes = {"rests": f"{self.spheres(.343).options} {DRIVEN} {EVERY_STEP} -time_end .2".split(),
                  "travels": [*JOURNEYS["sphere"].all_options(1, .2), "-part_angular_velocity", "1,0,2", "-body_force", "1,0,0"]}
        for scene, options in scenes.items():
            options = [*options, "-time_steps_max", "6"]
            plan = {f"{scene}{ranks}": (options, {"ranks": ranks}) for ranks in (1, 2, 3)}
            plan[f"{scene} half"] = [*options[:-1], "3", "-checkpoint_interval", "1"], {}
            runs = list(self.run_together(plan).values())[:3]
            runs.append(self.run_program(f"{scene} rest", *options, "-restart", self.room / f"{scene} half", ranks=2))
            for run in runs[1:]:
                for name in "force", "torque":
                    numpy.testing.assert_array_equal(getattr(run.bodies, name)[-4:], getattr(runs[0].bodies, name)[-4:])
                numpy.testing.assert_array_equal(run.series.wall_power[-4:], runs[0].series.wall_power[-4:])


if __name__ == "__main__":
    unittest.main()

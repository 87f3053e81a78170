#!/usr/bin/python3
"""What series.csv and bodies.h5 say of vessels: flow rate, apparent viscosity, force and torque, against exact values.

Needs EULASTIC.
"""
import math
import os
import pathlib
import re
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import SceneCase  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]

RADIUS, CELLS = 0.385, 26  # 20 cells across
TUBE = (f"-grid_cells 8,{CELLS},{CELLS} -grid_length {8 / CELLS},1,1 -boundary_y wall -boundary_z wall -species vessel "
        f"-vessel_shape tube -vessel_axis x -vessel_radius {RADIUS} -vessel_centre 0.05,0.513,0.487").split()
STEADY = "-body_force 1,0,0 -fluid_viscosity 1 -time_end 1 -series_interval 1 -fluid_inertia false".split()
SIDES = "-body_force 0,0,0 -boundary_xmin pressure -boundary_xmax pressure -boundary_xmin_pressure 1".split()
RIGID, ELASTIC = ("-vessel_law", "rigid"), ("-vessel_shear_modulus", "10")
FLOW = math.pi * RADIUS ** 4 / 8


class Vessels(SceneCase):
    def run_with(self, *words, ranks=1):
        last = dict(zip(words[::2], words[1::2]))  # of an option that is given twice the last one counts
        return self.run_program(str(len(list(self.room.iterdir()))), *(word for pair in last.items() for word in pair), ranks=ranks)

    def test_flow_rate_and_apparent_viscosity_of_a_tube(self):
        for law in (RIGID, ELASTIC):
            series = self.run_with(*TUBE, *STEADY, *law).series
            self.assertEqual((series.vessel_flow_rate[0], series.vessel_apparent_viscosity[0]), (0, 0))
            self.assertAlmostEqual(series.vessel_flow_rate[-1] / FLOW, 1, delta=0.01)
            self.assertAlmostEqual(series.vessel_apparent_viscosity[-1], FLOW / series.vessel_flow_rate[-1], delta=1e-12)

    def test_apparent_viscosity_between_two_sides(self):
        length = 24 / CELLS
        series = self.run_with(*TUBE, *STEADY, *RIGID, "-grid_cells", f"24,{CELLS},{CELLS}", "-grid_length", f"{length},1,1",
                               *SIDES).series
        self.assertAlmostEqual(series.vessel_flow_rate[-1] / series.flow_rate_xmin[-1], 1, delta=1e-3)
        self.assertAlmostEqual(series.vessel_apparent_viscosity[-1], 1, delta=0.01)
        self.assertAlmostEqual(series.vessel_apparent_viscosity[-1] * series.vessel_flow_rate[-1] * length / FLOW, 1, delta=1e-9)

    def test_constricted_channel_counts_every_section(self):
        """A long throat, 2-D: lubrication theory, whose error is the square of the slope, at most .2 here."""
        series = self.run_with(*"-grid_cells 192,24,1 -grid_length 8,1,1 -boundary_y wall -species vessel -vessel_shape "
                               "constricted_tube -vessel_axis x -vessel_radius .42 -vessel_throat_radius .25 "
                               "-vessel_throat_length 8 -vessel_centre 4,.5,0".split(), *STEADY, *RIGID).series
        self.assertAlmostEqual(series.vessel_apparent_viscosity[-1], 1, delta=0.03)

    def test_check_only_takes_the_width_of_the_lumen(self):
        """A vessel from a file is no cell, and as wide as a tube of the same volume: 2 (V/(pi L))^(1/2) of the box less its solid."""
        done = subprocess.run([os.environ["EULASTIC"], ROOT / "options/branched_vessel.opts", "-check_only"], capture_output=True, text=True)
        said = dict(line.split(": ", 1) for line in done.stdout.splitlines() if ": " in line)
        self.assertNotIn("hematocrit", said)
        solid = float(re.search("volume ([0-9.]+)", said["species vessel"])[1])
        width = 2 * math.sqrt((48 * 32 * 16 - solid) / 48 / math.pi)
        self.assertAlmostEqual(float(re.search("length ([0-9.]+)", said["Reynolds number"])[1]), width, delta=1e-3)
        self.assertAlmostEqual(float(said["shear rate (estimate)"]), 1e-3 * width / 4, delta=1e-5)

    def test_no_column_where_it_is_not_defined(self):
        names = self.run_with(*"-grid_cells 16,16,1 -species a,b -a_shape tube -a_axis z -a_radius .4 -a_law rigid -b_shape sphere "
                              "-b_radius .1 -b_law rigid -time_end .01 -series_interval .01".split()).series.dtype.names
        self.assertFalse([name for name in names if "apparent" in name or name.endswith("_flow_rate")])

    def test_force_on_a_tube(self):
        """pi R^2 times the force on its length, or the pressure drop: all that drives the fluid in the lumen."""
        section = math.pi * RADIUS ** 2
        long = ("-grid_cells", f"24,{CELLS},{CELLS}", "-grid_length", f"{24 / CELLS},1,1")
        for name, drag, tolerance, words in (("rigid", section * 8 / CELLS, 0.005, RIGID),
                                             ("rigid, between sides", section, 0.005, (*RIGID, *long, *SIDES)),
                                             ("elastic", section * 8 / CELLS, 1e-4, ELASTIC)):
            bodies = self.run_with(*TUBE, *STEADY, *words, "-time_end", "4", "-series_interval", "4").bodies
            force, torque = bodies.force[-1, 0], bodies.torque[-1, 0]
            print(f"{name}: force {force / drag}, torque {torque / drag / RADIUS}")
            self.assertAlmostEqual(force[0] / drag, 1, delta=tolerance)
            self.assertLess(abs(force[1:]).max() / drag, 1e-3)
            self.assertLess(abs(torque).max() / (drag * RADIUS), 1e-2)

    def test_force_on_a_post_that_stands_on_a_wall(self):
        """A rigid one takes what the walls do not of the pressure drop, an elastic one passes it on to its wall."""
        post = (*"-grid_cells 64,32,1 -grid_length 2,1,1 -boundary_y wall -species post -post_shape cylinder -post_axis z "
                "-post_radius .3 -post_centre .9,.03,0 -post_anchored true".split(), *STEADY, *SIDES, "-time_end", "3")
        lift = []
        for law in "-post_law rigid", "-post_shear_modulus 20":
            run = self.run_with(*post, *law.split(), "-snapshot_interval", "3")
            snapshot, force = run.snapshots[-1], run.bodies.force[-1, 0]
            solid = snapshot["solid_fraction"][0, 0]
            low, high = (snapshot[f"wall_shear_stress_{wall}"][0, 0, :, 0] / 32 for wall in ("ymin", "ymax"))
            print(f"post, {law}: force {force}, walls {low.sum()} {high.sum()}, below it {(low * solid).sum()}")
            self.assertAlmostEqual((low * (1 - solid)).sum() + high.sum() + force[0], 1, delta=0.005)
            lift.append(force[1])
            if "rigid" not in law:
                self.assertAlmostEqual(force[0], (low * solid).sum(), delta=5e-4)
        # By refinement: the rigid one's is .3165 .3159 .3155 at 32, 64, 128 cells, the elastic one's .3275 .3184 at 32, 64.
        self.assertAlmostEqual(lift[0] / -.3153, 1, delta=0.005)
        self.assertAlmostEqual(lift[1] / -.3153, 1, delta=0.04)

    def test_same_on_any_ranks(self):
        """A rigid sphere in an elastic tube that is more viscous: its loads, flow, and stress on both surfaces."""
        scene = (*TUBE, *ELASTIC, *"-grid_cells 16,24,24 -grid_length .7,1,1 -species vessel,stone -vessel_viscosity 2 -stone_shape "
                 "sphere -stone_radius .15 -stone_centre .3,.5,.45 -stone_law rigid -body_force 1,.2,0 -fluid_viscosity 1 -time_end "
                 ".01 -series_interval .005 -snapshot_interval .01".split())
        one = self.run_with(*scene)
        bodies, stress, series = one.bodies, one.snapshots[-1]["wall_shear_stress"], one.series
        for ranks in 2, 3, 4:
            other = self.run_with(*scene, ranks=ranks)
            self.assertEqual(other.series.tobytes(), series.tobytes())
            for name in "force", "torque":
                numpy.testing.assert_array_equal(getattr(other.bodies, name), getattr(bodies, name))
            numpy.testing.assert_array_equal(other.snapshots[-1]["wall_shear_stress"], stress)

    def test_cells_in_boxes_load_the_vessel_that_they_touch(self):
        """Two stretched cells, one of them across the periodic side: the same in boxes of their own, on any ranks, as on the grid."""
        def loads(name, *words, ranks=1, modulus="5"):
            bodies = self.run_program(name, *scene, "-cell_shear_modulus", modulus, *words, ranks=ranks).bodies
            return numpy.concatenate([bodies.force[:, 0], bodies.torque[:, 0]], axis=1)

        places = self.room / "places.csv"
        places.write_text("x,y,z\n.02,.8,.487\n.5,.513,.2\n")
        scene = (*"-grid_cells 24,26,26 -grid_length .9230769,1,1".split(), *TUBE[4:TUBE.index("-species")], *"-species vessel,cell".split(),
                 *TUBE[TUBE.index("-vessel_shape"):], *ELASTIC, "-cell_positions", places, *"-cell_shape ellipsoid -cell_placement list "
                 "-cell_semi_axes .13,.0877,.0877 -cell_initial_stretch 1.3,.877,.877 -body_force 1,.2,0 -fluid_viscosity 1 -time_end 1 "
                 "-series_interval 1e-9 -time_steps_max 3".split())
        boxes, grid, soft = loads("boxes"), loads("grid", "-cell_contact", "merge"), loads("soft", modulus="1e-9")
        self.assertGreater(abs(boxes - soft)[:, :3].max(), 1e-3, "the cells do not touch the vessel")
        numpy.testing.assert_allclose(boxes, grid, rtol=0, atol=1e-12)
        for ranks in 2, 3, 4:
            numpy.testing.assert_array_equal(loads(f"boxes{ranks}", ranks=ranks), boxes)

    def test_torque_on_an_elastic_ring(self):
        """A rigid cylinder turns in an elastic one that is attached: 4 pi mu Omega / (1/a^2 - 1/b^2)."""
        bodies = self.run_with(*"-grid_cells 64,64,1 -boundary_x wall -boundary_y wall -species rotor,vessel -rotor_shape cylinder "
                               "-rotor_axis z -rotor_radius .15 -rotor_centre .513,.487,.5 -rotor_law rigid -rotor_angular_velocity 0,0,1 "
                               "-vessel_shape tube -vessel_axis z -vessel_radius .4 -vessel_centre .513,.487,.5 -vessel_shear_modulus "
                               "40 -time_end 3 -series_interval 3".split()).bodies
        exact = 4 * math.pi / (.15 ** -2 - .4 ** -2)
        print(f"torques over the exact one: {bodies.torque[-1, :, 2] / exact}")
        self.assertAlmostEqual(bodies.torque[-1, 1, 2] / exact, 1, delta=0.01)
        self.assertAlmostEqual(bodies.torque[-1, 0, 2] / -exact, 1, delta=0.01)

    def test_pressure_in_rigid_walls_is_bounded(self):
        """Nothing solves for the pressure of cells whose faces are all closed: it stays what it was, and the mean of the pressure
        is that of the fluid."""
        run = self.run_program("tube", *(
            "-grid_cells 16,18,18 -grid_length 10.666666666666667,12,12 -fluid_viscosity 1.2 -body_force 1e-3,0,0 -species "
            "vessel,cell -vessel_shape tube -vessel_axis x -vessel_diameter 10 -vessel_law rigid -cell_shape sphere -cell_radius "
            "2.5 -cell_shear_modulus .02 -cell_viscosity 6 -time_end 500 -snapshot_interval 500").split())
        with h5py.File(run.directory / "snapshot_000001.h5") as file:
            pressure, solid = file["pressure"][...].astype(float), file["solid_fraction"][...]
        k, j, i = numpy.indices(pressure.shape)
        deep = numpy.hypot((j + .5) * 12 / 18 - 6, (k + .5) * 12 / 18 - 6) > 5 + 1.5 * 12 / 18  # inside the wall
        self.assertEqual(abs(pressure[deep]).max(), 0)
        self.assertLess(abs(pressure).max(), .01)
        self.assertLess(abs(pressure[~deep].mean()), 1e-4)
        self.assertGreater(abs(pressure[solid < .01]).max(), 1e-4)

    def test_pressure_where_a_body_travels_is_bounded(self):
        """Cells close and open as it goes: the level of the pressure stays, and nothing grows in cells that it has closed."""
        scene = ("-grid_cells 24,16,1 -grid_length 3,2,1 -boundary_y wall -body_force .1,0,0 -fluid_viscosity .3 -species post,cell "
                 "-post_shape sphere -post_radius .45 -post_centre 1,.9,0 -post_law rigid -post_velocity .3,.1,0 "
                 "-post_velocity_angular_frequency 2 -cell_shape sphere -cell_radius .25 -cell_centre 2.3,1.2,0 -cell_shear_modulus 2 "
                 "-guard_volume_drift 0 -time_end 12 -snapshot_interval 6 -snapshot_fields pressure,solid_fraction "
                 "-snapshot_precision double").split()
        for viscosity in (.3, .15):
            run = self.run_program("travels", *scene, "-cell_viscosity", str(viscosity), "-output_overwrite")
            for number in (1, 2):
                with h5py.File(run.directory / f"snapshot_{number:06d}.h5") as file, self.subTest(viscosity=viscosity, number=number):
                    pressure, post = file["pressure"][...], file["solid_fraction_post"][...]
                    self.assertLess(abs(pressure[post == 0].mean()), .02)
                    self.assertLess(abs(pressure).max(), 1.5)
                    self.assertGreater(abs(pressure).max(), .3)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Exact balances beside moving rigid bodies, moving walls and open boundaries.

Needs EULASTIC=path of the binary.
"""
import pathlib
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import SceneCase  # noqa: E402

BOX = "-grid_cells 16,16,1 -grid_length 1,1,1".split()


class Balances(SceneCase):
    def last(self, name, *options):
        return self.run_program(name, *options).series[-1]

    def test_a_gap_of_one_face_between_two_bodies(self):
        """Couette flow between two slabs, one of which slides: the face between them sees the velocity of each slab at its own link.
        The power is that of the shear stresses of both gaps, 1 / .0625 and 1 / .6, whichever way the slabs lie."""
        for axis, other in ("y", "x"), ("x", "y"):
            velocity = "1,0,0" if axis == "y" else "0,1,0"
            row = self.last(f"gap_{axis}", *BOX, "-time_end", "2", "-species", "s,u", *(
                f"-s_shape slab -s_axis {axis} -s_interval 0.1,0.3 -s_law rigid -s_velocity {velocity} "
                f"-u_shape slab -u_axis {axis} -u_interval 0.3625,0.5 -u_law rigid").split())
            for power in row.wall_power, row.viscous_dissipation:
                self.assertAlmostEqual(power, 1 / .0625 + 1 / .6, delta=1e-5, msg=f"along {other}")

    def test_two_slabs_that_touch_shear_no_fluid_between_them(self):
        """They slide with 1 and -1; the fluid in the rest of the period, .6, has the shear rate 2 / .6."""
        row = self.last("touch", *BOX, *("-time_end 2 -species s,u -s_shape slab -s_axis y -s_interval .1,.3 -s_law rigid -s_velocity 1,0,0 "
                                         "-u_shape slab -u_axis y -u_interval .3,.5 -u_law rigid -u_velocity -1,0,0").split())
        for power in row.wall_power, row.viscous_dissipation:
            self.assertAlmostEqual(power, 4 / .6, delta=1e-4)

    def test_a_piston_in_a_tube_along_x_and_y(self):
        """The same scene with exchanged axes has the same dissipation, and its energy budget closes."""
        found = []
        for a, cells, length, velocity in ("x", "24,16,1", "1.5,1,1", "1,0,0"), ("y", "16,24,1", "1,1.5,1", "0,1,0"):
            row = self.last(f"piston_{a}", "-grid_cells", cells, "-grid_length", length, "-species", "t,p", *(
                f"-boundary_{a}min pressure -boundary_{a}max pressure -p_velocity {velocity} -t_shape tube -t_axis {a} -t_radius .4 "
                f"-t_law rigid -p_shape slab -p_axis {a} -p_interval .43,.69 -p_law rigid -time_end .1 -fluid_viscosity .2").split())
            self.assertLess(abs(row.energy_lost), .4 * row.wall_power * row.time)
            found.append(row.viscous_dissipation)
        self.assertAlmostEqual(found[0], found[1], delta=1e-9)

    def test_slabs_that_slide_at_a_changing_rate(self):
        """Stokes' second problem between a slab and its image: the flow that oscillates with the walls. One surface, or the other one in the
        mirrored scene, is .001 cells from a face, whose velocity must follow it."""
        end, omega, nu = .8, 10, .2
        rows = []
        for axis, velocity, interval in (("y", "1,0,0", ".2188,.7"), ("x", "0,1,0", ".2188,.7"), ("y", "1,0,0", ".3,.7812")):
            rows.append(self.last(f"slide{len(rows)}", *BOX, *(
                f"-time_end {end} -fluid_viscosity {nu} -species s -s_shape slab -s_axis {axis} -s_interval {interval} -s_law rigid "
                f"-s_velocity {velocity} -s_velocity_angular_frequency {omega}").split()))
        width = 1 - (.7 - .2188)
        at = numpy.linspace(-width / 2, width / 2, 2001)
        wave = (1j * omega / nu)**.5
        shear = (numpy.exp(1j * omega * end) * wave * numpy.sinh(wave * at) / numpy.cosh(wave * width / 2)).real
        exact = nu * numpy.mean(shear**2) * width
        for row in rows:
            self.assertAlmostEqual(row.viscous_dissipation, exact, delta=.03 * exact)
            self.assertAlmostEqual(row.viscous_dissipation, rows[0].viscous_dissipation, delta=1e-9 * exact)
            self.assertAlmostEqual(row.energy_lost, rows[0].energy_lost, delta=1e-9 * exact)

    def test_cylinders_that_turn_at_a_changing_rate(self):
        """On the coarse grid faces are .001 cells from the surface; the dissipation is that of the fine grid nevertheless, with all methods,
        and the energy budget closes."""
        turning = "-grid_length 1,1,1 -time_end .6 -fluid_viscosity .1 -species c -c_shape cylinder -c_axis z -c_radius .2 -c_law rigid " \
                  "-c_angular_velocity 0,0,5 -c_angular_velocity_angular_frequency 10".split()
        fine = self.last("fine", "-grid_cells", "48,48,1", *turning)
        for name, share, *options in ("fast", .01), ("smac", .01, "-pressure_solver", "smac"), ("classic", .04, "-method", "classic"):
            series = self.run_program(name, "-grid_cells", "16,16,1", *turning, *options).series
            self.assertAlmostEqual(series[-1].viscous_dissipation, fine.viscous_dissipation, delta=share * fine.viscous_dissipation, msg=name)
            started = series[int(numpy.searchsorted(series.time, .2))]
            supplied = fine.wall_power * (.6 - started.time)  # nearly its largest value
            self.assertLess(abs(series[-1].energy_lost - started.energy_lost), 2.5 * share * supplied, name)

    def test_bodies_across_a_periodic_boundary(self):
        """A shift of the scene, so that a surface lies beside a periodic boundary, changes nothing but round-off and the pressure's tolerance."""
        disc = "-s_shape cylinder -s_axis z -s_radius .19 -s_angular_velocity 0,0,5"
        ellipse = "-s_shape ellipsoid -s_semi_axes .3,.15,.15 -s_angular_velocity 0,0,3 -s_angular_velocity_angular_frequency 7"
        for name, body, shift in ("disc", disc, 5 / 16), ("ellipse", ellipse, 1 / 4):
            rows = [self.last(f"{name}{n}", "-grid_cells", "16,16,1", *(
                f"-time_end .1 -fluid_viscosity .1 -acm_tolerance 1e-9 -species s -s_law rigid {body} -s_centre {x},{y},.5").split())
                for n, (x, y) in enumerate(((.5, .5), (.5 - shift, .5), (.5, .5 - shift)))]
            for row in rows[1:]:
                for column in "viscous_dissipation", "wall_power", "energy_lost":
                    self.assertAlmostEqual(row[column], rows[0][column], delta=1e-6 * row.viscous_dissipation, msg=f"{name}: {column}")

    def test_torque_of_voxels_across_a_periodic_boundary(self):
        """It is that of the nearest image about the centre, wherever the scene begins."""
        solid = numpy.zeros((1, 16, 16))
        solid[0, 5:11, 5:9] = solid[0, 5:8, 5:12] = 1  # an L
        solid[0, 7, 11] = .7
        torques = []
        for n, (x, y) in enumerate(((0, 0), (8, 0), (0, 8), (-7, 7))):
            with h5py.File(self.room / f"solid{n}.h5", "w") as file:
                file["solid"] = numpy.roll(solid, (y, x), (1, 2))
            centre = (.45 + x / 16) % 1, (.48 + y / 16) % 1
            run = self.run_program(f"voxels{n}", *BOX, *(
                f"-time_end .1 -fluid_viscosity 1 -acm_tolerance 1e-9 -body_force 1,.5,0 -species s -s_law rigid -s_shape voxels "
                f"-s_voxels {self.room}/solid{n}.h5 -s_voxels_spacing .0625,.0625,1 -s_centre {centre[0]},{centre[1]},.5").split())
            torques.append(run.bodies.torque[:, 0, 2])
        self.assertGreater(abs(torques[0][-1]), .003)
        for torque in torques[1:]:
            numpy.testing.assert_allclose(torque, torques[0], atol=1e-6)

    def test_rigid_bodies_move_without_series_of_bodies(self):
        """The power of a body that turns is in the energy budget whether bodies.h5 is written or not."""
        turning = [*BOX, *("-time_end .05 -species s -s_law rigid -s_shape cylinder -s_axis z -s_radius .2 "
                           "-s_angular_velocity 0,0,1").split()]
        with_bodies, without = (self.last(name, *turning, *more) for name, more in (("with", ()), ("without", ("-body_series", "false"))))
        self.assertGreater(without.wall_power, 0)
        self.assertEqual(with_bodies.wall_power, without.wall_power)

    def test_power_of_a_wall_that_reaches_open_boundaries(self):
        """Couette flow of shear rate 1 at the viscosity .2: half a cell of the wall belongs to the face on each open boundary."""
        row = self.last("couette", *("-grid_cells 8,8,1 -grid_length 1,1,1 -boundary_y wall -boundary_ymax_velocity 1,0,0 -boundary_xmin pressure "
                                     "-boundary_xmax pressure -time_end 5 -fluid_viscosity .2").split())
        self.assertAlmostEqual(row.wall_power, .2, delta=1e-4)
        self.assertAlmostEqual(row.viscous_dissipation, .2, delta=1e-4)

    def test_power_of_a_force_towards_an_open_boundary(self):
        """The flow turns from an inlet to an outlet above or below: v = (1 - x, y), so that the mean velocity along the force is .5."""
        for side, force in ("max", "3"), ("min", "-3"):
            row = self.last(f"turn_{side}", *(
                f"-grid_cells 8,8,1 -boundary_x symmetry -boundary_xmin inflow -boundary_xmin_velocity 1 -boundary_y symmetry "
                f"-boundary_y{side} pressure -fluid_viscosity .05 -body_force 0,{force},0 -time_end 2").split())
            self.assertAlmostEqual(row.force_power, 1.5, delta=1e-6)

    def test_without_inertia_outflow_is_linear(self):
        """No dynamic pressure and no flux of kinetic energy: an opposite force drives the opposite flow."""
        flows = [self.last(f"force_{force}", *(
            f"-grid_cells 12,8,1 -grid_length 1.5,1,1 -fluid_viscosity .1 -boundary_y wall -boundary_xmin outflow -boundary_xmax pressure "
            f"-body_force {force},0,0 -time_end 1 -fluid_inertia false").split()).flow_rate_xmax for force in (10, -10)]
        self.assertAlmostEqual(flows[0], -flows[1], delta=1e-9 * abs(flows[0]))

    def test_classic_continues_beside_an_inlet(self):
        """The projection of the start is no step, and its sound speed says nothing about the flow."""
        scene = ("-grid_cells 16,8,1 -grid_length 2,1,1 -fluid_viscosity .1 -boundary_y wall -method classic -boundary_xmin inflow "
                 "-boundary_xmin_velocity 1 -boundary_xmax outflow -time_end .5").split()
        whole = self.run_program("whole", *scene)
        self.run_program("parts", *scene, "-time_steps_max", "5")
        parts = self.run_program("parts", *scene, "-restart", str(self.room / "parts"))
        for name in "state_hash", "mach_max":
            self.assertEqual(parts.summary[name], whole.summary[name])

    def test_a_snapshot_begins_with_its_flow_through_a_high_outlet(self):
        """Snapshots do not hold the faces on high boundaries: what flows through these is what flows through the box."""
        scene = ("-grid_cells 8,8,1 -fluid_viscosity .5 -boundary_y wall -boundary_xmin pressure -boundary_xmin_pressure 2 -boundary_xmax "
                 "pressure -boundary_xmax_pressure 1 -time_step .05").split()
        steady = self.run_program("steady", *scene, "-time_end", "5", "-snapshot_interval", "5", "-snapshot_precision", "double")
        again = self.run_program("again", *scene, "-time_end", ".1", "-initial_state", str(self.room / "steady/snapshot_000001.h5"))
        self.assertAlmostEqual(again.series.flow_rate_xmax[0], steady.series.flow_rate_xmax[-1], delta=1e-9)

    def test_a_profile_is_the_velocity_where_a_body_covers_an_inlet(self):
        """Without a velocity or a flow rate the values of the file are not scaled: 2 on three quarters of the inlet."""
        (self.room / "profile.txt").write_text("2\n" * 16)
        row = self.last("covered", *("-grid_cells 24,16,1 -grid_length 1.5,1,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax pressure "
                                     "-time_end .01 -species s -s_shape slab -s_axis y -s_interval 0,.25 -s_law rigid").split(),
                        "-boundary_xmin_profile", str(self.room / "profile.txt"))
        self.assertAlmostEqual(row.flow_rate_xmin, 1.5, delta=1e-9)


if __name__ == "__main__":
    unittest.main()

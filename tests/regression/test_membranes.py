#!/usr/bin/python3
"""Membranes as options set them up."""
import pathlib
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import SceneCase  # noqa: E402

CAPSULE = ("-grid_cells 32,32,32 -grid_length 4,4,4 -fluid_viscosity 1 -species a -a_shape sphere -a_radius 1 "
           "-a_centre 2,2,2 -a_law membrane -a_surface_shear_modulus 1 -interface_scheme plic -time_step 1e-3 "
           "-time_end 2e-3 -series_interval 1e-3 -snapshot_interval 2e-3").split()
SHEAR = [str(pathlib.Path(__file__).resolve().parents[2] / "options" / "capsule_in_shear.opts"),
         *("-grid_cells 20,24,20 -grid_length 5,6,5 -boundary_ymin_velocity -3,0,0 -boundary_ymax_velocity 3,0,0 -snapshot_interval 0").split()]

# A red cell that lies on a wall, is pressed against it, and drawn along by the other one: 2-D, 16 cells long.
LYING = ("-grid_cells 48,32,1 -grid_length 24,16,.5 -boundary_y wall -fluid_viscosity 1.2 -boundary_ymax_velocity .2,0,0 -species rbc "
         "-rbc_law red_cell -rbc_diameter 8 -rbc_axis y -rbc_centre 12,1.32,.25 -rbc_body_force 0,-4e-3,0 -time_end 600 "
         "-series_interval 10 -snapshot_interval 0").split()

# One that is pressed and pulled along a wall.
PRESSED = ("-grid_cells 32,16,1 -grid_length 16,8,.5 -boundary_y wall -fluid_viscosity 1.2 -boundary_ymax_velocity .2,0,0 -species rbc "
           "-rbc_law red_cell -rbc_diameter 8 -rbc_axis y -rbc_centre 8,1.85,.25 -rbc_surface_shear_modulus .1 "
           "-rbc_bending_modulus .004 -rbc_body_force .02,-.04,0 -time_end 5300 -series_interval 10 -snapshot_interval 0").split()

# Red cells that lie over each other between plates whose shear stress is some 5 times their shear modulus over a length.
LAYERS = ("-grid_cells 24,20,18 -grid_length 12,10,9 -boundary_y wall -fluid_viscosity 1.2 -body_force 8e-4,0,0 -species rbc "
          "-rbc_law red_cell -rbc_diameter 8 -snapshot_interval 0").split()


class Membranes(SceneCase):
    def test_orientation_turns_the_stretch(self):
        """Stretches along x and y, turned about z, are those along y and x: energy, and the flow that it drives."""
        straight = self.run_program("straight", *CAPSULE, "-a_initial_stretch", ".9,1.2,1.1")
        turned = self.run_program("turned", *CAPSULE, "-a_initial_stretch", "1.2,.9,1.1", "-a_orientation", "0,0,90")
        other = self.run_program("other", *CAPSULE, "-a_initial_stretch", "1.2,.9,1.1")
        round_off = 1e-9
        energy = straight.series.surface_energy
        self.assertGreater(energy[0], 0.1)
        self.assertLess(energy[-1], energy[0])
        numpy.testing.assert_allclose(turned.series.surface_energy, energy, rtol=round_off)
        speed = [run.snapshots[-1].velocity() for run in (straight, turned, other)]
        largest = abs(speed[0]).max()
        numpy.testing.assert_allclose(speed[1], speed[0], atol=round_off * largest)
        self.assertGreater(abs(speed[2] - speed[0]).max(), 0.1 * largest)

    def test_a_uniform_tension_is_balanced_by_a_pressure(self):
        """A ring and a ball under tension, of both laws, in fluid at rest: tension and energy stay, and the flow is slow, also where the
        tension is larger than the shear modulus, or the body lies across a periodic boundary. The bits are the same on any ranks."""
        for name, cells, law, speed in (("ring", "48,48,1", "neo_hookean", 1e-4), ("ball", "20,20,20", "neo_hookean", 1e-2),
                                        ("stiff", "48,48,1", "skalak -a_skalak_c 10", 1e-4)):
            for x in (.5, 0) if name == "ring" else (.5,):
                options = (f"-grid_cells {cells} -fluid_viscosity .1 -species a -a_shape sphere -a_radius .3 -a_centre {x},.5,.5 -a_law membrane "
                           f"-a_surface_shear_modulus .5 -a_initial_area_stretch 1.2 -a_membrane_law {law} -time_end .3 -series_interval .1 "
                           "-snapshot_interval 0").split()
                run = self.run_program(f"{name}_{x}", *options)
                energy, last = run.series.surface_energy, run.series[-1]
                self.assertLess(abs(energy[-1] / energy[0] - 1), 2e-4, name)
                self.assertLess(last.speed_max, speed * .3 / .1, name)  # the tension over the viscosity is about .3/.1 and more
                if name == "ring":
                    other = self.run_program(f"{name}_{x}_ranks", *options, ranks=3)
                    self.assertEqual(other.summary["state_hash"], run.summary["state_hash"])

    def test_ends_are_pulled_apart(self):
        """The flow is its own mirror image, nothing moves as a whole, and the budget is closed."""
        capsule = CAPSULE[:CAPSULE.index("-time_end")]
        run = self.run_program("pulled", *capsule, *("-a_stretch_force .5 -a_stretch_volume_fraction .1 -time_end 2e-2 "
                                                     "-series_interval 1e-3 -snapshot_interval 2e-2 -snapshot_precision double").split())
        x, y, z = run.snapshots[-1].velocity()
        largest, round_off = abs(x).max(), 1e-9
        self.assertGreater(largest, 1e-4)
        numpy.testing.assert_allclose(x, -x[:, :, ::-1], atol=round_off * largest)
        numpy.testing.assert_allclose(y, y[:, :, ::-1], atol=round_off * largest)
        numpy.testing.assert_allclose(z, z[:, :, ::-1], atol=round_off * largest)
        self.assertGreater(x[16, 16, 24], 0.5 * largest)  # away from the middle
        self.assertLess(abs(x.mean()), round_off * largest)
        self.assertGreater(run.series.force_power[-1], 0)
        supplied = run.summary["energy_supplied"]
        self.assertLess(abs(run.summary["energy_lost"]), 0.005 * supplied)
        self.assertGreater(run.bodies.taylor_deformation[-1, 0], run.bodies.taylor_deformation[0, 0])

    def test_the_shape_at_rest_is_remembered(self):
        """A capsule that tank-treads keeps its deformation, which fades without markers."""
        def late_over_early(name, *more):
            run = self.run_program(name, *SHEAR, "-time_end", "12", "-series_interval", ".5", *more)
            return numpy.divide(*(numpy.interp(t, run.bodies.time, run.bodies.taylor_deformation[:, 0]) for t in (12, 4)))
        self.assertLess(abs(late_over_early("markers") - 1), 0.015)
        self.assertLess(late_over_early("grid", "-capsule_membrane_scheme", "grid"), 0.95)

    def test_markers_go_on_after_a_restart(self):
        """On other ranks too, with the same bits."""
        whole = self.run_program("whole", *SHEAR, "-time_steps_max", "24")
        half = self.run_program("half", *SHEAR, "-time_steps_max", "12", "-checkpoint_interval", "100", ranks=2)
        with h5py.File(half.directory / "checkpoint_00000012.h5") as file:
            self.assertGreater(len(file["membrane_markers"]), 100)
        on = self.run_program("half", *SHEAR, "-time_steps_max", "24", "-restart", half.directory, ranks=3)
        self.assertEqual(on.summary["state_hash"], whole.summary["state_hash"])

    def slides(self, run):
        """Five cells away while the wall above goes on by 15 cells' lengths; whole, and makes no energy."""
        bodies, series = run.bodies, run.series
        self.assertGreater(bodies.centroid[-1, -1, 0] - bodies.centroid[0, -1, 0], 5)
        self.assertLess(bodies.largest_stretch[:, -1].max(), 1.72)  # along the surface; glued to the wall 1.73 and more
        self.assertLess(abs(bodies.volume[:, -1] / bodies.volume[0, -1] - 1).max(), 1e-6)
        self.assertGreater(series.energy_lost_elastic.min(), -0.02)
        self.assertLess(series.energy_lost_elastic[-1], 0.004 * run.summary["energy_dissipated"])

    def test_layers_make_no_energy(self):
        """Markers that are carried past the edge of a cell at a wall, which the grid does not resolve, tell nothing."""
        cells = self.room / "layers.csv"
        cells.write_text("6,1.813,4.5\n0,5,4.5\n6,8.187,4.5\n")
        run = self.run_program("layers", *LAYERS, *f"-rbc_placement list -rbc_positions {cells} -time_end 2500 -series_interval 20".split())
        self.assertGreater(run.bodies.largest_stretch[-1].max(), 1.4)
        self.assertLess(run.summary["energy_made_share"], 0.01)

    def test_sides_less_than_two_cells_apart_are_told_apart(self):
        """Cells half way between them belong to neither: wherever the grid lies, a membrane is stretched alike."""
        stretch = [self.run_program(f"at_{y}", *LAYERS, *f"-rbc_centre 6,{y},4.5 -time_end 100".split()).bodies.largest_stretch[-1, 0]
                   for y in (5, 5.25)]
        self.assertLess(max(stretch), 1.04)
        self.assertLess(abs(stretch[1] - stretch[0]), 0.01)

    def test_one_that_lies_on_a_wall_slides(self):
        run = self.run_program("lying", *LYING)
        self.slides(run)
        with h5py.File(next(run.directory.glob("checkpoint_*.h5"))) as file:
            markers = file["membrane_markers"][:].reshape(-1, 21)
        from_wall = markers[:, 4] + 0.5 + markers[:, 7]  # row of the cell, and place in it
        self.assertGreater(len(markers), 40)
        self.assertGreater(from_wall.min(), 0.5)

    def test_one_that_is_pressed_along_a_wall_goes_on(self):
        """For 50 of its lengths, drawn along by half the force that presses it, on a film that carries it."""
        run = self.run_program("pressed", *PRESSED)
        bodies = run.bodies
        self.assertGreater(bodies.centroid[-1, 0, 0] - bodies.centroid[0, 0, 0], 50 * 8)
        half = bodies.time > 2500
        self.assertLess(bodies.centroid[half, 0, 1].max(), 3.4)  # three quarters of its radius
        way = numpy.polyfit(bodies.time[half], bodies.centroid[half, 0, 0], 1)  # at the same speed all the time
        self.assertLess(abs(numpy.polyval(way, bodies.time[half]) - bodies.centroid[half, 0, 0]).max(), 8)
        self.assertLess(bodies.largest_stretch.max(), 1.2)
        self.assertLess(run.summary["energy_made_share"], 0.01)

    def test_a_wall_above_is_one_below(self):
        """Mirrored scene, mirrored result."""
        below = self.run_program("below", *LYING, "-time_steps_max", "40")
        options = " ".join(LYING).replace("boundary_ymax", "boundary_ymin").replace("12,1.32", "12,14.68").replace("0,-4e-3,0", "0,4e-3,0")
        above = self.run_program("above", *options.split(), "-time_steps_max", "40")
        round_off = 1e-9
        for name in ("kinetic_energy", "surface_energy", "surface_power"):
            one, other = (getattr(run.series, name) for run in (below, above))
            numpy.testing.assert_allclose(one, other, rtol=round_off, atol=round_off * abs(one).max())
        self.assertGreater(below.series.surface_energy[0], 10 * below.bodies.bending_energy[0, 0])  # of the film


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Bodies in boxes of their own: the same bits on 1 to 4 ranks and after a restart wherever the bodies are, and the body itself
wherever its box ends.

Needs EULASTIC_RUN_MANY and EULASTIC_MPIEXEC.
"""
import pathlib
import sys
import unittest

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/support")]
from scene_case import SceneCase  # noqa: E402

ALL = ("-fluid_viscosity .2 -time_end 100 -guard_volume_drift 0 -guard_energy_growth 0 -series_interval 1e-3 -species cell "
       "-cell_shape ellipsoid -cell_placement list -cell_positions").split()
# Skalak's law with markers, bending and a viscosity of their own.
MEMBRANE = ("-cell_law membrane -cell_membrane_law skalak -cell_surface_shear_modulus .05 -cell_skalak_c 2 -cell_bending_modulus .002 "
            "-cell_viscosity .6").split()
ELASTIC = ["-cell_shear_modulus", ".5"]
STIRRED = "-body_force .5,0,0 -initial_velocity taylor_green -initial_velocity_amplitude .3".split()


class Boxes(SceneCase):
    def same_on_ranks(self, rows, *scene, steps=6, ranks=(1, 2, 3, 4), restart=True, prefix="ranks"):
        """Runs a scene of bodies with these centres on these ranks, on two threads, and from the middle on; returns the one on one rank."""
        file = self.room / "places.csv"
        file.write_text("\n".join(["x,y,z", *(",".join(map(str, row)) for row in rows), ""]))
        words = [*ALL, file, *(ELASTIC if "-cell_law" not in scene else []), *map(str, scene)]
        runs = {f"{prefix}{n}": ([*words, "-time_steps_max", steps], {"ranks": n}) for n in ranks}
        if len(ranks) > 1:
            runs[f"{prefix}threads"] = ([*words, "-time_steps_max", steps, "-threads", 2], {"ranks": 1})
        if restart:
            runs[f"{prefix}half"] = ([*words, "-time_steps_max", steps // 2], {"ranks": 2})
        found = self.run_together(runs)
        if restart:
            again = [*words, "-time_steps_max", steps, "-restart", self.room / f"{prefix}half"]
            found |= self.run_together({f"{prefix}restarted": (again, {"ranks": 3})})
        one = found[f"{prefix}1"]
        for name, run in found.items():
            if not name.endswith("half"):
                self.assertEqual(run.summary["state_hash"], one.summary["state_hash"], name)
                self.assertEqual(run.summary["bodies"], one.summary["bodies"], name)
        return one

    def test_a_body_as_long_as_the_domain(self):
        # With the layers around it each box meets itself across the periodic side; one is turned along y and ends at both walls.
        one = self.same_on_ranks([(.1, .3, 0), (1.5, .72, 0)], *"-grid_cells 32,16,1 -grid_length 2,1,1 -boundary_y wall".split(), *STIRRED,
                                 *"-cell_semi_axes .98,.12,.12".split())
        for body in one.summary["bodies"]:
            self.assertAlmostEqual(body["volume"], numpy.pi * .98 * .12, delta=2e-4)

    def test_bodies_at_all_sides(self):
        # On the corner of two periodic sides, and pressed against walls.
        rows = [(0, .5, 0), (.02, .81, 1.19), (.6, .19, .6), (.7, .81, .58)]
        one = self.same_on_ranks(rows, *"-grid_cells 24,20,24 -grid_length 1.2,1,1.2 -boundary_y wall".split(), *STIRRED,
                                 *"-cell_semi_axes .2,.17,.2".split())
        self.assertEqual([round(body["centroid"][1], 2) for body in one.summary["bodies"]], [.5, .81, .19, .81])

    def test_membranes_at_all_sides(self):
        # On a corner of two periodic sides, and against walls with a film between.
        rows = [(0, .5, 0), (.02, .79, 1.19), (.6, .21, .6)]
        one = self.same_on_ranks(rows, *"-grid_cells 24,20,24 -grid_length 1.2,1,1.2 -boundary_y wall".split(), *STIRRED, *MEMBRANE,
                                 *"-cell_semi_axes .2,.15,.2".split())
        self.assertGreater(min(body["bending_energy"] for body in one.summary["bodies"]), 0)

    def test_drops_where_no_wall_holds_the_fluid(self):
        # Across periodic sides; surface tension must not make the fluid drift.
        drops = "-cell_law neo_hookean -cell_shear_modulus 0 -cell_surface_tension .2".split()
        one = self.same_on_ranks([(.98, .2, 0), (.5, .62, 0)], *"-grid_cells 32,32,1 -grid_length 1,1,1 -cell_semi_axes .2,.15,.2".split(),
                                 *drops)
        self.assertLess(abs(one.series.bulk_velocity_x[-1]), 1e-9)

    def test_membranes_where_no_wall_holds_the_fluid(self):
        one = self.same_on_ranks([(.1, .2, 0), (.1, .62, 0)], *"-grid_cells 32,32,1 -grid_length 1,1,1 -cell_semi_axes .2,.15,.2".split(),
                                 *"-initial_velocity taylor_green -initial_velocity_amplitude .3".split(), *MEMBRANE)
        self.assertLess(abs(one.series.bulk_velocity_x[-1]), 1e-6)

    def test_bodies_far_apart_are_those_of_the_grid(self):
        # Species whose bodies may merge stay on the grid. Of bodies with viscosities and forces of their own, all that a row of the
        # series says and what is known of every body.
        scene = ("-grid_cells 40,24,24 -grid_length 2,1.2,1.2 -boundary_y wall -cell_semi_axes .2,.15,.2 -cell_body_force 1,.5,0 "
                 "-time_step 5e-4").split()
        for name, kind in (("membranes", MEMBRANE), ("solids", ["-cell_viscosity", ".5"]),
                           ("drops", "-cell_law neo_hookean -cell_shear_modulus 0 -cell_surface_tension .2 -cell_viscosity .5".split()),
                           ("drawn", "-cell_law neo_hookean -cell_shear_modulus .5 -cell_surface_tension .2".split()),
                           ("reset", ["-solid_exterior", "identity"]),
                           ("stretched", [*MEMBRANE, "-cell_stretch_force", ".05"])):
            boxes, grid = (self.same_on_ranks([(.5, .6, .6), (1.5, .6, .6)], *scene, *STIRRED, *kind, *contact, ranks=(1,), restart=False,
                                              prefix=f"{name}_{where}_")
                           for where, contact in (("boxes", []), ("grid", ["-cell_contact", "merge"])))
            for column in boxes.series.dtype.names:
                ours, theirs = (getattr(run.series, column) for run in (boxes, grid))
                scale = abs(theirs).max()
                # On the grid cells that a body has reached since labels were carried are not pulled.
                bound, floor = (1e-4, 1e-12) if name == "stretched" else (1e-7, 1e-15)
                numpy.testing.assert_allclose(ours, theirs, rtol=bound, atol=bound * scale + floor, err_msg=f"{name} {column}")
            for one, other in zip(boxes.summary["bodies"], grid.summary["bodies"]):
                self.assertEqual(set(one), set(other))
                for key, value in one.items():
                    if not isinstance(value, str):
                        numpy.testing.assert_allclose(value, other[key], rtol=1e-6, atol=1e-9, err_msg=f"{name} {key}")

    def test_bodies_leave_through_open_sides(self):
        # One after the other: an elastic body flows out and what is left of it at the side is taken out, a membrane leaves whole. As
        # on the grid, whoever owns it, and if the run goes on from a checkpoint while the first one is half out.
        scene = ("-grid_cells 40,24,1 -grid_length 2,1.2,1 -boundary_xmin inflow -boundary_xmax outflow -boundary_y wall "
                 "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -initial_velocity uniform -initial_velocity_mean 1,0,0 "
                 "-time_step .01 -pressure_solver smac -cell_semi_axes .2,.2,.2").split()
        rows = [(1.65, .6, 0), (.6, .55, 0)]  # so far apart that their smoothed surfaces do not meet
        for name, kind, steps in ("solids", [], 50), ("membranes", MEMBRANE, 24):
            boxes = self.same_on_ranks(rows, *scene, *kind, steps=steps, prefix=f"{name}_")
            grid = self.same_on_ranks(rows, *scene, *kind, "-cell_contact", "merge", steps=steps, ranks=(1,), restart=False,
                                      prefix=f"{name}_grid_")
            self.assertEqual(boxes.summary["bodies"][0]["volume"], 0)
            self.assertGreater(boxes.summary["bodies"][1]["volume"], .1)
            for column in boxes.series.dtype.names:
                ours, theirs = (getattr(run.series, column) for run in (boxes, grid))
                numpy.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6 * abs(theirs).max() + 1e-7, err_msg=f"{name} {column}")

    def test_a_thousand_bodies(self):
        places = [(x + .5, y + .5, z + .5) for x in range(10) for y in range(10) for z in range(10)]
        one = self.same_on_ranks(places, *"-grid_cells 30,30,30 -grid_length 10,10,10".split(), *STIRRED,
                                 *"-cell_semi_axes .4,.3,.4".split(), steps=2, ranks=(1, 4), restart=False)
        with h5py.File(one.directory / "bodies.h5") as bodies:
            self.assertEqual(bodies["volume"].shape[1], 1000)
            numpy.testing.assert_allclose(bodies["volume"][-1], 4 / 3 * numpy.pi * .4 * .3 * .4, rtol=.01)

    def test_bodies_that_go_around(self):
        # Ten times over the edges of four ranks and of the periodic box: what is measured does not jump.
        one = self.same_on_ranks([(.3, .5, 0), (.8, .9, 0)], *("-grid_cells 16,16,1 -grid_length 1,1,1 -initial_velocity uniform "
                                 "-initial_velocity_mean .2,1,0 -cell_semi_axes .14,.14,.14 -time_step .02").split(), steps=130)
        for body, start in zip(one.summary["bodies"], ((.3, .5), (.8, .9))):
            numpy.testing.assert_allclose(body["centroid"][:2], numpy.add(start, (.2 * 2.6, 2.6)), atol=.02)  # a third of a cell
            self.assertAlmostEqual(body["volume"], numpy.pi * .14**2, delta=1e-5)

    def test_snapshots_show_them_all(self):
        # phi of the snapshot is the sum over the bodies, and their labels, volumes and B come back from a file.
        scene = ("-grid_cells 24,24,1 -grid_length 1.2,1.2,1 -snapshot_interval .02 -snapshot_precision double -cell_semi_axes .2,.2,.2 "
                 "-cell_initial_stretch 1.2,.83333333,1").split()
        scene += ["-snapshot_fields", "solid_fraction,left_cauchy_green,body,velocity"]
        one = self.same_on_ranks([(.3, .6, 0), (.72, .6, 0)], *scene)
        with h5py.File(one.directory / "snapshot_000000.h5") as file:
            phi, body = file["solid_fraction"][...].squeeze(), file["body"][...].squeeze()
        self.assertEqual(set(body[phi > .5]), {1, 2})
        for label in 1, 2:
            self.assertAlmostEqual(phi[body == label].sum() * .05**2, numpy.pi * .04, delta=2e-3)
        words = ALL[:ALL.index("-cell_shape")] + [*ELASTIC, *scene[:4], "-time_steps_max", 1, "-initial_state",
                                                  one.directory / "snapshot_000000.h5"]
        again = self.run_together({"again1": (words, {"ranks": 1}), "again3": (words, {"ranks": 3})})
        self.assertEqual(again["again1"].summary["state_hash"], again["again3"].summary["state_hash"])
        first = lambda run: run.bodies.elastic_energy[0]
        numpy.testing.assert_allclose(first(again["again1"]), first(one), rtol=1e-3)


if __name__ == "__main__":
    unittest.main()

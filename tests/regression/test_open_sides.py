#!/usr/bin/python3
"""Inflow, pressure and outflow sides: a published flow, what comes in goes out, the same on any ranks and after a restart."""
import pathlib
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from many_runs import Plan  # noqa: E402
from scene_case import BINARY, SceneCase  # noqa: E402

# Two ways in, one of them a pulse, two ways out, and walls that hold the fluid: in 2-D and in 3-D.
FLAT = ("-grid_cells 50,34,1 -grid_length 5,3.4,1 -boundary_xmin inflow -boundary_xmax outflow -boundary_ymin wall "
        "-boundary_ymax pressure -boundary_xmin_velocity 1 -boundary_xmin_angular_frequency 3 -fluid_viscosity 0.05").split()
DEEP = ("-grid_cells 20,12,14 -grid_length 2,1.2,1.4 -boundary_xmin inflow -boundary_xmax outflow -boundary_y wall "
        "-boundary_z wall -boundary_zmax pressure -boundary_xmin_velocity 1 -boundary_xmin_profile developed "
        "-boundary_xmin_angular_frequency 3 -fluid_viscosity 0.05 -boundary_zmax_pressure .2 -boundary_zmax_windkessel 1,.1,2").split()


def points_of_zero(x, values):
    """Where the values, linear between the points x, change their sign."""
    at = numpy.nonzero(values[1:-1] * values[2:] < 0)[0] + 1
    return x[at] - values[at] * (x[at + 1] - x[at]) / (values[at + 1] - values[at])


class OpenSides(SceneCase):
    def test_same_on_any_ranks_and_threads_and_after_a_restart(self):
        scenes = {f"{name}_{solver}": ([*scene, "-pressure_solver", solver, "-time_end", end], end)
                  for name, scene, end in (("flat", FLAT, ".6"), ("deep", DEEP, ".2")) for solver in ("acm", "smac")}
        runs = {}
        for name, (options, end) in scenes.items():
            runs[name] = options, {}
            for ranks in (2, 3, 4):
                runs[f"{name}_{ranks}"] = options, {"ranks": ranks}
            runs[f"{name}_threads"] = [*options, "-threads", "2"], {}
            runs[f"{name}_half"] = [*options, "-time_steps_max", "20", "-checkpoint_interval", end], {}
        runs = self.run_together(runs)
        rests = self.run_together({f"{name}_rest": ([*options, "-restart", self.room / f"{name}_half"], {"ranks": 2})
                                   for name, (options, _) in scenes.items()})
        for name in scenes:
            one = runs[name].summary
            for way in ("2", "3", "4", "threads"):
                other = runs[f"{name}_{way}"].summary
                self.assertEqual((other["state_hash"], other["sides"]), (one["state_hash"], one["sides"]), (name, way))
            self.assertEqual(rests[f"{name}_rest"].summary["state_hash"], one["state_hash"])

    def test_what_comes_in_goes_out(self):
        for scene in (FLAT, DEEP):
            for options in (("-method", "fast"), ("-pressure_solver", "smac"), ("-pressure_solver", "ksp")):
                run = self.run_program("_".join(options) + str(len(scene)), *scene, *options, "-time_end", ".3")
                rates = [numpy.asarray(run.series[name]) for name in run.series.dtype.names if name.startswith("flow_rate_")]
                self.assertEqual(len(rates), 3)
                largest = max(abs(rate).max() for rate in rates)
                self.assertLess(abs(sum(rates)).max(), (1e-5 if "fast" in options else 1e-9) * largest, options)

    def test_developed_flow_stays_as_it_is(self):
        """In a duct, to round-off: the profile is the discrete one. The flow rate of a square duct to second order."""
        scene = ("-grid_length 2,1,1 -boundary_xmin inflow -boundary_xmax outflow -boundary_y wall -boundary_z wall "
                 "-boundary_xmin_profile developed -boundary_xmin_flow_rate 2 -fluid_viscosity 1 -pressure_solver smac "
                 "-time_end 2 -time_step .01 -snapshot_interval 2 -snapshot_precision double").split()
        error = []
        for n in (8, 16):
            run = self.run_program(f"duct{n}", *scene, "-grid_cells", f"8,{n},{n}")
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                u, p = file["velocity_x"][:], file["pressure"][:]
            self.assertLess(abs(u[:, :, :8] - u[:, :, :1]).max(), 1e-10)
            gradient = (p[n // 2, n // 2, 2] - p[n // 2, n // 2, 6]) / (4 * .25)
            error.append(abs(2 * 28.454 / gradient - 1))  # Q = G/(28.454 mu) for a unit square
        self.assertLess(error[1], 2e-2)
        self.assertGreater(numpy.log2(error[0] / error[1]), 1.9)

    def test_a_disc_leaves(self):
        """It flows out, and a channel height upstream nobody notices, at any time: against a box twice as long. A body that
        starts there is refused, one without labels stops the run."""
        scene = ("-boundary_y wall -boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity 1 -boundary_xmin_profile "
                 "developed -initial_velocity poiseuille -initial_velocity_amplitude 1.5 -fluid_viscosity .1 -species disc "
                 "-disc_shape sphere -disc_radius .2 -disc_shear_modulus 2 -snapshot_interval .1 -time_end 1.6 "
                 "-snapshot_precision double -pressure_solver smac").split()
        box, there = {n: f"-grid_cells {80 * n},32,1 -grid_length {2.5 * n},1,1".split() for n in (1, 2)}, "-disc_centre"
        velocity = {}
        for n in (1, 2):
            run = self.run_program(f"disc{n}", *scene, *box[n], there, ".8,.45,0")
            volume, front = run.bodies.volume[:, 0], run.bodies.centroid[:, 0, 0] + .25
            self.assertLess(abs(volume[front < 2.4] / volume[0] - 1).max(), 1e-3)
            self.assertLess(run.summary["volume_drift"], 1e-3)
            self.assertEqual(volume[-1] == 0, n == 1)
            if n == 1:
                self.assertLess(numpy.diff(volume).max(), 1e-6 * volume[0])
                self.assertGreater(((volume > .1 * volume[0]) & (volume < .9 * volume[0])).sum(), 20)
            velocity[n] = []
            for snapshot in range(17):
                with h5py.File(run.directory / f"snapshot_{snapshot:06d}.h5") as file:
                    velocity[n].append([file[f"velocity_{c}"][0, :32, :48] for c in "xy"])
        noticed = abs(numpy.array(velocity[1]) - numpy.array(velocity[2])).max()
        print(f"    {noticed:.2e}")
        self.assertLess(noticed, 1e-3)
        for extra in ((), ("-method", "classic", "-guard_divergence", "0", "-guard_mach", "0")):
            options = [*scene[:-1], "acm", *box[1], there, "2,.45,0", *extra]  # ends when half of it is out
            options[options.index("1.6")] = ".3"
            runs = self.run_together({f"ranks{ranks}{len(extra)}": (options, {"ranks": ranks}) for ranks in (1, 2, 3)} |
                                     {f"half{len(extra)}": ([*options, "-time_steps_max", "45", "-checkpoint_interval", "1"], {})})
            hashes = {runs[f"ranks{ranks}{len(extra)}"].summary["state_hash"] for ranks in (1, 2, 3)}
            hashes.add(self.run_program(f"rest{len(extra)}", *options, "-restart", self.room / f"half{len(extra)}",
                                        ranks=2).summary["state_hash"])
            self.assertEqual(len(hashes), 1)
        for code, says, options in ((2, "accepted: bodies that stay further inside", (there, "2.3,.45,0")),
                                    (3, "a body is within 2 cells of the open boundary xmax", (there, ".8,.45,0", "-body_series", "false"))):
            done = subprocess.run([BINARY, *scene, *box[1], *options, "-output_dir", self.room / f"refused{code}"],
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(says, done.stderr)

    def test_a_mirrored_disc_leaves_alike(self):
        """Through the other end of the channel, its force on the side included, to the bit."""
        fields = []
        for out, into, x, force in (("xmax", "xmin", ".8", ".5,.2,0"), ("xmin", "xmax", ".45", "-.5,.2,0")):
            run = self.run_program(out, *(
                f"-grid_cells 40,32,1 -grid_length 1.25,1,1 -boundary_y wall -boundary_{into} inflow -boundary_{out} outflow "
                f"-boundary_{into}_velocity 1 -boundary_{into}_profile developed -fluid_viscosity .1 -species disc -disc_shape sphere "
                f"-disc_radius .15 -disc_shear_modulus 2 -disc_centre {x},.45,0 -disc_body_force {force} -pressure_solver smac "
                "-time_end .3 -snapshot_interval .3 -snapshot_precision double").split())
            self.assertTrue(.1 < run.bodies.volume[-1, 0] / run.bodies.volume[0, 0] < .9)
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                fields.append([file[name][0] for name in ("velocity_x", "velocity_y", "solid_fraction")])
        one, other = fields
        self.assertEqual(abs(one[0][:, 1:] + other[0][:, :0:-1]).max(), 0)
        for n in (1, 2):
            self.assertEqual(abs(one[n] - other[n][:, ::-1]).max(), 0)

    def test_others_leave_whole(self):
        """Drops, membranes, and what has a viscosity of its own, are taken out when they come to the side."""
        for extra in ("-disc_surface_tension 1 -disc_shear_modulus 0", "-disc_shear_modulus 2 -disc_viscosity .3",
                      "-disc_law membrane -disc_surface_shear_modulus .1"):
            run = self.run_program(extra.split()[0][6:], *(
                "-grid_cells 40,32,1 -grid_length 1.25,1,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax outflow "
                "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -fluid_viscosity .1 -species disc -disc_shape sphere "
                f"-disc_radius .15 -disc_centre .9,.45,0 -time_end .2 {extra}").split())
            volume = run.bodies.volume[:, 0]
            self.assertEqual(volume[-1], 0)
            self.assertAlmostEqual(volume[volume > 0].min() / volume[0], 1, delta=.02)

    def test_what_is_rigid_stays(self):
        """A post beside the outlet is there when a disc has left."""
        run = self.run_program("post", *(
            "-grid_cells 48,32,1 -grid_length 1.5,1,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax outflow "
            "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -fluid_viscosity .1 -species disc,post -disc_shape sphere "
            "-disc_radius .15 -disc_shear_modulus 2 -disc_centre 1.1,.4,0 -post_shape sphere -post_radius .1 -post_law rigid "
            "-post_centre 1.38,.88,0 -snapshot_interval .4 -time_end .4").split())
        self.assertEqual([run.bodies.volume[-1, b] == 0 for b in (0, 1)], [True, False])
        self.assertEqual(run.bodies.volume[-1, 1], run.bodies.volume[0, 1])

    def test_viscosity_that_hardly_varies_is_one_that_does_not(self):
        """Two forms of the viscous force beside each kind of side: they differ by the error of a time step, of second order,
        where the systems of the implicit one are solved far below it."""
        scene = [*DEEP, *("-species ball -ball_shape sphere -ball_radius .3 -ball_centre .8,.6,.7 "
                          "-ball_shear_modulus 1 -time_end .2 -snapshot_interval .2 -snapshot_precision double "
                          "-interface_scheme plic -pressure_solver smac -viscous_tolerance 1e-6").split()]
        largest = {}
        for steps in (20, 40):
            velocity = {}
            for mu in (".05", ".050000005"):
                run = self.run_program(f"{steps}_{mu}", *scene, "-ball_viscosity", mu, "-time_step", str(.2 / steps))
                with h5py.File(run.directory / "snapshot_000001.h5") as file:
                    velocity[mu] = numpy.stack([file[f"velocity_{c}"][...] for c in "xyz"])
            largest[steps] = abs(velocity[".05"] - velocity[".050000005"]).max() / abs(velocity[".05"]).max()
        print(f"    {largest[20]:.2e} {largest[40]:.2e}")
        self.assertLess(largest[40], 3e-4)
        self.assertGreater(largest[20] / largest[40], 3)

    def test_rigid_tube_from_an_inlet_to_an_outlet(self):
        """What comes in is the flow that the tube has: it stays as it is along it, and pressure falls as Poiseuille says. With a
        load at the outlet, too; the same on any ranks and after a restart."""
        radius, length = .385, .7
        scene = (f"-grid_cells 14,20,20 -grid_length {length},1,1 -boundary_xmin inflow -boundary_xmax pressure "
                 "-boundary_xmin_profile developed -boundary_xmin_flow_rate .1 -species pipe -pipe_shape tube -pipe_axis x "
                 f"-pipe_law rigid -pipe_radius {radius} -pipe_centre 0,0.513,0.487 -time_step .01 -snapshot_precision double").split()
        drop = .1 * 8 * length / (numpy.pi * radius**4)
        for solver in ("acm", "smac"):
            run = self.run_program(solver, *scene, "-pressure_solver", solver, "-time_end", ".5", "-snapshot_interval", ".5",
                                   "-boundary_xmax_resistance", "30")
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                u = file["velocity_x"][...]
            self.assertLess(abs(u - u[:, :, :1]).max() / u.max(), 5e-4)
            inlet, outlet = run.summary["sides"]
            self.assertAlmostEqual(outlet["flow_rate"], -.1, delta=1e-7)
            self.assertAlmostEqual(outlet["pressure"], 3, delta=1e-6)
            self.assertAlmostEqual((inlet["pressure"] - outlet["pressure"]) / drop, 1, delta=.02)
            first = [*scene, "-pressure_solver", solver, "-boundary_xmax_resistance", "30", "-time_end", ".5", "-time_steps_max"]
            runs = self.run_together({f"{solver}{ranks}": ([*first, "12"], {"ranks": ranks}) for ranks in (1, 2, 3)} |
                                     {f"{solver}_half": ([*first, "6", "-checkpoint_interval", ".5"], {})})
            rest = self.run_program(f"{solver}_rest", *first, "12", "-restart", self.room / f"{solver}_half", ranks=2)
            for other in (runs[f"{solver}2"], runs[f"{solver}3"], rest):
                self.assertEqual(other.summary["state_hash"], runs[f"{solver}1"].summary["state_hash"])

    def test_velocity_of_an_inlet_is_that_of_its_open_part(self):
        """In a rigid tube the flow rate is that velocity times the section of the lumen; in a box without bodies, of the side."""
        scene = ("-grid_cells 12,24,24 -grid_length 1.2,2.4,2.4 -boundary_xmin inflow -boundary_xmax outflow -fluid_viscosity 1 "
                 "-boundary_xmin_velocity .3 -time_end .05 -boundary_xmin_profile").split()
        tube = "-species pipe -pipe_shape tube -pipe_axis x -pipe_law rigid -pipe_radius .81 -pipe_centre 0,1.23,1.18".split()
        runs = self.run_together({"developed": ([*scene, "developed", *tube], {}), "uniform": ([*scene, "uniform", *tube], {}),
                                  "ranks": ([*scene, "developed", *tube], {"ranks": 3}),
                                  "box": ([*scene, "uniform", "-boundary_y", "wall", "-boundary_z", "wall"], {})})
        for name, area in (("developed", numpy.pi * .81 ** 2), ("uniform", numpy.pi * .81 ** 2), ("box", 2.4 ** 2)):
            self.assertAlmostEqual(runs[name].series.flow_rate_xmin[-1] / (.3 * area), 1, delta=1e-3, msg=name)
        self.assertEqual(runs["ranks"].summary["state_hash"], runs["developed"].summary["state_hash"])

    def test_lumens_are_told_alike_before_and_at_the_start(self):
        """On any ranks, of the voxels of a vessel as of its shape; what is doubtful is warned of."""
        y, z = (numpy.arange(24) + .5) / 10 - 1.2, (numpy.arange(24) + .5)[:, None] / 10 - 1.2
        with h5py.File(self.room / "wall.h5", "w") as file:
            file["wall"] = numpy.repeat((numpy.hypot(y, z) > .3)[:, :, None], 12, axis=2).astype("u1")
        scene = ("-grid_cells 12,24,24 -grid_length 1.2,2.4,2.4 -boundary_xmin inflow -boundary_xmax outflow -fluid_viscosity 1e-5 "
                 f"-boundary_xmin_flow_rate .4 -time_end 1e-6 -species pipe -pipe_law rigid -pipe_shape voxels "
                 f"-pipe_voxels {self.room}/wall.h5").split()
        area, across = .01 * (numpy.hypot(y, z) < .3).sum(), (abs(y) < .3).sum()
        plan = Plan(self.room)
        for ranks in (1, 3):
            plan.add(f"run{ranks}", *scene, ranks=ranks)
            plan.add(f"check{ranks}", *scene, "-check_only", ranks=ranks, output=False)
        said = {}
        for name, outcome in plan.execute().items():
            self.assertEqual(outcome.code, 0, outcome.err)
            said[name] = ([line for line in outcome.out.splitlines() if line.startswith("boundary ")],
                          sorted(line.split("warning: ")[1] for line in (outcome.out + outcome.err).splitlines() if "warning: " in line))
        self.assertEqual(len({str(lines) for lines in said.values()}), 1, said)
        sides, warnings = said["run1"]
        self.assertIn(f"boundary xmin: inflow, open area {area:.4g} of 5.76, lumen {across / 10:.4g} wide, {across} cells across; mean velocity "
                      f"{.4 / area:.4g}, flow rate 0.4 into the box, Reynolds number of the lumen {.4 / area * across * 1e4:.3g}", sides)
        self.assertEqual([w.split(":")[0] for w in warnings], ["-boundary_xmax"] * 2 + ["-boundary_xmin"] * 2)

    def test_inlet_that_a_rigid_body_covers(self):
        done = subprocess.run([BINARY, *("-grid_cells 16,16,1 -boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity 1 "
                                         "-species plug -plug_shape slab -plug_axis x -plug_interval 0,.2 -plug_law rigid "
                                         "-time_end 1").split(), "-output_dir", self.room / "plug"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("-boundary_xmin: rigid bodies cover all of this", done.stderr)

    def test_ways_out_of_an_inlet(self):
        """Through voxels, across the seam in z, and on any ranks: as far as faces are open. Pressures alone are warned of."""
        wall = numpy.zeros((8, 12, 12), "u1")
        wall[:, :, 4:8] = 1  # across the box
        wall[0, :, 4:6] = wall[7, :, 5:8] = 0  # two halves of a way, which meet across the seam
        shut = wall.copy()
        shut[0, :, 4:6] = shut[7, :, 5] = 1  # two cells: a face is closed if more than half of both its cells is solid
        plan = Plan(self.room)
        for name, values in (("wall", wall), ("shut", shut)):
            with h5py.File(self.room / f"{name}.h5", "w") as file:
                file["wall"] = values
            scene = ("-grid_cells 12,12,8 -boundary_x wall -boundary_y wall -boundary_xmax outflow -time_end 1 -species pipe "
                     f"-pipe_law rigid -pipe_shape voxels -pipe_voxels {self.room}/{name}.h5 -boundary_xmin").split()
            for ranks in (1, 3):
                plan.add(f"inflow_{name}_{ranks}", *scene, "inflow", "-boundary_xmin_velocity", "1", "-check_only", ranks=ranks, output=False)
                plan.add(f"pressure_{name}_{ranks}", *scene, "pressure", "-check_only", ranks=ranks, output=False)
        for name, outcome in plan.execute().items():
            error = "-boundary_xmin: rigid bodies cut this inflow boundary off from all boundaries through which"
            warning = "warning: -boundary_xmin: rigid bodies cut this boundary off from all others"
            self.assertEqual((outcome.code, error in outcome.err, warning in outcome.out),
                             (2 * ("inflow_shut" in name), "inflow_shut" in name, "pressure_shut" in name), (name, outcome.out, outcome.err))

    def test_profile_from_hdf5(self):
        """As the same numbers from a text, on each side that has other directions; vectors point into the box or out of it."""
        numbers = numpy.random.default_rng(1).uniform(.5, 1.5, (14, 12))
        text, plain, vectors = (self.room / name for name in ("profile.txt", "plain.h5", "vectors.h5"))
        numpy.savetxt(text, numbers)
        with h5py.File(plain, "w") as file:
            file["velocity"] = numbers
        for side, component, sign, grid in (("xmin", 0, 1, "8,12,14"), ("ymax", 1, -1, "12,8,14"), ("zmax", 2, -1, "12,14,8")):
            with h5py.File(vectors, "w") as file:
                file["velocity"] = numpy.stack([sign * numbers if c == component else 7 + numbers for c in range(3)], axis=-1)
            other = side[0] + ("min" if side.endswith("max") else "max")
            scene = (f"-grid_cells {grid} -boundary_{side} inflow -boundary_{other} pressure -fluid_viscosity .1 "
                     "-time_end .01").split()
            runs = self.run_together({f"{side}_{path.stem}{ranks}": ([*scene, f"-boundary_{side}_profile", path], {"ranks": ranks})
                                      for path, ranks in ((text, 1), (plain, 1), (plain, 2), (vectors, 1), (vectors, 3))})
            self.assertEqual(len({run.summary["state_hash"] for run in runs.values()}), 1, side)

    def test_profiles_that_are_refused(self):
        def file_of(name, **datasets):
            with h5py.File(self.room / name, "w") as file:
                for key, values in datasets.items():
                    file[key] = values
            return self.room / name

        cut = file_of("cut.h5", velocity=numpy.ones((14, 12)))
        cut.write_bytes(cut.read_bytes()[:600])
        wrong = {file_of("turned.h5", velocity=numpy.ones((12, 14))): "has the shape (12, 14); accepted: (14, 12) or (14, 12, 3)",
                 file_of("two.h5", velocity=numpy.ones((14, 12, 2))): "has the shape (14, 12, 2); accepted",
                 file_of("nan.h5", velocity=numpy.full((14, 12), numpy.nan)): "values that are not finite",
                 file_of("none.h5", u=numpy.ones((14, 12)), v=numpy.ones((14, 12))): "has several datasets; accepted: ",
                 file_of("words.h5", velocity=numpy.full((14, 12), b"a")): "dataset velocity has no numbers",
                 file_of("zero.h5", velocity=numpy.zeros((14, 12))): "its mean is 0", cut: "is damaged or truncated"}
        for path, says in wrong.items():
            done = subprocess.run([BINARY, *("-grid_cells 8,12,14 -boundary_xmin inflow -boundary_xmax pressure -time_end 1 "
                                             "-boundary_xmin_profile").split(), path, "-output_dir", self.room / "wrong"],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertIn("-boundary_xmin_profile: ", done.stderr)

    def test_resistances_share_the_flow(self):
        """Far above that of the box they share it 3 to 1, whatever the time step; the pressures are those of the flow rates."""
        scene = ("-grid_cells 24,16,1 -grid_length 3,1,1 -fluid_viscosity .1 -boundary_ymax wall -boundary_ymin inflow "
                 "-boundary_xmin pressure -boundary_xmax pressure -boundary_ymin_velocity .5 -time_end 1").split()
        for solver in ("acm", "smac"):
            for resistance in (1e3, 1e5):
                sides = self.run_program(f"{solver}{resistance}", *scene, "-pressure_solver", solver,
                                         "-boundary_xmin_resistance", f"{resistance}", "-boundary_xmax_resistance",
                                         f"{3 * resistance}").summary["sides"]
                out = {side["side"]: -side["flow_rate"] for side in sides}
                self.assertAlmostEqual(out["xmin"] + out["xmax"], 1.5, delta=1e-5)
                self.assertAlmostEqual(out["xmin"] / out["xmax"], 3, delta=20 / resistance)
                self.assertAlmostEqual(sides[0]["pressure"] / resistance, out["xmin"], delta=1e-5)

    def test_windkessel_fills(self):
        """p = Q (R + R' (1 - exp(-t/(R' C)))) at the time of the row, for a flow that is given."""
        run = self.run_program("windkessel", *("-grid_cells 24,16,1 -grid_length 3,1,1 -fluid_viscosity .1 -boundary_y wall "
                                               "-boundary_xmin inflow -boundary_xmax pressure -boundary_xmin_velocity .5 "
                                               "-boundary_xmax_windkessel 2,.3,5 -time_end 3 -time_step .02").split())
        exact = .5 * (2 + 5 * (1 - numpy.exp(-run.series.time / 1.5)))
        self.assertLess(abs(run.series.pressure_xmax - exact)[5:-1].max(), 2e-4)  # the last one is that of half a step before

    def test_windkessel_of_any_stiffness(self):
        """A small capacity is the resistance behind it; a large one is a pressure that stays; both with a drain of any size."""
        scene = ("-grid_cells 24,12,1 -grid_length 2,1,1 -boundary_ymin wall -boundary_ymax pressure -boundary_xmin inflow "
                 "-boundary_xmax pressure -boundary_xmin_profile developed -fluid_viscosity .1 -boundary_xmin_velocity 1 -time_end .5 "
                 "-series_interval 1e-9 -boundary_ymax_resistance 5").split()
        loads = {"resistance": "-boundary_xmax_resistance 5", "open": "-boundary_xmax_pressure 0",
                 **{f"small{n}": f"-boundary_xmax_windkessel 0,1e-{n},5" for n in (12, 6, 4)},
                 "no_capacity": "-boundary_xmax_windkessel 2,0,3", "no_drain": "-boundary_xmax_windkessel 0,1,0",
                 "large": "-boundary_xmax_windkessel 0,1e6,5", "charged": "-boundary_xmax_windkessel 0,1e6,5 "
                 "-boundary_xmax_windkessel_initial_pressure 3", "given": "-boundary_xmax_pressure 3",
                 "closed": "-boundary_xmax_windkessel 0,1e-12,1e12", "stiff": "-boundary_xmax_windkessel 1e6,1e-6,1e6"}
        runs = self.run_together({name: ([*scene, *load.split()], {}) for name, load in loads.items()})
        flow = {name: -numpy.asarray(run.series.flow_rate_xmax)[20:] for name, run in runs.items()}
        pressure = {name: numpy.asarray(run.series.pressure_xmax)[20:] for name, run in runs.items()}
        for name, same in (("small12", "resistance"), ("small6", "resistance"), ("small4", "resistance"), ("large", "open"),
                           ("charged", "given")):
            self.assertLess(abs(flow[name][-1] - flow[same][-1]), 2e-3, name)
            self.assertLess(abs(numpy.diff(flow[name])).max(), 2 * abs(numpy.diff(flow[same])).max() + 1e-4, name)
            self.assertLess(abs(pressure[name][-1] - pressure[same][-1]), .05, name)
        for name, same in (("no_capacity", "resistance"), ("no_drain", "open")):
            numpy.testing.assert_array_equal(flow[name], flow[same], name)
        for name in ("closed", "stiff"):
            self.assertLess(abs(flow[name]).max(), 2e-5, name)

    def test_backward_facing_step(self):
        """Gartling (1990), Re 800: the lower eddy ends at 6.10, the upper one lies between 4.85 and 10.48 channel heights; a coarse
        grid. Cut through the upper eddy, where the flow turns back on the outlet, the lower one stays."""
        n = 24
        y = (numpy.arange(n) + .5) / n
        profile = self.room / "profile.txt"
        numpy.savetxt(profile, numpy.where(y > .5, (y - .5) * (1 - y), 0))
        ends = {}
        for length in (15, 8):
            run = self.run_program(f"step{length}", "-grid_cells", f"{length * n},{n},1", "-grid_length", f"{length},1,1",
                                   *("-boundary_y wall -boundary_xmin inflow -boundary_xmax outflow "
                                     "-boundary_xmin_flow_rate .5 -fluid_viscosity 1.25e-3 -time_end 200 "
                                     "-snapshot_interval 200").split(), "-boundary_xmin_profile", profile)
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                u = file["velocity_x"][0]
            x = numpy.arange(u.shape[1]) / n
            ends[length] = [*points_of_zero(x, u[0])[-1:], *points_of_zero(x, u[-1])]
            print(f"    length {length}:", ", ".join(f"{end:.3f}" for end in ends[length]))
        for found, published in zip(ends[15], (6.10, 4.85, 10.48)):
            self.assertAlmostEqual(found / published, 1, delta=.08)
        self.assertAlmostEqual(ends[8][0] / ends[15][0], 1, delta=2e-3)


if __name__ == "__main__":
    unittest.main()

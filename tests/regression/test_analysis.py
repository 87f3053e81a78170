"""What the Python package computes from a run, against exact values: averages with standard errors, pressure drop, apparent
viscosity, averages of wall shear stress, the cell-free layer, arrays over time, curves of several runs; files as the program
reads them; and where h5py comes from. Needs EULASTIC."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True
import eulastic  # noqa: E402
import synthetic_run  # noqa: E402

CHANNEL = ("-grid_cells 4,32,1 -grid_length .25,2,1 -boundary_y wall -fluid_viscosity 1.5 -fluid_density 2 -body_force .003,0,0 "
           "-time_step .25 -time_end 20 -series_interval 1 -profile_y mean -profile_interval 5 -pressure_solver smac").split()


class WithRoom(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def solve(self, name, *words):
        done = subprocess.run([os.environ["EULASTIC"], *words, "-output_dir", self.room / name], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return eulastic.read(self.room / name)

    def write(self, options, times=(0.0,), **fields):
        """A run whose snapshots hold these fields, functions of time."""
        folder = self.room / "written"
        folder.mkdir(exist_ok=True)
        (folder / "options.txt").write_text(options)
        for n, time in enumerate(times):
            with h5py.File(folder / f"snapshot_{n:06}.h5", "w") as file:
                file.attrs["time"] = [time]
                for name, values in fields.items():
                    file[name] = values(time)
        return eulastic.read(folder)


class TimeAverages(unittest.TestCase):
    def test_mean_is_an_integral(self):
        average = eulastic.time_average([0, 1, 2, 3, 4], [0, 1, 4, 9, 16])
        self.assertEqual(average.mean, (0 / 2 + 1 + 4 + 9 + 16 / 2) / 4)
        self.assertEqual(eulastic.time_average([0, 1, 2, 3, 4], [9, 9, 1, 3, 5], since=2, until=4).mean, 3)
        self.assertEqual(eulastic.time_average([7], [2.5])[0], 2.5)
        with self.assertRaisesRegex(ValueError, "no row between 5 and inf"):
            eulastic.time_average([1, 2], [1, 2], since=5)

    def test_standard_error_of_independent_rows(self):
        """Rows that alternate count as independent, no more: sigma / sqrt(n - 1)."""
        average = eulastic.time_average(numpy.arange(100), numpy.tile([1.0, -1.0], 50))
        self.assertAlmostEqual(average.standard_error, 1 / numpy.sqrt(99), places=12)
        self.assertEqual(average.independent, 100)
        self.assertEqual(eulastic.time_average(numpy.arange(10), numpy.ones(10)).standard_error, 0)

    def test_standard_error_of_correlated_rows(self):
        """x' = a x + noise is correlated over (1 + a)/(1 - a) rows, and its mean over n of them varies accordingly."""
        a, n = 0.8, 2000
        random = numpy.random.default_rng(5)
        found, means = [], []
        for _ in range(200):
            noise = random.normal(size=n + 200)
            x = numpy.zeros(n + 200)
            for k in range(1, len(x)):
                x[k] = a * x[k - 1] + noise[k]
            average = eulastic.time_average(0.5 * numpy.arange(n), x[200:])
            found.append(average)
            means.append(average.mean)
        exact = numpy.sqrt((1 + a) / (1 - a) / (1 - a * a) / n)
        self.assertAlmostEqual(numpy.mean([f.standard_error for f in found]) / exact, 1, delta=0.05)
        self.assertAlmostEqual(numpy.std(means) / exact, 1, delta=0.15)
        self.assertAlmostEqual(numpy.mean([f.correlation_time for f in found]) / (0.5 * 9), 1, delta=0.1)

    def test_a_flow_that_still_develops_has_no_standard_error(self):
        time = numpy.linspace(0, 1, 50)
        self.assertTrue(numpy.isnan(eulastic.time_average(time, numpy.exp(time)).standard_error))
        self.assertTrue(numpy.isnan(eulastic.time_average([0, 1, 2], [1, 2, 1]).standard_error))


class Channels(WithRoom):
    def test_a_plane_channel(self):
        """u = f (y (H - y) + h^2/4)/(2 nu) solves the scheme with walls half a cell away: its mean is that of Poiseuille's flow
        times 1 + 2 (h/H)^2."""
        run = self.solve("channel", *CHANNEL)
        drop, viscosity = eulastic.pressure_drop(run), eulastic.apparent_viscosity(run)
        numpy.testing.assert_allclose(drop, 2 * 0.003 * 0.25, rtol=1e-12)
        self.assertEqual((len(viscosity), viscosity[0]), (len(run.series), 0))
        self.assertAlmostEqual(viscosity[-1] / (1.5 / (1 + 2 / 32**2)), 1, delta=1e-9)
        rows = eulastic.over_time(run.profile["y"])
        numpy.testing.assert_allclose(rows.time, [0, 5, 10, 15, 20])
        self.assertEqual(rows.velocity_x.shape, (5, 32))
        exact = 0.003 * 2 / 1.5 / 2 * (rows.y * (2 - rows.y) + (2 / 32)**2 / 4)
        numpy.testing.assert_allclose(rows.velocity_x[-1], exact, rtol=1e-9)
        numpy.testing.assert_array_equal(rows.velocity_x[0], 0)
        cut = eulastic.over_time(run.profile["y"][:-3])  # the last time is not complete
        self.assertEqual((len(cut.time), cut.velocity_x.shape), (4, (4, 32)))

    def test_half_a_channel(self):
        words = [word for word in CHANNEL if word not in ("-boundary_y", "wall")]
        run = self.solve("half", *words[:1], "4,16,1", *words[2:3], ".25,1,1", *words[4:], *"-boundary_ymin wall -boundary_ymax symmetry".split())
        self.assertAlmostEqual(eulastic.apparent_viscosity(run)[-1] / (1.5 / (1 + 2 / 32**2)), 1, delta=1e-9)

    def test_a_channel_between_slabs(self):
        """The same flow as between walls of the box, 2 high, in a box that is 2.5 or, periodic, 3 high."""
        slabs = "-species low,high -low_shape slab -low_axis y -low_law rigid -high_shape slab -high_axis y -high_law rigid".split()
        words = " ".join(CHANNEL)
        for name, cells, height, intervals in (("walls", 40, 2.5, (0, .25, 2.25, 2.5)), ("middle", 48, 3, (0, .5, 2.5, 3))):
            options = words.replace("4,32,1", f"4,{cells},1").replace(".25,2,1", f".25,{height},1").split()
            if name == "middle":  # the channel is across the periodic side, the wall in the middle of the box
                options = [word for word in options if word not in ("-boundary_y", "wall")]
                intervals = (1, 1.5, 1.5, 2)
            run = self.solve(name, *options, *slabs, "-low_interval", "%g,%g" % intervals[:2], "-high_interval", "%g,%g" % intervals[2:])
            self.assertAlmostEqual(eulastic.apparent_viscosity(run)[-1] / (1.5 / (1 + 2 / 32**2)), 1, delta=1e-6)

    def test_a_tube_between_pressures(self):
        """In 2-D two rigid plates make the tube: the column of series.csv is Poiseuille's 3/2 / R^3."""
        run = self.solve("tube", *("-grid_cells 8,32,1 -grid_length .5,2,1 -boundary_xmin pressure -boundary_xmax pressure -boundary_y wall "
                                   "-boundary_xmin_pressure .4 -species vessel -vessel_shape tube -vessel_axis x -vessel_radius .75 "
                                   "-vessel_law rigid -fluid_viscosity 1 -time_step .1 -time_end 4 -pressure_solver smac").split())
        numpy.testing.assert_allclose(eulastic.pressure_drop(run), 0.4)
        viscosity = eulastic.apparent_viscosity(run)
        numpy.testing.assert_array_equal(viscosity, run.series.vessel_apparent_viscosity)
        self.assertAlmostEqual(viscosity[-1], 1, delta=0.02)
        self.assertAlmostEqual(viscosity[-1], 0.4 * 2 * 0.75**3 / (3 * 0.5 * run.series.vessel_flow_rate[-1]), places=12)

    def test_what_is_no_channel_is_refused(self):
        run = self.solve("box", *"-grid_cells 8,8,1 -body_force 1,0,0 -time_step .1 -time_end .2".split())
        with self.assertRaisesRegex(ValueError, "neither a tube .* nor a plane channel"):
            eulastic.apparent_viscosity(run)
        still = self.solve("still", *"-grid_cells 8,8,1 -boundary_y wall -time_step .1 -time_end .2".split())
        with self.assertRaisesRegex(ValueError, "neither a body force nor the pressure"):
            eulastic.apparent_viscosity(still)


class Walls(WithRoom):
    OPTIONS = "-grid_cells 4,4,1\n-grid_length 1,1,1\n-boundary_y wall\n"

    def test_shear_that_swings(self):
        """tau = a + b cos(2 pi t), over a period of 64 snapshots: mean a, TAWSS the mean of |tau|; swinging about 0, OSI 1/2."""
        times = numpy.arange(65) / 64
        swing = lambda t: numpy.cos(2 * numpy.pi * t)
        vector = lambda t: [3 + swing(t), 0, 0], lambda t: [swing(t), 0, 0], lambda t: [0, 0, 0], lambda t: [1 + 2 * swing(t), 0, 0]
        run = self.write(self.OPTIONS, times, wall_shear_stress_ymin=lambda t: numpy.array([[[v(t) for v in vector]]]))
        found = eulastic.wall_shear(run, "ymin")
        exact = 1 / 3 + 2 * numpy.sqrt(3) / numpy.pi  # of |1 + 2 cos|
        numpy.testing.assert_allclose(found.tawss[0, 0], [3, 2 / numpy.pi, 0, exact], rtol=2e-3)
        numpy.testing.assert_allclose(found.mean[0, 0, :, 0], [3, 0, 0, 1], atol=1e-12)
        numpy.testing.assert_allclose(found.osi[0, 0], [0, 0.5, numpy.nan, (1 - 1 / exact) / 2], atol=2e-3)
        early = eulastic.wall_shear(run, "ymin", until=0)
        numpy.testing.assert_allclose(early.tawss[0, 0], [4, 1, 0, 3])
        with self.assertRaisesRegex(ValueError, "no snapshot between 2 and inf"):
            eulastic.wall_shear(run, "ymin", since=2)

    def layer(self, options, cells, phi, **more):
        h = numpy.array([1.0, 1.0, 1.0]) / cells
        z, y, x = numpy.meshgrid(*((numpy.arange(n) + 0.5) * s for n, s in zip(cells[::-1], h[::-1])), indexing="ij")
        run = self.write(options, (0.0, 1.0), solid_fraction=lambda t: phi(x, y, z, t), **more)
        return eulastic.cell_free_layer(run)

    def test_a_core_in_a_channel(self):
        """Linear in y, so that the crossing is exact; the core moves up by .05, and leaves half of the columns free."""
        phi = lambda x, y, z, t: numpy.clip(0.5 + (0.25 - abs(y - 0.5 - 0.05 * t)) / 0.2, 0, 1) * (x < 0.5)
        found = self.layer("-grid_cells 8,40,1\n-grid_length 1,1,1\n-boundary_y wall\n-species rbc\n-rbc_shape sphere\n", (8, 40, 1), phi)
        numpy.testing.assert_allclose(found.walls["ymin"], [0.25, 0.3], atol=1e-12)
        numpy.testing.assert_allclose(found.walls["ymax"], [0.25, 0.2], atol=1e-12)
        numpy.testing.assert_allclose(found.thickness, 0.25, atol=1e-12)
        self.assertAlmostEqual(found.mean, 0.25)
        self.assertAlmostEqual(found.deviation, numpy.sqrt(0.05**2 / 2))
        self.assertEqual(found.covered, 0.5)

    def test_a_core_between_slabs(self):
        """A core around the periodic side is .2 from the wall in the middle of the box, on both faces of it."""
        phi = lambda x, y, z, t: numpy.clip(0.5 + (0.2 - abs(abs(y - 0.5) - 0.5)) / 0.2, 0, 1) + (abs(y - .5) < .1)
        core = lambda x, y, z, t: numpy.clip(0.5 + (0.2 - abs(abs(y - 0.5) - 0.5)) / 0.2, 0, 1)
        h = 1 / 40
        z, y, x = numpy.meshgrid([.5], (numpy.arange(40) + .5) * h, (numpy.arange(8) + .5) / 8, indexing="ij")
        found = self.layer("-grid_cells 8,40,1\n-grid_length 1,1,1\n-species rbc,bar\n-rbc_shape sphere\n-bar_shape slab\n-bar_axis y\n"
                           "-bar_interval .4,.6\n", (8, 40, 1), phi, solid_fraction_rbc=lambda t: core(x, y, z, t),
                           solid_fraction_bar=lambda t: (abs(y - .5) < .1) * 1.0)
        for face in ("bar_ymin", "bar_ymax"):
            numpy.testing.assert_allclose(found.walls[face], [0.2, 0.2], atol=1e-12)

    def test_a_core_in_a_tube(self):
        """The vessel's own solid does not count; a thread around another axis is nearer on one side, and as near on average to
        second order: the mean distance to a circle shifted by e is R - r + e^2/(4 r)."""
        options = ("-grid_cells 4,60,60\n-grid_length 1,1,1\n-species rbc,vessel\n-rbc_shape sphere\n-vessel_shape tube\n-vessel_axis x\n"
                   "-vessel_radius .45\n-vessel_centre 0,.5,.5\n")
        ring = lambda x, y, z, t: numpy.clip(0.5 + (0.3 - numpy.hypot(y - 0.5 - 0.1 * t, z - 0.5)) * 10, 0, 1)
        wall = lambda x, y, z, t: (numpy.hypot(y - 0.5, z - 0.5) > 0.45) * 1.0
        h = 1 / 60
        z, y, x = numpy.meshgrid(*((numpy.arange(n) + 0.5) / n for n in (60, 60, 4)), indexing="ij")
        found = self.layer(options, (4, 60, 60), lambda *p: ring(*p) + wall(*p),
                           solid_fraction_rbc=lambda t: ring(x, y, z, t), solid_fraction_vessel=lambda t: wall(x, y, z, t))
        numpy.testing.assert_allclose(found.walls["vessel"], [0.15, 0.15 + 0.1**2 / (4 * 0.3)], atol=0.02 * h)
        self.assertEqual(found.covered, 1)

    def test_a_core_in_a_throat(self):
        """A core of radius .1, linear across its surface, is R(x) - .1 from the wall, in 3-D and in 2-D."""
        for cells, centre in ((20, 40, 40), "0.5,.5,.5"), ((20, 40, 1), "0.5,.5,0"):
            options = ("-grid_cells {},{},{}\n-grid_length 1,1,1\n-species rbc,vessel\n-rbc_shape sphere\n-vessel_shape constricted_tube\n"
                       "-vessel_axis x\n-vessel_radius .45\n-vessel_throat_radius .2\n-vessel_throat_length .6\n-vessel_centre {}\n")
            flat = cells[2] == 1
            core = lambda x, y, z, t: numpy.clip(0.5 + (0.1 - numpy.hypot(y - 0.5, 0 if flat else z - 0.5)) * 10, 0, 1)
            z, y, x = numpy.meshgrid(*((numpy.arange(n) + 0.5) / n for n in cells[::-1]), indexing="ij")
            found = self.layer(options.format(*cells, centre), cells, core, solid_fraction_rbc=lambda t: core(x, y, z, t),
                               solid_fraction_vessel=lambda t: 0 * x)
            s = (numpy.arange(20) + .5) / 20 - .5
            radius = .45 - numpy.where(abs(s) < .3, .125 * (1 + numpy.cos(2 * numpy.pi * s / .6)), 0)
            numpy.testing.assert_allclose(found.walls["vessel"], radius.mean() - .1, atol=1e-3)
            self.assertAlmostEqual(found.deviation, radius.std(), delta=1e-3)
            self.assertEqual(found.covered, 1)

    def test_a_core_in_a_tube_across_the_plane(self):
        """In 2-D a tube along z is a circle."""
        core = lambda x, y, z, t: numpy.clip(0.5 + (0.2 - numpy.hypot(x - 0.5, y - 0.5)) * 10, 0, 1)
        z, y, x = numpy.meshgrid([.5], *2 * [(numpy.arange(60) + .5) / 60], indexing="ij")
        found = self.layer("-grid_cells 60,60,1\n-grid_length 1,1,1\n-species rbc,vessel\n-rbc_shape sphere\n-vessel_shape tube\n"
                           "-vessel_axis z\n-vessel_radius .45\n-vessel_centre .5,.5,0\n", (60, 60, 1), core,
                           solid_fraction_rbc=lambda t: core(x, y, z, t), solid_fraction_vessel=lambda t: 0 * x)
        numpy.testing.assert_allclose(found.walls["vessel"], 0.25, atol=1e-3)
        self.assertEqual(found.covered, 1)

    def test_an_unknown_species_is_refused(self):
        run = self.write("-grid_cells 4,4,1\n-grid_length 1,1,1\n-boundary_y wall\n-species rbc\n-rbc_shape sphere\n", (0.0,),
                         solid_fraction=lambda t: numpy.zeros((1, 4, 4)))
        with self.assertRaisesRegex(KeyError, "there is no species red; accepted: rbc"):
            eulastic.cell_free_layer(run, species="red")

    def test_no_wall_and_no_cell(self):
        options = "-grid_cells 4,4,1\n-grid_length 1,1,1\n-species rbc\n-rbc_shape sphere\n"
        with self.assertRaisesRegex(ValueError, "neither a tube nor a wall"):
            self.layer(options, (4, 4, 1), lambda x, y, z, t: 0 * x)
        with self.assertRaisesRegex(ValueError, "wall is neither a tube, a slab nor a wall of the box"):
            self.layer("-grid_cells 4,4,1\n-grid_length 1,1,1\n-boundary_y wall\n-species wall\n-wall_shape voxels\n"
                       "-wall_shear_modulus 1\n", (4, 4, 1), lambda x, y, z, t: 0 * x)
        found = self.layer(options + "-boundary_y wall\n", (4, 4, 1), lambda x, y, z, t: 0 * x)
        self.assertEqual(found.covered, 0)
        self.assertTrue(numpy.isnan(found.mean))


class SeveralRuns(WithRoom):
    def test_overlay(self):
        import matplotlib
        matplotlib.use("Agg")
        for name, speed in ("slow", 0.01), ("fast", 0.02):
            synthetic_run.write_run(self.room / name, speed=speed)
            with open(self.room / name / "options.txt", "a") as file:
                file.write(f"-fluid_viscosity {speed}\n")
        runs = [eulastic.read(self.room / name) for name in ("slow", "fast")]
        axis = eulastic.overlay([runs[0], self.room / "fast"], "kinetic_energy")
        self.assertEqual([text.get_text() for text in axis.get_legend().get_texts()], ["fluid_viscosity 0.01", "fluid_viscosity 0.02"])
        self.assertEqual(len(axis.lines), 2)
        numpy.testing.assert_array_equal(axis.lines[1].get_ydata(), runs[1].series.kinetic_energy)
        again = eulastic.overlay(runs, lambda run: (run.bodies.time, run.bodies.centroid[:, 0, 0]), labels=["a", "b"], axis=axis)
        self.assertIs(again, axis)
        numpy.testing.assert_allclose(axis.lines[3].get_ydata(), [0.25, 1.25, 2.25])
        with self.assertRaisesRegex(KeyError, "heat; accepted: step, time"):
            eulastic.overlay(runs, "heat")

    def test_plot_with_other_runs(self):
        for name, speed in ("slow", 0.01), ("fast", 0.02):
            synthetic_run.write_run(self.room / name, speed=speed)
        start = lambda *words: subprocess.run([ROOT / "scripts/plot", self.room / "slow", "--only", "series", "--format", "svg", *words],
                                              capture_output=True, text=True)
        done = start("--with", self.room / "fast")
        self.assertEqual(done.returncode, 0, done.stderr)
        words = (self.room / "slow/plot_series.svg").read_text()
        self.assertEqual([f">{name}<" in words for name in ("slow", "fast")], [True, True])
        (self.room / "fast/series.csv").unlink()
        self.assertEqual(start("--with", self.room / "fast").stderr, f"plot: --with {self.room / 'fast'}: there is no series.csv\n")


class FilesAsTheProgramReadsThem(WithRoom):
    def test_quotes_includes_and_comments(self):
        (self.room / "sub folder").mkdir()
        (self.room / "sub folder/base.opts").write_text("-time_end 3 -disc_radius 2 # two on a line\n-options_file ../deep.opts\n")
        (self.room / "deep.opts").write_text('-fluid_viscosity 0.5\n-time_end 9\n-disc_shape "sphere"\n')
        case = self.room / "case.opts"
        case.write_text('# a case\n-grid_cells 16,16,1 -grid_length 8,8,1 -output_dir "my #1 run"\r\n-body_force -1,0,0\n-species disc\n'
                        '-options_file "sub folder/base.opts" # brought in\n-disc_shear_modulus 1\n-time_end 4\n')
        found = eulastic.read_options(case)
        done = subprocess.run([os.environ["EULASTIC"], case, "-print_options"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        (self.room / "resolved.opts").write_text(done.stdout)
        resolved = eulastic.read_options(self.room / "resolved.opts")
        self.assertEqual(found["output_dir"], "my #1 run")
        self.assertEqual({name: resolved[name] for name in found}, found)
        self.assertEqual((found["time_end"], found["fluid_viscosity"], found["disc_radius"]), ("4", "0.5", "2"))

    def test_quotes_in_quotes_and_other_bytes(self):
        case, resolved = self.room / "case.opts", self.room / "resolved.opts"
        start = b"-grid_cells 16,16,1\n-grid_length 8,8,1\n-fluid_viscosity 1\n-time_end 1\n# Gr\xfc\xdfe\n-output_dir "
        for written, name in ((rb'"a \"b\" \\ c\d"', r'a "b" \ c\d'), (rb'a\b\\c', r'a\b\\c'), (rb'"end\\"', "end\\"), (rb'"#\"#"', '#"#'),
                              (b"Z\xfcrich", os.fsdecode(b"Z\xfcrich")), ("Zürich".encode(), "Zürich")):
            case.write_bytes(start + written + b"\n")
            done = subprocess.run([os.environ["EULASTIC"], case, "-print_options"], capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            resolved.write_bytes(done.stdout)
            self.assertEqual([eulastic.read_options(path)["output_dir"] for path in (case, resolved)], [name, name], written)

    def test_what_the_program_refuses(self):
        case = self.room / "case.opts"
        for text, said in (('-output_dir "open\n', "a quote is not closed"), ("-time_end 3 4\n", 'stray word "4"'),
                           ("-options_file case.opts\n", "includes itself")):
            case.write_text(text)
            done = subprocess.run([os.environ["EULASTIC"], case, "-print_options"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)
            with self.assertRaisesRegex(ValueError, said):
                eulastic.read_options(case)

    def test_half_written_files(self):
        directory = synthetic_run.write_run(self.room / "run")
        series = directory / "series.csv"
        series.write_text(series.read_text()[:-6])  # in the middle of the last number
        with h5py.File(directory / "bodies.h5", "a") as file:
            shorter = file["volume"][:2]
            del file["volume"]
            file["volume"] = shorter
        last = directory / "snapshot_000002.h5"
        last.write_bytes(last.read_bytes()[:1000])
        with self.assertWarnsRegex(UserWarning, "snapshot_000002.h5 is damaged"):
            run = eulastic.read(directory)
        numpy.testing.assert_array_equal(run.series.time, [0, 50])
        numpy.testing.assert_array_equal(run.bodies.time, [0, 50])
        self.assertEqual(run.bodies.centroid.shape, (2, 2, 3))
        self.assertEqual([snapshot.time for snapshot in run.snapshots], [0, 50])
        for text, rows in ("step,time\n", 0), ("step,ti", None):
            series.write_text(text)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)
                found = eulastic.read(directory).series
            self.assertEqual(found if found is None else len(found), rows)


class WhereH5pyComesFrom(WithRoom):
    def start(self, program, *words):
        """A Python without site packages, as another one on PATH has none of Debian's."""
        source = f"import sys; sys.path.insert(0, {str(ROOT / 'python')!r})\n" + program
        return subprocess.run(["/usr/bin/python3", "-S", "-B", "-c", source, *words], capture_output=True, text=True)

    def test_debians(self):
        directory = synthetic_run.write_run(self.room / "run")
        done = self.start("import eulastic; print(eulastic.read(sys.argv[1]).bodies.centroid.shape)", directory)
        self.assertEqual(done.stdout, "(3, 2, 3)\n", done.stderr)

    def test_what_to_install(self):
        (self.room / "conda-meta").mkdir()
        load = (f"import importlib.util as u; spec = u.spec_from_file_location('r', {str(ROOT / 'python/eulastic/requirements.py')!r})\n"
                "r = u.module_from_spec(spec); spec.loader.exec_module(r)\n")
        for more, said in ("", "/usr/bin/python3 -m pip install numpy h5py"), \
                (f"sys.prefix = {str(self.room)!r}\n", f"conda install -p {self.room} numpy h5py"):
            done = self.start(load + more + "r.find(debian='/nonexistent')")
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr.splitlines()[-1])
            self.assertTrue(done.stderr.splitlines()[-1].startswith("ImportError: eulastic needs numpy and h5py"), done.stderr)


if __name__ == "__main__":
    unittest.main()

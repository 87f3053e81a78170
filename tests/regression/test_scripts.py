"""The scripts: reader, plots and pictures on known data, and a real run reused."""
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import matplotlib.colors
import matplotlib.image
import numpy
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"
sys.path[:0] = [str(SCRIPTS), str(SCRIPTS / "lib"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True
import synthetic_run  # noqa: E402
from eulastic import Run, derived, is_finished, scene, surfaces  # noqa: E402
from eulastic.labels import Units  # noqa: E402
from eulastic.option_files import parse_options  # noqa: E402
from load_script import load  # noqa: E402, F401  # for other tests


def listing(folder):
    """{file: checksum} of all that is in a folder."""
    return {path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*")
            if path.is_file()}


def start(*command, **keywords):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, **keywords)


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


class Reader(WithFolder):
    def setUp(self):
        super().setUp()
        self.run_ = Run(synthetic_run.write_run(self.folder / "run"))

    def test_options(self):
        self.assertEqual(parse_options(["-a", "-1e-3,2", "-b", "-c", "x"]), {"a": "-1e-3,2", "b": "", "c": "x"})
        self.assertEqual(self.run_.options["boundary_z"], "periodic")
        self.assertEqual(self.run_.options["body_force"], "1e-3,0,-1e-5")
        self.assertEqual(self.run_.cells, (32, 24, 16))
        numpy.testing.assert_allclose(self.run_.spacing, 0.25)
        self.assertEqual([self.run_.side(d, 1) for d in range(3)], ["periodic", "wall", "periodic"])

    def test_series_bodies_summary(self):
        run = self.run_
        numpy.testing.assert_array_equal(run.series.time, [0, 50, 100])
        numpy.testing.assert_allclose(run.series.kinetic_energy, [0, 5e-3, 1e-2])
        self.assertEqual(list(run.bodies.species), ["rbc", "rbc"])
        numpy.testing.assert_allclose(run.bodies.centroid[-1] - run.bodies.centroid[0], [[2, 0, 0], [4, 0, 0]])
        self.assertEqual(run.summary["steps"], 10)

    def test_snapshots(self):
        run = self.run_
        self.assertEqual([s.time for s in run.snapshots], [0, 50, 100])
        snapshot = run.snapshots[-1]
        self.assertEqual(snapshot["solid_fraction"].shape, (16, 24, 32))
        self.assertEqual(snapshot.velocity().shape, (3, 16, 24, 32))
        numpy.testing.assert_allclose(snapshot.velocity()[0, 0, :, 0].max(), 0.02, rtol=0.01)
        self.assertTrue("pressure" in snapshot and "left_cauchy_green_xx" not in snapshot)
        self.assertEqual(snapshot.plane(), 7)  # the bodies' centres are at z = 2, between this plane and the next
        with h5py.File(snapshot.path, "a") as file:
            file["solid_fraction"][8] *= 1 + 2e-7
        self.assertEqual(snapshot.plane(), 7)
        self.assertEqual(snapshot.plane(place=0.3), 1)
        self.assertEqual(snapshot.plane(0, 7.9), 31)
        self.assertEqual(snapshot.plane(0, 8), 31)
        for place in (-0.1, 8.1, numpy.nan):
            with self.assertRaisesRegex(ValueError, "outside of the box; accepted: 0 to 8"):
                snapshot.plane(0, place)

    def test_a_vessel_is_cut_through_its_lumen(self):
        """Not through its wall, and where cells are in it through them."""
        run = self.run_
        fraction = numpy.zeros((16, 24, 32), "f4")
        z, y = numpy.meshgrid((numpy.arange(16) + 0.5) / 4 - 2.75, (numpy.arange(24) + 0.5) / 4 - 3, indexing="ij")
        fraction[numpy.hypot(y, z) > 1] = 1  # a tube along x, around z = 2.75
        run.options.update({"species": "vessel", "vessel_shape": "tube"})
        with h5py.File(run.snapshots[-1].path, "a") as file:
            file["solid_fraction_rbc"] = file["solid_fraction"][...]
            file["solid_fraction"][...] = file["solid_fraction_vessel"] = fraction
        snapshot = run.snapshots[-1]
        self.assertIn(snapshot.plane(), (10, 11))
        self.assertIn(snapshot.plane(1), (11, 12))
        run.options.update({"species": "vessel,rbc", "rbc_shape": "biconcave"})
        self.assertEqual(snapshot.plane(), 7)

    def test_an_unfinished_run_and_none(self):
        for name in ("summary.json", "bodies.h5", "series.csv"):
            (self.folder / "run" / name).unlink()
        run = Run(self.folder / "run")
        self.assertEqual((run.summary, run.series, run.bodies), ({}, None, None))
        with self.assertRaises(FileNotFoundError):
            Run(self.folder)

    def test_only_a_run_at_its_end_is_finished(self):
        path = self.folder / "run/summary.json"
        for reason in "time_end", "steps", "unfinished", "signal", "guard":
            path.write_text(f'{{"exit_reason": "{reason}"}}')
            self.assertEqual(is_finished(self.folder / "run"), reason in ("time_end", "steps"), reason)
        path.unlink()
        self.assertFalse(is_finished(self.folder / "run"))

    def test_units(self):
        self.assertEqual(Units("m,s").label("u", "velocity"), "u (m/s)")
        self.assertEqual(Units("").label("u", "velocity"), "u")
        blood = Units("um,us,pg")
        self.assertEqual([blood.label("", q) for q in ("velocity", "pressure", "viscosity", "energy", "power", "length")],
                         [" (um/ms)", " (Pa)", " (mPa s)", " (fJ)", " (nW)", " (um)"])
        self.assertEqual([blood.factor(q) for q in ("velocity", "pressure", "viscosity", "time")], [1e3, 1e3, 1, 1])  # 1 kPa, 1 m/s
        blood.set_dimension(2)
        self.assertEqual(blood.label("", "energy"), " (fJ/um)")
        metric = Units("m,s,kg")
        self.assertEqual((metric.label("p", "pressure"), metric.factor("pressure")), ("p (kg/(m s²))", 1))
        self.assertEqual([metric.label("", q) for q in ("energy", "power")], [" (kg m²/s²)", " (kg m²/s³)"])
        metric.set_dimension(2)
        self.assertEqual([metric.label("", q) for q in ("energy", "power")], [" (kg m/s²)", " (kg m/s³)"])
        self.assertEqual([Units("m,s").at(time) for time in (0, 2.34567, 45000)], ["t = 0 s", "t = 2.346 s", "t = 45000 s"])


class Pictures(WithFolder):
    def setUp(self):
        super().setUp()
        self.directory = synthetic_run.write_run(self.folder / "run")

    def test_plot(self):
        done = start(SCRIPTS / "plot", self.directory, "--output", self.folder / "plots")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("series", "bodies", "slices"):
            picture = matplotlib.image.imread(self.folder / "plots" / f"plot_{name}.png")[..., :3]
            self.assertGreater((picture < 0.5).any(axis=2).sum(), 1000, name)  # ink
        done = start(SCRIPTS / "plot", self.directory, "--only", "slices", "--plane", "y=3", "--field", "speed", "--format", "svg")
        self.assertEqual(done.returncode, 0, done.stderr)
        words = (self.directory / "plot_slices.svg").read_text()
        for word in ("speed (µm/ms)", "20.0", "z (µm)", "x (µm)", "y = 3.125 µm"):
            self.assertTrue(f">{word}" in words.replace("t = 100 µs, ", ">"), word)  # the speed is 19.97 µm/ms

    def test_bodies_are_whole(self):
        snapshot = Run(self.directory).snapshots[0]
        fraction = snapshot["solid_fraction"].astype(float)
        pieces = {body: (piece, begin) for body, piece, begin in
                  surfaces.body_pieces(fraction, snapshot["body"], [True, False, True])}
        self.assertEqual(set(pieces), {1, 2})
        self.assertAlmostEqual(sum(piece.sum() for piece, _ in pieces.values()), fraction.sum(), places=3)
        for body, (piece, begin) in pieces.items():  # the first one crosses x = 0: its box starts on the far side
            k, j, i = numpy.indices(piece.shape)
            for axis, first, place in zip((i, j, k), begin[::-1], synthetic_run.START[body - 1]):
                self.assertAlmostEqual((piece * (axis + first + 0.5)).sum() / piece.sum() * 0.25, place, delta=0.02)

    def test_render_shows_every_body_in_its_colour(self):
        picture = self.folder / "bodies.png"
        done = start(SCRIPTS / "render", self.directory, "--output", picture, "--size", 400, 320)
        self.assertEqual(done.returncode, 0, done.stderr)
        pixels = matplotlib.image.imread(picture)[..., :3]
        self.assertEqual(pixels.shape, (320, 400, 3))
        self.assertTrue((pixels[0, -1] == 1).all())  # white background
        hue = matplotlib.colors.rgb_to_hsv(pixels)
        for body in (1, 2):
            wanted = matplotlib.colors.rgb_to_hsv(scene.colour(body))[0]
            near = (abs(hue[..., 0] - wanted) < 0.03) & (hue[..., 1] > 0.4)
            self.assertGreater(near.sum(), 500, f"body {body}")
        wall = numpy.abs(pixels - [.08, .38, .28]).max(axis=-1) < 0.02  # the largest stress everywhere
        self.assertGreater(wall.sum(), 1000)

    def test_what_crosses_an_end_is_drawn_at_both(self):
        """The first body crosses x = 0: a third of it is on the right of the picture then, or none."""
        shares = []
        for words in ((), ("--whole",)):
            picture = self.folder / "bodies.png"
            done = start(SCRIPTS / "render", self.directory, "--output", picture, "--size", 400, 320, "--plain", "--camera", "0,0",
                         "--behind", "none", "--time", 0, *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            hue = matplotlib.colors.rgb_to_hsv(matplotlib.image.imread(picture)[..., :3])
            near = (abs(hue[..., 0] - matplotlib.colors.rgb_to_hsv(scene.colour(1))[0]) < 0.03) & (hue[..., 1] > 0.4)
            shares.append(near[:, 200:].sum() / near.sum())
        self.assertGreater(shares[0], 0.2)  # the body begins at x = .25, its radius is 1: a third of its disc
        self.assertLess(shares[0], 0.45)
        self.assertEqual(shares[1], 0)

    def test_fields_that_follow_from_others(self):
        """Solid rotation has the vorticity 2; u = y (6 - y)/9 along x has (2 y - 6)/9 of its speed."""
        snapshot = Run(self.directory).snapshots[-1]
        y = snapshot.run.centres(1)
        shear = derived.field(snapshot, "vorticity_z")[0, 1:-1, 0]
        numpy.testing.assert_allclose(shear, synthetic_run.SPEED * (2 * y[1:-1] - 6) / 9, atol=1e-8)
        numpy.testing.assert_allclose(derived.field(snapshot, "speed"), snapshot.velocity()[0], atol=1e-9)
        with self.assertRaisesRegex(KeyError, "accepted: body, pressure"):
            derived.field(snapshot, "colour")
        self.assertEqual(derived.limits("pressure", numpy.array([-1.0, 3]), 0), (-3, 3))
        self.assertEqual(derived.limits("pressure", numpy.array([-1e-9, 1e-9]), 1e-6), (-1e-6, 1e-6))

    def test_picture_options(self):
        picture = self.folder / "bodies.png"
        done = start(SCRIPTS / "render", self.directory, "--output", picture, "--size", 300, 240, "--transparent", "--field", "pressure",
                     "--clip", "z=2", "--dpi", 300, "--camera", "-30,20")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(matplotlib.image.imread(picture)[0, -1, 3], 0)
        for script, words, reason in (("render", ("--clip", "w=1"), "such as z=10.5"), ("render", ("--camera", "3"), "AZIMUTH"),
                                      ("render", ("--field", "heat"), "accepted: body"), ("plot", ("--field", "heat"), "accepted: body"),
                                      ("plot", ("--plane", "w"), "accepted: x, y or z"), ("plot", ("--plane", "z="), "such as z=10.5"),
                                      ("plot", ("--plane", "z=4.1"), "z = 4.1 is outside of the box; accepted: 0 to 4"),
                                      ("render", ("--clip", "x=-1"), "x = -1 is outside of the box; accepted: 0 to 8"),
                                      ("render", ("--camera", "-30,a"), "AZIMUTH"), ("plot", ("--units", "m"), "--units")):
            done = start(SCRIPTS / script, self.directory, *words)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(reason, done.stderr)

    def test_movie(self):
        done = start(SCRIPTS / "render", self.directory, "--movie", self.folder / "movie", "--size", 200, 160)
        self.assertEqual(done.returncode, 0, done.stderr)
        frames = sorted((self.folder / "movie").iterdir())
        self.assertEqual([frame.name for frame in frames], [f"frame_{n:04}.png" for n in range(3)])
        self.assertNotEqual(frames[0].read_bytes(), frames[2].read_bytes())
        done = start(SCRIPTS / "render", self.directory, "--movie", self.folder / "film.gif", "--size", 200, 160)
        self.assertEqual(done.returncode, 0, done.stderr)
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual((film.n_frames, film.size), (3, (200, 160)))
            colours = [numpy.asarray(picture.convert("RGB"), dtype=int) for picture in (film, Image.open(frames[0]))]
        self.assertLess(abs(colours[0] - colours[1]).max(), 32)  # bodies keep their shades

    @unittest.skipUnless(shutil.which("ffmpeg") and shutil.which("ffprobe"), "scripts/install --movie")
    def test_movie_by_ffmpeg(self):
        film = self.folder / "film.mp4"
        done = start(SCRIPTS / "render", self.directory, "--movie", film, "--size", 201, 160, "--rate", 5)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = start("ffprobe", "-v", "error", "-count_frames", "-show_entries",
                     "stream=codec_name,width,height,duration,nb_read_frames", "-of", "csv=p=0", film)
        self.assertEqual(said.stdout.strip(), "h264,202,160,0.600000,3")  # even numbers, as players need them

    def test_what_cannot_be_written_is_one_line(self):
        (self.folder / "taken.png").mkdir()
        (self.folder / "plot_series.png").mkdir()
        (self.folder / "file").touch()
        size = "--size", 200, 160
        for script, *words, reason in (("render", self.directory, *size, "--output", "taken.png", "taken.png cannot be written: Is a directory"),
                                       ("render", self.directory, *size, "--output", "file/x.png", "Not a directory|File exists"),
                                       ("render", self.directory, *size, "--output", "x.jpg", "accepted: FILE.png"),
                                       ("render", self.directory, *size, "--movie", "file", "file cannot be written: File exists"),
                                       ("render", self.directory, *size, "--movie", "file/x.gif", "Not a directory|File exists"),
                                       ("plot", self.directory, "--output", "file", "file cannot be written: File exists"),
                                       ("plot", self.directory, "--output", ".", "plot_series.png cannot be written: Is a directory"),
                                       ("make_vessel", "nodir/x.h5", "nodir/x.h5 cannot be written: No such file"),
                                       ("make_vessel", "file/x.stl", "file/x.stl cannot be written: Not a directory")):
            done = start(SCRIPTS / script, *words, cwd=self.folder)
            self.assertEqual(done.returncode, 1, words)
            self.assertRegex(done.stdout + done.stderr, rf"\A{script}: [^\n]*({reason})[^\n]*\n\Z")
        self.assertFalse((self.folder / "x.jpg").exists())

    @unittest.skipUnless(pathlib.Path("/dev/full").exists(), "a device without free space")
    def test_a_picture_without_space_is_no_success(self):
        (self.folder / "full.png").symlink_to("/dev/full")
        done = start(SCRIPTS / "render", self.directory, "--size", 200, 160, "--output", self.folder / "full.png")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertNotIn("t = ", done.stdout)
        self.assertIn("full.png cannot be written", done.stderr)
        for script, *words, name in (("render", self.directory, "--size", 200, 160, "--movie", "full.gif"), ("make_vessel", "full.h5"),
                                     ("make_vessel", "full.nrrd"), ("plot", self.directory, "--only", "series", "--output", ".", "plot_series.png")):
            (self.folder / name).symlink_to("/dev/full")
            done = start(SCRIPTS / script, *words, *([] if script == "plot" else [name]), cwd=self.folder)
            self.assertEqual(done.returncode, 1, name)
            self.assertRegex(done.stderr, rf"\A{script}: {name} cannot be written: No space left on device; accepted[^\n]*\n\Z")

    def test_a_run_that_is_not_there_is_one_line(self):
        for script, *words in (("plot", "nosuch"), ("render", "nosuch"), ("run", "nosuch.opts"),
                               ("run", "nosuch.opts", self.folder / "x"), ("run", ROOT / "options/disc_in_channel.opts")):
            done = start(SCRIPTS / script, *words, cwd=self.folder)
            self.assertNotEqual(done.returncode, 0, script)
            self.assertRegex(done.stdout + done.stderr, rf"\A{script}: [^\n]+\n\Z")



class RealRun(WithFolder):
    """What scripts/run does with directories; nothing of it computes."""

    def test_half_a_run_goes_on_from_its_checkpoint(self):
        command = (SCRIPTS / "run", ROOT / "options/disc_in_channel.opts", self.folder, "-grid_cells", "16,16,1",
                   "-time_end", "20", "-series_interval", "2", "-checkpoint_interval", "7")
        self.assertEqual(start(*command).returncode, 0)
        whole = Run(self.folder)
        (self.folder / "summary.json").unlink()  # as if it had been killed
        again = start(*command)
        self.assertIn("goes on from its checkpoint", again.stdout)
        half = Run(self.folder)
        self.assertEqual(half.summary["state_hash"], whole.summary["state_hash"])
        numpy.testing.assert_array_equal(half.series.kinetic_energy, whole.series.kinetic_energy)
        self.assertEqual(start(*command, "-fluid_viscosity", "2").returncode, 2)  # another run, which would replace this one
        other = start(command[0], "--replace", *command[1:], "-fluid_viscosity", "2")
        self.assertEqual(other.returncode, 0, other.stderr)
        self.assertNotIn("goes on", other.stdout)
        self.assertNotEqual(Run(self.folder).summary["state_hash"], whole.summary["state_hash"])

    def test_a_run_is_extended_and_never_lost(self):
        out = self.folder / "out"
        case = ROOT / "options/disc_in_channel.opts"
        words = "-grid_cells", "16,16,1"
        run = lambda *options, at=out: start(SCRIPTS / "run", *options[:options[0] == "--ranks" and 2 or 0], case, at,
                                             *words, *options[options[0] == "--ranks" and 2 or 0:])
        self.assertEqual(run("-time_end", "10").returncode, 0)
        kept = listing(out)
        for wrong in ("-disc_radios", "3"), ("-time_end", "5", "-disc_radius", "-1"):
            done = run(*wrong)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(listing(out), kept, wrong)
        self.assertIn("already", run("--ranks", "1", "-time_end", "10").stdout)
        self.assertEqual(listing(out), kept)
        longer = run("--ranks", "3", "-time_end", "20")
        self.assertIn("goes on from its checkpoint", longer.stdout)
        self.assertEqual(run("-time_end", "20", at=self.folder / "whole").returncode, 0)
        self.assertEqual(Run(out).summary["state_hash"], Run(self.folder / "whole").summary["state_hash"])
        other = self.folder / "mine"
        other.mkdir()
        (other / "notes.txt").write_text("mine")
        done = run("-time_end", "10", at=other)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertEqual([path.name for path in other.iterdir()], ["notes.txt"])
        done = start(SCRIPTS / "run", self.folder / "nosuch.opts", self.folder / "new")
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertFalse((self.folder / "new").exists())

    def test_a_finished_run_is_used_again(self):
        case = self.folder / "case.opts"
        case.write_text("# a disc in a periodic box\n-grid_cells 16,16,1\n-grid_length 1,1,1\n-fluid_viscosity 0.1\n"
                        "-body_force 1,0,0\n-species disc\n-disc_shape sphere\n-disc_radius 0.25\n"
                        "-disc_shear_modulus 1\n"
                        "-time_end 0.02\n-series_interval 0.005\n-snapshot_interval 0.01\n")

        def run(*options, how=()):
            done = start(SCRIPTS / "run", *how, case, self.folder / "out", *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return "already" in done.stdout

        self.assertFalse(run())
        self.assertTrue(run())
        self.assertFalse(run("-pressure_solver", "smac", how=["--replace"]))
        results = Run(self.folder / "out")
        self.assertEqual(results.options["pressure_solver"], "smac")
        self.assertEqual(results.summary["exit_reason"], "time_end")
        self.assertEqual((results.snapshots[-1].time, results.series.time[-1]), (results.summary["time"],) * 2)
        self.assertEqual(results.snapshots[-1].velocity().shape, (3, 1, 16, 16))
        numpy.testing.assert_allclose(results.bodies.centroid[0, :, :2], [[0.5, 0.5]], atol=1e-6)
        self.assertEqual(start(SCRIPTS / "plot", self.folder / "out").returncode, 0)


class Figure(WithFolder):
    def test_figure_of_the_paper(self):
        command = SCRIPTS / "studies/paper/paper_figure2", "--output", self.folder, "--cells", 16, "--time-end", 10
        done = start(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = [Run(self.folder / solver) for solver in ("smac", "acm")]
        self.assertEqual([run.options["pressure_solver"] for run in runs], ["smac", "acm"])
        times = [snapshot.time for snapshot in runs[0].snapshots]
        self.assertEqual((times[0], times[-1]), (0, 10))
        picture = matplotlib.image.imread(self.folder / "paper_figure2.png")[..., :3]
        height, width = picture.shape[0] // 2, picture.shape[1] // 4
        for row in range(2):
            for column in range(3):
                panel = picture[row * height:(row + 1) * height, column * width:(column + 1) * width]
                self.assertGreater((numpy.ptp(panel, axis=2) > 0.3).sum(), 1000, (row, column))  # colours
        last = (self.folder / "paper_figure2.txt").read_text().splitlines()[4].split()
        self.assertEqual(float(last[0]), 10)
        ways = numpy.linalg.norm(runs[0].bodies.centroid[-1] - runs[0].bodies.centroid[0], axis=1)
        self.assertAlmostEqual(float(last[1]), ways.mean(), delta=1e-4)
        self.assertLess(float(last[3]), 1e-3 * ways.mean())
        again = start(*command)
        self.assertEqual(again.stdout.count("holds this run already"), 2 if os.environ.get("DISPLAY") else 4)


if __name__ == "__main__":
    unittest.main()

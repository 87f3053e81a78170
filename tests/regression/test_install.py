"""An installation: program, scripts and Python package from a prefix that nobody writes into, the page for man,
the Debian package. Needs EULASTIC, in the directory where it was built."""
import ast
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from program import BINARY, launcher  # noqa: E402

BUILD = pathlib.Path(BINARY).resolve().parent
ROOT = pathlib.Path(__file__).resolve().parents[2]
SHORT = ["-grid_cells", "16,16,1", "-time_steps_max", "2"]


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        room = tempfile.TemporaryDirectory()
        cls.addClassCleanup(room.cleanup)
        cls.room = pathlib.Path(room.name)
        cls.prefix = cls.room / "prefix"
        done = subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix], capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(done.stdout + done.stderr)
        subprocess.run(["chmod", "-R", "a-w", cls.prefix], check=True)
        cls.addClassCleanup(subprocess.run, ["chmod", "-R", "u+w", cls.prefix])
        cls.state = cls.listing()
        cls.environment = dict(os.environ, PATH=f"{cls.prefix / 'bin'}:{os.environ['PATH']}")
        for name in ("EULASTIC", "PYTHONDONTWRITEBYTECODE"):
            cls.environment.pop(name, None)

    @classmethod
    def listing(cls):
        return {path: path.lstat().st_mtime_ns for path in cls.prefix.rglob("*")}

    def tearDown(self):
        self.assertEqual(self.listing(), self.state, "something wrote into the prefix")  # as root, it could

    def call(self, *command, code=0, **more):
        done = subprocess.run([str(word) for word in command], cwd=self.room, env=dict(self.environment, **more),
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_a_case_that_comes_with_it(self):
        self.call("eulastic-run", "disc_in_channel", "run", *SHORT)
        self.assertIn("already", self.call("eulastic-run", "options/disc_in_channel.opts", "run", *SHORT))
        self.assertIn("there is no case", self.call("eulastic-run", "elsewhere/disc_in_channel.opts", "new", code=2))
        self.call("eulastic-plot", "run")
        self.assertTrue((self.room / "run/plot_series.png").exists())
        case = self.prefix / "share/eulastic/options/disc_in_channel.opts"
        self.call(*launcher(2), "eulastic", case, *SHORT, "-output_dir", "other")
        self.assertEqual(*((self.room / name / "series.csv").read_text() for name in ("run", "other")))

    def test_other_commands_on_the_path(self):
        self.call("eulastic-make-vessel", "wall.h5", "--cells", "12,8,4", "--length", "12,8,4")
        with h5py.File(self.room / "wall.h5") as file:
            self.assertEqual(file["solid_fraction"].shape, (4, 8, 12))
        self.call("eulastic-compare-pressure-solvers", "disc_in_channel", *SHORT, "--output", "compared")
        self.assertIn("ns_per_cell_step", (self.room / "compared/comparison.txt").read_text())
        self.assertIn("ms per step", self.call("eulastic-profile", "disc_in_channel", "-grid_cells", "16,16,1", "--steps", 2,
                                               "--output", "profiled"))
        self.assertTrue((self.room / "profiled/profile.png").exists())

    def test_every_script_says_what_it_does(self):
        scripts = [path for path in (self.prefix / "share/eulastic/scripts").iterdir() if os.access(path, os.X_OK) and path.is_file()]
        self.assertGreaterEqual(len(scripts), 5)
        for path in [*scripts, *(self.prefix / "bin").glob("eulastic-*")]:
            self.assertIn(f"usage: {path.name if path.is_symlink() else ''}", self.call(path, "--help"))

    def test_package_of_python(self):
        program = ("import eulastic, sys; run = eulastic.run('disc_in_channel', 'python', progress=False, "
                   "grid_cells=(16, 16, 1), time_steps_max=2); print(run.summary['steps'])")
        said = self.call("/usr/bin/python3", "-B", "-c", program, PYTHONPATH=str(self.prefix / "share/eulastic/python"))
        self.assertEqual(said, "2\n")

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_page_for_man(self):
        page = self.prefix / "share/man/man1/eulastic.1"
        self.assertEqual(self.call("groff", "-man", "-ww", "-Tutf8", "-z", page), "")
        shown = self.call("groff", "-man", "-Tascii", "-P-c", "-P-b", "-P-u", page)
        options = re.findall(r"^  -(\w+)", self.call("eulastic", "-help"), re.MULTILINE)
        self.assertGreater(len(options), 100)
        self.assertEqual([name for name in options if not re.search(rf"^ +-{name}\b", shown, re.MULTILINE)], [])

    def test_links_of_the_documents(self):
        documents = self.prefix / "share/doc/eulastic"
        for page in documents.rglob("*.md"):
            for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
                self.assertTrue("://" in target or (page.parent / target).exists(), target)


class Packages(unittest.TestCase):
    @unittest.skipUnless(shutil.which("cpack") and shutil.which("dpkg-shlibdeps"), "no cpack or dpkg-dev")
    def test_debian_package(self):
        with tempfile.TemporaryDirectory() as room:
            done = subprocess.run(["cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", room,
                                   "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            package, = pathlib.Path(room).glob("eulastic_*.deb")
            ask = lambda *words: subprocess.run(["dpkg-deb", *words], capture_output=True, text=True, check=True).stdout  # noqa: E731
            files = set(re.findall(r" \./(\S+)", ask("-c", package)))
            for name in ("bin/eulastic", "bin/eulastic-run", "bin/eulastic-make-vessel", "share/man/man1/eulastic.1",
                         "lib/python3/dist-packages/eulastic",
                         "share/eulastic/options/channel_rbc.opts", "share/eulastic/scripts/render"):
                self.assertIn(f"usr/{name}", files)
            self.assertEqual([name for name in files if not name.startswith("usr/") and name], [])
            needs = ask("-f", package, "Depends")
            for library in ("libpetsc", "libhdf5-openmpi", "libopenmpi", "openmpi-bin", "libc6"):
                self.assertIn(library, needs)

    def test_one_version(self):
        found = {name: re.search(pattern, (ROOT / name).read_text())[1] for name, pattern in {
            "CMakeLists.txt": r"project\(eulastic VERSION ([\d.]+)", "CITATION.cff": r"\nversion: ([\d.]+)",
            "python/pyproject.toml": r'\nversion = "([\d.]+)"',
            "packaging/spack/packages/eulastic/package.py": r'version\("([\d.]+)"'}.items()}
        self.assertEqual(len(set(found.values())), 1, found)

    def test_recipes(self):
        ast.parse((ROOT / "packaging/spack/packages/eulastic/package.py").read_text())
        for script in re.findall(r"scripts/\w+", (ROOT / "packaging/Dockerfile").read_text()):
            self.assertTrue((ROOT / script).exists(), script)
        options = re.findall(r'"(EULASTIC_\w+)"', (ROOT / "packaging/spack/packages/eulastic/package.py").read_text())
        for option in options:
            self.assertIn(option, (ROOT / "CMakeLists.txt").read_text())


if __name__ == "__main__":
    unittest.main()

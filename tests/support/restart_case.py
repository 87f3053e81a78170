"""Runs of the program that are checkpointed, killed and restarted: what the tests of it share.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

import h5py
import numpy
from program import BINARY, launcher

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLAT = ("-grid_cells 20,16,1 -grid_length 5,4,1 -boundary_y wall -boundary_ymax_velocity .4,0,0 -boundary_ymax_angular_frequency .9 "
        "-fluid_viscosity .3 -body_force .1,0,0 -species cell,bead -cell_shape sphere -cell_radius .8 "
        "-cell_centre .3,2.2,0 -cell_shear_modulus 1 -bead_shape sphere -bead_radius .6 -bead_centre 2.9,1.5,0 "
        "-bead_law mooney_rivlin -bead_c1 .7 -bead_c2 .3 -bead_c3 .2 -time_end 100 -series_interval .11").split()
SOLID = ("-grid_cells 12,10,9 -grid_length 3,2.5,2.2 -boundary_y wall -boundary_z wall -boundary_zmax_velocity .3,.1,0 "
         "-fluid_viscosity .3 -initial_velocity_mean .5,0,0 -species cell -cell_shape sphere -cell_radius .7 "
         "-cell_centre .2,1.2,1 -cell_shear_modulus 1 -time_end 100 -series_interval .11").split()
SLAB = ("-species cell,plate -plate_shape slab -plate_axis y -plate_interval 0,.6 -plate_shear_modulus 1").split()
ATTACHED = [w for w in FLAT[:FLAT.index("-species")]] + SLAB + FLAT[FLAT.index("-cell_shape"):
                                                                 FLAT.index("-bead_shape")] + FLAT[-4:]
OFTEN = "-checkpoint_interval 1e-9".split()  # after every step
ENDLESS = "-time_step 1e-5 -series_interval 1".split()


class Restart(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)
        self.environment = {k: v for k, v in os.environ.items() if k != "PETSC_OPTIONS"}

    def command(self, arguments, ranks):
        return [*launcher(ranks), BINARY, *map(str, arguments)]

    def call(self, *arguments, ranks=0, **more):
        return subprocess.run(self.command(arguments, ranks), cwd=self.room, env=self.environment, timeout=120,
                              capture_output=True, text=True, **more)

    def start(self, *arguments, ranks=0, stdout=subprocess.DEVNULL):
        """A run in the background, in its time loop."""
        process = subprocess.Popen(self.command([*arguments, "-output_dir", "run"], ranks), cwd=self.room,
                                   env=self.environment, stdout=stdout, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.wait_until(lambda: self.series("run").count("\n") > 1 or process.poll() is not None)
        self.assertIsNone(process.poll(), "ended too early")
        return process

    def wait_until(self, condition):
        limit = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), limit)
            time.sleep(0.01)

    def run_case(self, directory, *arguments, ranks=0):
        result = self.call(*arguments, "-output_dir", directory, ranks=ranks)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
        return self.summary(directory)

    def refused(self, *arguments, says, code=2):
        result = self.call(*arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z")
        for piece in says:
            self.assertIn(piece, result.stderr)

    def summary(self, directory):
        return json.loads((self.room / directory / "summary.json").read_text())

    def series(self, directory):
        path = self.room / directory / "series.csv"
        return path.read_text() if path.exists() else ""

    def checkpoints(self, directory="run"):
        return sorted((self.room / directory).glob("checkpoint_*.h5"))

    def assert_same(self, one, other, outputs=True):
        """The same state, and the same rows in series.csv and bodies.h5."""
        a, b = self.summary(one), self.summary(other)
        for key in ("state_hash", "steps", "time", "bodies", "acm_sweeps_per_step", "viscous_stages_per_step"):
            self.assertEqual(a[key], b[key], key)
        if not outputs:
            return
        self.assertEqual(self.series(one), self.series(other))
        with h5py.File(self.room / one / "bodies.h5") as x, h5py.File(self.room / other / "bodies.h5") as y:
            for name in x:
                numpy.testing.assert_array_equal(x[name][()], y[name][()], name)
                self.assertEqual(x[name].attrs.get("checksum"), y[name].attrs.get("checksum"), name)

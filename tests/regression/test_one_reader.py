#!/usr/bin/python3
"""Only rank 0 reads the files that options name: ranks are started in directories of their own, the files are in that of rank 0.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from program import BINARY, MPIEXEC  # noqa: E402

SCENE = """-grid_cells 8,9,8 -boundary_y wall -time_end 1e-3 -time_step 1e-3 -options_file more.opts
-species cell,plate -cell_shape sphere -cell_radius .25 -cell_shear_modulus 1 -cell_placement list
-plate_shape voxels -plate_law rigid -plate_voxels plate.nrrd
"""
FILES = {
    "scene.opts": SCENE,
    "more.opts": "-cell_positions places.csv -boundary_xmin inflow -boundary_xmax outflow\n"
                 "-boundary_xmin_velocity table.csv -boundary_xmin_profile profile\n",
    "places.csv": ".5,.5,.5\n",
    "table.csv": "0,0\n1,1\n",
    "profile": 72 * "1 ",
    "plate.nrrd": "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 9 8\nencoding: ascii\n\n" + 8 * (8 * "1 " + 64 * "0 "),
}


class OneReader(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)
        self.here, self.nowhere = self.room / "here", self.room / "nowhere"
        self.here.mkdir(), self.nowhere.mkdir()
        for name, text in FILES.items():
            (self.here / name).write_text(text)

    def run_program(self, *words):
        program = [BINARY, "scene.opts", "-output_dir", str(self.room / "run"), *words]
        of_rank = lambda directory: ["-n", "1", "-wdir", str(directory), *program]
        return subprocess.run([MPIEXEC, *of_rank(self.here), ":", *of_rank(self.nowhere)], capture_output=True, text=True,
                              timeout=120)

    def test_rank_0_tells_the_others(self):
        done = self.run_program()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        again = self.run_program("-restart", "../run", "-time_end", "2e-3")
        self.assertEqual((again.returncode, again.stderr), (0, ""))

    def test_what_rank_0_does_not_find_is_one_line_of_all(self):
        for name in FILES:
            with self.subTest(name):
                (self.here / name).rename(self.nowhere / name)
                missing = self.run_program("-check_only")
                self.assertEqual(missing.returncode, 2)
                self.assertRegex(missing.stderr, rf"\Aeulastic: error: [^\n]*{name}")
                self.assertEqual(missing.stderr.count("eulastic: error:"), 1)
                (self.nowhere / name).rename(self.here / name)


if __name__ == "__main__":
    unittest.main()

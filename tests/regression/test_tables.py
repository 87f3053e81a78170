#!/usr/bin/python3
"""Texts of numbers as others write them: tables over time, lists of positions, profiles; what happens where a table ends."""
import pathlib
import re
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
from test_initial_state import WithRoom  # noqa: E402

CHANNEL = ("-grid_cells 16,8,1 -grid_length 2,1,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax pressure "
           "-boundary_xmin_profile developed -fluid_viscosity .1 -time_step .01 -series_interval .01").split()
BEAT = ((0, 1), (.05, 1.5), (.1, .25), (.15, 1))


def table(rows, separator=",", end="\n", head=""):
    return head + "".join(f"{time}{separator}{value}{end}" for time, value in rows)


class Tables(WithRoom):
    def write(self, name, text):
        (self.room / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return name

    def inflow(self, *options, end):
        """Times and flow rates into the box."""
        run = self.run_case(*CHANNEL, "-time_end", str(end), *options)
        return run.series.time, run.series.flow_rate_xmin

    def test_every_way_to_write_a_table(self):
        texts = (table(BEAT, head="time,value\n"), table(BEAT, ";"), table(BEAT, " "), table(BEAT, "\t", "\r\n"),
                 "\ufeff" + table(BEAT), table(BEAT, ", ", "  # a row\n\n", "# a beat\nt (s), Q (ml/s)\n"))
        wanted = self.inflow("-boundary_xmin_velocity", self.write("plain.csv", table(BEAT)), end=.15)
        numpy.testing.assert_allclose(wanted[1], numpy.interp(wanted[0], *numpy.transpose(BEAT)), rtol=1e-12)
        for text in texts:
            numpy.testing.assert_array_equal(self.inflow("-boundary_xmin_velocity", self.write("other.csv", text), end=.15), wanted)

    def test_a_table_ends_where_it_ends(self):
        name = self.write("beat.csv", table(BEAT))
        for option in ("-boundary_xmin_velocity", "-boundary_xmin_flow_rate"):
            self.refused(*CHANNEL, "-time_end", ".3", option, name,
                         says=[f"{option}: beat.csv goes from time 0 to 0.15, the run from 0 to 0.3; accepted: a table that "
                               "covers the run, -boundary_xmin_table_period to repeat it (in the file: # period T), or -boundary_xmin_table_hold true"])
        self.refused(*CHANNEL, "-time_end", ".3", "-boundary_xmin_velocity", "1", "-boundary_xmax_pressure", name, "-check_only",
                     says=["-boundary_xmax_pressure: beat.csv goes from time 0 to 0.15"])
        time, flow = self.inflow("-boundary_xmin_flow_rate", name, "-boundary_xmin_table_hold", end=.3)
        numpy.testing.assert_allclose(flow, numpy.interp(time, *numpy.transpose(BEAT)), rtol=1e-12)
        time, flow = self.inflow("-boundary_xmin_velocity", name, "-boundary_xmin_table_period", ".15", end=.4)
        numpy.testing.assert_allclose(flow, numpy.interp(time, *numpy.transpose(BEAT), period=.15), rtol=1e-9)

    def test_a_table_that_says_that_it_repeats(self):
        plain = self.write("plain.csv", table(BEAT))
        wanted = self.inflow("-boundary_xmin_velocity", plain, "-boundary_xmin_table_period", ".15", end=.4)
        self.assertGreater(len(set(wanted[1])), 10)
        for text in ("# period 0.15\n" + table(BEAT), table(BEAT, ";", "\r\n") + "  #Period\t.15", "# a beat\n#\n# period 1.5e-1\n" + table(BEAT)):
            name = self.write("beat.csv", text)
            numpy.testing.assert_array_equal(self.inflow("-boundary_xmin_velocity", name, end=.4), wanted)
        numpy.testing.assert_array_equal(self.inflow("-boundary_xmin_velocity", name, "-boundary_xmin_table_period", ".15", end=.4), wanted)
        longer = self.inflow("-boundary_xmin_flow_rate", self.write("longer.csv", "# period .2\n" + table(BEAT)), end=.4)
        numpy.testing.assert_allclose(longer[1], numpy.interp(longer[0], *numpy.transpose(BEAT), period=.2), rtol=1e-9)
        pressures = [self.run_case(*CHANNEL, "-time_end", ".4", "-boundary_xmin_velocity", "1", "-boundary_xmax_pressure", *options)
                     for options in ((name,), (plain, "-boundary_xmax_table_period", ".15"))]
        numpy.testing.assert_array_equal(*(run.series.pressure_xmax for run in pressures))
        # Words after numbers and periodic things are no such line.
        other = self.write("other.csv", "# periodic flow\n" + table(BEAT, end=" # period 9\n"))
        self.refused(*CHANNEL, "-time_end", ".4", "-boundary_xmin_velocity", other, says=["-boundary_xmin_velocity: other.csv goes from"])

    def test_periods_that_are_refused(self):
        for text, options, says in (
                ("# period: .15\n", "", 'beat.csv line 1: "period: .15" gives no number > 0; accepted: one line # period T'),
                ("# period of the heart\n", "", "-boundary_xmin_velocity: beat.csv line 1: "),
                ("# period 0\n", "", "beat.csv line 1: "), ("# period nan\n", "", "beat.csv line 1: "),
                ("# period .15\n#period .15\n", "", 'beat.csv line 2: "period .15" is repeated'),
                ("# period .1\n", "", "-boundary_xmin_velocity: the period of beat.csv: 0.1 is shorter than the table"),
                ("# period .15\n", "-boundary_xmin_table_period .2", '-boundary_xmin_table_period: 0.2, but beat.csv says "# period 0.15"'),
                ("# period .15\n", "-boundary_xmin_table_hold", '-boundary_xmin_table_hold: beat.csv says "# period 0.15"')):
            with self.subTest(text=text, options=options):
                self.refused(*CHANNEL, "-time_end", ".4", "-boundary_xmin_velocity", self.write("beat.csv", text + table(BEAT)),
                             *options.split(), says=[says])

    def test_no_beat_is_stepped_over(self):
        """A flow so slow that nothing else limits the step: it is that of a cosine of the same period."""
        name = self.write("beat.csv", table([(time, 1e-9 * value) for time, value in BEAT]))
        slow = [*CHANNEL[:CHANNEL.index("-fluid_viscosity")], "-fluid_viscosity", "1e-6", "-time_end", "1", "-check_only"]
        found = [re.search(r"time step \(estimate\): .*", self.start(*slow, "-boundary_xmin_velocity", *options).stdout)[0]
                 for options in ((name, "-boundary_xmin_table_period", ".15"), (self.write("own.csv", "# period .15\n" + (self.room / name).read_text()),), ("1e-9", "-boundary_xmin_angular_frequency", str(numpy.pi / .075)))]
        self.assertEqual(found, ["time step (estimate): 0.00375 (forcing period)"] * 3)

    def test_a_run_goes_on_when_its_table_is_held_or_repeats(self):
        name = self.write("beat.csv", table(BEAT))
        first = [*CHANNEL, "-boundary_xmin_velocity", name, "-checkpoint_interval", ".05"]
        self.run_case(*first, "-time_end", ".15")
        self.refused(*first, "-time_end", ".2", "-restart", "out1", says=["-boundary_xmin_velocity: beat.csv goes"])
        run = self.run_case(*first, "-time_end", ".2", "-restart", "out1", "-boundary_xmin_table_period", ".15")
        self.assertAlmostEqual(run.series.flow_rate_xmin[-1], 1.5, delta=1e-9)

    def test_profiles(self):
        shape = numpy.arange(1, 9) * 1.0
        plain = self.write("plain.txt", " ".join(map(str, shape)))
        channel = [word for word in CHANNEL if word not in ("-boundary_xmin_profile", "developed")]

        def flow(name):
            return self.run_case(*channel, "-time_end", ".02", "-boundary_xmin_profile", name).series.flow_rate_xmin

        wanted = flow(plain)
        self.assertAlmostEqual(wanted[-1], shape.mean(), delta=1e-12)
        for text in ("velocity\n" + "\n".join(map(str, shape)), "\ufeff# measured\r\n" + ";".join(map(str, shape))):
            numpy.testing.assert_array_equal(flow(self.write("other.txt", text)), wanted)
        for dataset, block in (("velocity", 512), ("in/some/group", 0)):
            with h5py.File(self.room / "profile.mat", "w", userblock_size=block) as file:
                file[dataset] = shape[None]
            numpy.testing.assert_array_equal(flow("profile.mat"), wanted)
            numpy.testing.assert_array_equal(flow(f"profile.mat:{dataset}"), wanted)
        self.refused(*channel, "-time_end", ".02", "-boundary_xmin_profile", self.write("bad.txt", "1 2 3\n4 five\n"),
                     says=['-boundary_xmin_profile: bad.txt line 2: "five" is not a number; accepted: '])

    def test_lists_of_cells_of_others(self):
        scene = ("-grid_cells 16,16,16 -grid_length 4,4,4 -time_end 1e-3 -time_steps_max 1 -species cell -cell_shape ellipsoid "
                 "-cell_semi_axes .8,.4,.4 -cell_shear_modulus 1 -cell_placement list -snapshot_interval 1 "
                 "-snapshot_fields solid_fraction -cell_positions").split()
        fraction = lambda name: self.run_case(*scene, name).snapshots[0]["solid_fraction"][...]  # noqa: E731
        wanted = fraction(self.write("plain.csv", "1,1,1,0,0,0\n3,3,2,0,30,90\n"))
        self.assertGreater(wanted.sum(), 60)
        for text in ("2\n1 1 1 0 0 0\n3 3 2 0 30 90\n", 
                     "\ufeff# cells\r\n2\r\nx y z rx ry rz\r\n1\t1\t1\t0\t0\t0\r\n3\t3\t2\t0\t30\t90\r\n",
                     "x;y;z;angle_x;angle_y;angle_z\n1;1;1;0;0;0\n3;3;2;0;30;90\n"):
            numpy.testing.assert_array_equal(fraction(self.write("other.pos", text)), wanted)
        for text, says in (("3\n1 1 1 0 0 0\n", "line 1: says that 3 rows follow, but 1 do"),
                           ("x,y,z\n1,1\n", "line 2: a row has 2 numbers; accepted: rows of x,y,z or x,y,z,angle_x,"),
                           ("1,5;2,5;3,5\n", 'line 1: "1,5" is not a number')):
            self.refused(*scene, self.write("bad.pos", text), says=["-cell_positions: bad.pos " + says])


if __name__ == "__main__":
    unittest.main()

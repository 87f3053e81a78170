#!/usr/bin/python3
"""Species of shape voxels: HDF5, NRRD and STL become the solid fraction; wrong files are refused in one line."""
import gzip
import pathlib
import re
import struct
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
from test_initial_state import ROOT, WithRoom  # noqa: E402

RUN = ("-grid_cells 12,10,8 -grid_length 1.2,1,.8 -boundary_y wall -time_end 1e-3 -time_steps_max 1 -time_step 1e-3"
       ).split()
BODY = "-species part -part_shape voxels -part_shear_modulus 1 -part_voxels".split()
SHAPE = (8, 10, 12)
RANDOM = numpy.random.default_rng(3)


def nrrd(values, encoding="raw", **fields):
    """An NRRD file: `fields` replace those that are right, None leaves one out."""
    kinds = {"f4": "float", "f8": "double", "u1": "uchar", "i2": "short", "u8": "uint64"}
    right = {"type": kinds[values.dtype.str[1:]], "dimension": values.ndim,
             "sizes": " ".join(map(str, reversed(values.shape))), "encoding": encoding,
             "endian": "big" if values.dtype.str[0] == ">" else "little"}
    right.update({name.replace("_", " "): value for name, value in fields.items()})
    header = "NRRD0004\n# by hand\n" + "".join(f"{n}: {v}\n" for n, v in right.items() if v is not None) + "\n"
    data = values.tobytes()
    if encoding == "gzip":
        data = gzip.compress(data)
    if encoding == "ascii":
        data = " ".join(map(repr, values.ravel().tolist())).encode() + b"\n"
    return header.encode() + data


def box_stl(low, high):
    """Twelve triangles."""
    corner = [[(high if n >> d & 1 else low)[d] for d in range(3)] for n in range(8)]
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return [[corner[n] for n in t] for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def binary(triangles, count=None):
    head = struct.pack("<80sI", b"solid, although it is binary", len(triangles) if count is None else count)
    return head + b"".join(struct.pack("<12fH", 0, 0, 0, *sum(t, []), 0) for t in triangles)


def ascii_stl(triangles):
    lines = ["solid box"]
    for t in triangles:
        lines += ["facet normal 0 0 0", " outer loop", *(f"  vertex {x!r} {y!r} {z!r}" for x, y, z in t), " endloop",
                  "endfacet"]
    return ("\n".join(lines) + "\nendsolid box\n").encode()


class Voxels(WithRoom):
    def write(self, name, content):
        (self.room / name).write_bytes(content)
        return name

    def hdf5(self, values, name="v.h5", dataset="mask", **attributes):
        with h5py.File(self.room / name, "w") as file:
            file[dataset] = values
            for attribute, value in attributes.items():
                file[dataset].attrs[attribute] = value
        return name

    def phi(self, name, *options, grid=RUN, ranks=1):
        """phi at the start."""
        self.assertEqual(len(grid) % 2, 0)
        run = self.run_case(*grid, *BODY, name, "-snapshot_interval", "1", "-snapshot_precision", "double",
                            "-snapshot_fields", "solid_fraction,body", *options, ranks=ranks)
        fraction, label = run.snapshots[0]["solid_fraction"][...], run.snapshots[0]["body"][...]
        self.assertTrue(((label == 1) == (fraction > 0)).all())
        return fraction

    def test_masks_and_fractions_of_hdf5(self):
        mask = RANDOM.random(SHAPE) < .3
        fraction = RANDOM.random(SHAPE)
        for values in (mask, mask.astype("u1"), mask.astype("i8") * -255, mask.astype("f4"), mask.astype(">u2")):
            numpy.testing.assert_array_equal(self.phi(self.hdf5(values)), mask)
        numpy.testing.assert_allclose(self.phi(self.hdf5(fraction)), fraction, atol=1e-12)
        numpy.testing.assert_array_equal(self.phi(self.hdf5(mask), "-part_voxels_invert"), ~mask)
        with h5py.File(self.room / "packed.h5", "w") as file:
            file.create_dataset("a/b", data=fraction, chunks=(3, 4, 5), compression="gzip", shuffle=True)
        numpy.testing.assert_allclose(self.phi("packed.h5:/a/b"), fraction, atol=1e-12)

    def test_place_from_attributes_and_options(self):
        solid = numpy.ones((2, 2, 2), "u1")
        wanted = numpy.zeros(SHAPE)
        wanted[2:4, 3:5, 1:3] = 1
        at = dict(spacing=[.1, .1, .1], origin=[.1, .3, .2])
        numpy.testing.assert_array_equal(self.phi(self.hdf5(solid, **at)), wanted)
        moved = self.phi(self.hdf5(solid, **at), "-part_voxels_origin", ".15,.3,.2")
        numpy.testing.assert_allclose(moved[2, 3, 1:4], [.5, 1, .5], atol=1e-12)
        self.assertEqual(self.phi(self.hdf5(solid)).min(), 1)  # fills the box
        half = self.phi(self.hdf5(solid), "-part_voxels_spacing", ".3,.5,.4")
        self.assertAlmostEqual(half.sum(), 480, delta=1e-9)
        # The file's origin is in units of the file: it goes with the file's spacing alone.
        corner = numpy.zeros(SHAPE)
        corner[:2, :2, :2] = 1
        for of_file in (at, dict(origin=at["origin"])):
            numpy.testing.assert_array_equal(self.phi(self.hdf5(solid, **of_file), "-part_voxels_spacing", ".1,.1,.1"), corner)
        numpy.testing.assert_array_equal(self.phi(self.hdf5(solid, **at), "-part_voxels_spacing", ".1,.1,.1",
                                                  "-part_voxels_origin", ".1,.3,.2"), wanted)

    def test_hdf5_of_others(self):
        """A user block, as MATLAB's; the only dataset in whatever group, also behind a soft link."""
        mask = RANDOM.random(SHAPE) < .3
        for block in (512, 4096):
            with h5py.File(self.room / "block.mat", "w", userblock_size=block) as file:
                file["wall"] = mask
                file["#refs#/a"] = 1
            data = bytearray((self.room / "block.mat").read_bytes())
            data[:19] = b"MATLAB 7.3 MAT-file"
            numpy.testing.assert_array_equal(self.phi(self.write("block.mat", bytes(data))), mask)
        with h5py.File(self.room / "group.h5", "w") as file:
            file["ITKImage/0/VoxelData"] = mask
            file["wall"] = h5py.SoftLink("/ITKImage/0/VoxelData")
        for name in ("group.h5", "group.h5:wall", "group.h5:ITKImage/0/VoxelData"):
            numpy.testing.assert_array_equal(self.phi(name), mask)
        self.refused(*RUN, *BODY, "group.h5:ITKImage", says=["no dataset ITKImage; accepted: ITKImage/0/VoxelData"])
        with h5py.File(self.room / "two.h5", "w") as file:
            file["solid_fraction/x"], file["b/c"] = mask, mask
        self.refused(*RUN, *BODY, "two.h5", says=["several datasets", "one of b/c, solid_fraction/x"])
        with h5py.File(self.room / "none.h5", "w") as file:
            file.create_group("solid_fraction")
        self.refused(*RUN, *BODY, "none.h5", says=["none.h5 has no datasets"])

    def test_nrrd(self):
        mask, fraction = RANDOM.random(SHAPE) < .3, RANDOM.random(SHAPE)
        fraction[fraction < .2] = 0
        for encoding in ("raw", "gzip", "ascii"):
            for dtype in ("<f8", ">f8", "<f4", "<i2", ">i2", "u1", "<u8") if encoding == "raw" else (">f4", "u1"):
                with self.subTest(encoding=encoding, dtype=dtype):
                    real = "f" in dtype
                    name = self.write("v.nrrd", nrrd((fraction if real else mask * 7).astype(dtype), encoding))
                    numpy.testing.assert_allclose(self.phi(name), fraction if real else mask,
                                                  atol=1e-7 if "f4" in dtype else 1e-12)
        one = nrrd(numpy.ones((1, 1, 1), "u1"), endian=None, space_dimension=3, space_origin="(0.25,0.35,0.45)",
                   space_directions="(0.1,0,0) (0,0.1,0) (0,0,0.1)")
        wanted = numpy.zeros(SHAPE)
        wanted[4, 3, 2] = 1
        numpy.testing.assert_array_equal(self.phi(self.write("v.nrrd", one)), wanted)

    def test_nrrd_of_others(self):
        """Round-off in the directions, kinds, a byte-order mark, data in a file of their own."""
        solid = numpy.ones((2, 2, 2), "u1")
        wanted = numpy.zeros(SHAPE)
        wanted[2:4, 3:5, 1:3] = 1
        at = dict(space="left-posterior-superior", space_origin="(.15,.35,.25)", kinds="domain domain space",
                  space_directions="(.1,0,0) (0,.1,-1.2246467991473532e-17) (0,6.123e-18,.1)")
        whole = nrrd(solid, **at)
        for content in (whole, b"\xef\xbb\xbf" + whole):
            numpy.testing.assert_array_equal(self.phi(self.write("v.dat", content)), wanted)
        (self.room / "data").mkdir()
        for encoding, end in (("raw", b"\n"), ("gzip", b""), ("ascii", b"\n\n")):
            head, data = nrrd(solid, encoding, data_file="values.bin", **at).split(b"\n\n", 1)
            self.write("data/values.bin", data)
            numpy.testing.assert_array_equal(self.phi(self.write("data/v.nhdr", head + end)), wanted)
        self.write("data/values.bin", b"short")
        self.refused(*RUN, *BODY, "data/v.nhdr", says=["data/v.nhdr", "do not fit into what the file holds"])
        (self.room / "data/values.bin").unlink()
        self.refused(*RUN, *BODY, "data/v.nhdr", says=["data/v.nhdr: its data file data/values.bin is not a file"])

    def test_stl(self):
        wanted = numpy.zeros(SHAPE)
        wanted[2:5, 3:6, 1:4] = 1
        wanted[2:5, 3:6, 4] = .5
        low, high = [.125, .375, .25], [.5625, .75, .625]
        grid = [*RUN[:2], "-grid_length", "1.5,1.25,1", *RUN[4:]]  # h = 1/8: exact in single precision
        for content in (binary(box_stl(low, high)), ascii_stl(box_stl(low, high))):
            name = self.write("v.STL", content)
            numpy.testing.assert_allclose(self.phi(name, grid=grid), wanted, atol=1e-12)
        # As others write them, and whatever the name is.
        plain, text = binary(box_stl(low, high)), ascii_stl(box_stl(low, high))
        parts = box_stl(low, [.25, .75, .625]), box_stl([.375, *low[1:]], high)
        for content in (text.upper(), b"\xef\xbb\xbf" + text, b"\r\n  " + text, text.replace(b"\n", b"\r"), text + b"\x1a\0\0",
                        text.replace(b"solid", b"Solid"), plain + 16 * b"x", plain + 1000 * b"\0"):
            numpy.testing.assert_allclose(self.phi(self.write("v.dat", content), grid=grid), wanted, atol=1e-12)
        wanted_parts = wanted.copy()
        wanted_parts[:, :, 2] = 0
        for write in (binary, ascii_stl):
            name = self.write("v.dat", write(parts[0]) + write(parts[1]))
            numpy.testing.assert_allclose(self.phi(name, grid=grid), wanted_parts, atol=1e-12)
        scaled = self.phi(self.write("v.stl", binary(box_stl([0, 0, 0], [3.5, 3, 3]))), "-part_voxels_origin",
                          ".125,.375,.25", "-part_voxels_spacing", ".125,.125,.125", grid=grid)
        numpy.testing.assert_allclose(scaled, wanted, atol=1e-12)

    def test_two_dimensions(self):
        flat = ["-grid_cells", "12,10,1", "-grid_length", "1.2,1,1", *RUN[4:]]
        mask = RANDOM.random(SHAPE[1:]) < .3
        for values in (mask, mask[None]):
            numpy.testing.assert_array_equal(self.phi(self.hdf5(values), grid=flat)[0], mask)
        self.refused(*flat, *BODY, self.hdf5(numpy.ones(SHAPE)), says=["-part_voxels", "8 voxels in z"])
        extruded = self.phi(self.hdf5(mask))
        numpy.testing.assert_array_equal(extruded, numpy.broadcast_to(mask, SHAPE))

    def test_same_start_on_two_ranks(self):
        with h5py.File(ROOT / "options/branched_vessel.h5") as file:
            name = self.hdf5(file["solid_fraction"][...])
        numpy.testing.assert_array_equal(self.phi(name, ranks=2), self.phi(name))

    def seeded(self, name, *options, ranks=1):
        """phi of a vessel from a file and of cells at random in it, at the start, and what -check_only says."""
        line = ["-grid_cells", "48,32,16", "-grid_length", "48,32,16", "-boundary_y", "wall", "-time_end", "1e-3",
                "-time_steps_max", "1", "-species", "part,cell", *BODY[2:], name, "-cell_shape", "ellipsoid",
                "-cell_semi_axes", "1.5,1.5,1", "-cell_shear_modulus", "1", "-cell_placement", "random",
                "-cell_orientation", "random", *options]
        run = self.run_case(*line, "-snapshot_interval", "1", "-snapshot_fields", "solid_fraction,body",
                            "-snapshot_precision", "double", ranks=ranks)
        says = self.start(*line, "-check_only").stdout
        return (*(run.snapshots[0][f"solid_fraction_{n}"][...] for n in ("part", "cell")), says)

    def test_bodies_at_random_keep_out_of_a_vessel_from_a_file(self):
        """No cell holds a part of both; the hematocrit is that of what the vessel leaves; any ranks, the same places."""
        subprocess.run([ROOT / "scripts/make_vessel", self.room / "v.stl"], check=True, timeout=120)
        for name, options in ((ROOT / "options/branched_vessel.h5", ()), ("v.stl", ("-part_voxels_invert",))):
            with self.subTest(name):
                vessel, cells, says = self.seeded(name, "-cell_hematocrit", ".1", *options)
                count = round(.1 * (1 - vessel).sum() / (3 * numpy.pi))
                self.assertGreater(count, 10)
                self.assertAlmostEqual(cells.sum(), count * 3 * numpy.pi, delta=.02 * cells.sum())
                self.assertEqual(((vessel > 0) & (cells > 0)).sum(), 0)
                self.assertIn(f"species cell: {count} bodies", says)
                self.assertIn(f"species part: 1 bodies of volume {vessel.sum():.6g}", says)
                on_three = self.seeded(name, "-cell_hematocrit", ".1", "-cell_inside", "part", *options, ranks=3)
                numpy.testing.assert_array_equal(on_three[1], cells)
        self.hdf5(numpy.ones(SHAPE))
        for inside, says in (("other", "other is not a species of tubes or voxels"), ("part", "0 could be placed, hematocrit 0;")):
            self.refused(*RUN, "-species", "part,cell", *BODY[2:], "v.h5", "-cell_shape", "sphere", "-cell_radius", ".1",
                         "-cell_shear_modulus", "1", "-cell_placement", "random", "-cell_count", "2", "-cell_inside",
                         inside, says=["-cell_", says])

    def test_bodies_placed_in_the_solid_are_a_warning(self):
        """The lower half is solid, up to y = .5; the second body is 0.06 deep in it, the first one touches it."""
        solid = numpy.zeros(SHAPE)
        solid[:, :5] = 1
        self.hdf5(solid)
        volume = numpy.pi * .06 ** 2 * (.6 - .06) / 3  # of the cap
        scene = [*RUN, "-species", "cell,part", *BODY[2:], "v.h5", "-cell_shape", "sphere", "-cell_radius", ".2",
                 "-cell_shear_modulus", "1", "-cell_placement", "list", "-cell_positions", "p.csv"]
        said = set()
        self.write("p.csv", b".3,.7,.4\n.9,.64,.4\n")
        for ranks in (1, 2, 3):
            for text in (self.start(*scene, ranks=ranks).stderr, self.start(*scene, "-check_only", ranks=ranks).stdout):
                said.add(re.search(r"warning: .*overlap.*$", text, re.MULTILINE)[0])
        self.assertEqual(len(said), 1, said)
        found = re.fullmatch(r"warning: 2 bodies overlap as placed; first body 2 \(cell\) and body 3 \(part\), which share a "
                             r"volume of at least (\S+), (\S+) % of body 2; correct -cell_positions, or use "
                             r"-cell_placement random", said.pop())
        self.assertAlmostEqual(float(found[1]), volume, delta=.02 * volume)
        self.assertAlmostEqual(float(found[2]), 100 * volume / (4 / 3 * numpy.pi * .008), delta=.3)
        self.write("p.csv", b".3,.7,.4\n.9,.7,.4\n")
        self.assertEqual(self.start(*scene).stderr, "")
        for attached in ("-cell_anchored", "true", "-part_anchored", "true"), ("-part_voxels_invert",):
            other = self.start(*scene, *attached, "-check_only").stdout
            self.assertEqual("overlap" in other, len(attached) == 1)

    def test_the_example_is_what_its_script_makes(self):
        for suffix in ("h5", "nrrd", "stl"):
            subprocess.run([ROOT / "scripts/make_vessel", self.room / f"made.{suffix}"], check=True, timeout=120)
        subprocess.run([ROOT / "scripts/make_vessel", self.room / "lumen.stl", "--bifurcation"], check=True, timeout=120)
        self.assertEqual((self.room / "lumen.stl").read_bytes(), (ROOT / "options/bifurcation.stl").read_bytes())
        with h5py.File(ROOT / "options/branched_vessel.h5") as old, h5py.File(self.room / "made.h5") as new:
            fraction = old["solid_fraction"][...]
            numpy.testing.assert_array_equal(fraction, new["solid_fraction"][...])
        grid = ["-grid_cells", "48,32,16", "-grid_length", "48,32,16", *RUN[4:]]
        numpy.testing.assert_array_equal(self.phi("made.nrrd", grid=grid), fraction)
        volume = self.phi("made.stl", grid=grid).sum()
        self.assertAlmostEqual(volume / (numpy.pi * 48 * 32 * 16 / 48), 1, delta=.02)  # 24 x 48 flat faces

    def test_hdf5_refusals(self):
        good = numpy.full(SHAPE, .5)
        bad, nan = good.copy(), good.copy()
        bad[7, 9, 11], nan[1, 2, 3] = 1.5, numpy.nan
        for values, says, at in [
                (bad, ["[7, 9, 11] is 1.5", "0 ... 1"], {}), (-good, ["is -0.5"], {}), (nan, ["[1, 2, 3] is nan"], {}),
                (good[0, 0], ["1 dimensions"], {}), (good[None], ["4 dimensions"], {}),
                (numpy.zeros((0, 3, 3)), ["no values"], {}), (good.astype("c16"), ["floating-point numbers"], {}),
                (numpy.zeros(SHAPE), ["nothing solid"], {}), (good, ["spacing"], {"spacing": [1, 1]}),
                (good, ["spacing"], {"spacing": [.1, 0, .1]}), (good, ["spacing"], {"spacing": "three"}),
                (good, ["origin"], {"origin": [0, 0, numpy.inf]}),
                (good, ["outside the box"], {"origin": [5., 0, 0], "spacing": [.1, .1, .1]}),
                (good, ["origin without a spacing"], {"origin": [0., 0, 0]})]:
            with self.subTest(says):
                self.refused(*RUN, *BODY, self.hdf5(values, **at), says=["-part_voxels: v.h5", *says])
        rigid = "-species part -part_law rigid -part_shape voxels -part_voxels".split()
        for check in ([], ["-check_only"]):
            for values, body, says in ((0, BODY, "nothing solid"), (1, rigid, "fills all of the box")):
                self.refused(*RUN, *body, self.hdf5(numpy.full(SHAPE, values)), *check, says=["-part_voxels: v.h5", says])
        self.refused(*RUN, *BODY, "v.h5:other", says=["no dataset other", "mask"])
        self.refused(*RUN, *BODY, "no.h5:mask", says=["no.h5 is not a file"])
        self.refused(*RUN, *BODY, "v.h5", "-part_placement", "lattice", says=["-part_placement", "voxels"])
        self.refused(*RUN, *BODY, "v.h5", "-part_voxels_spacing", "1,0,1", says=["-part_voxels_spacing", "> 0"])
        self.refused(*RUN, *BODY, self.hdf5(bad), ranks=3, says=["[7, 9, 11] is 1.5"])
        with h5py.File(self.room / "lie.h5", "w") as file:
            file.create_dataset("m", (10**6, 10**6, 10**6), "u1", chunks=(10, 10, 10), compression="gzip")
            file["m"][0, 0, 0] = 1
        self.refused(*RUN, *BODY, "lie.h5", says=["do not fit", "truncated or damaged"])
        with h5py.File(self.room / "two.h5", "w") as file:
            file["a"], file["b"] = good, good
        self.refused(*RUN, *BODY, "two.h5", "-check_only", says=["several datasets", "two.h5:DATASET", "a, b"])
        whole = (self.room / self.hdf5(good)).read_bytes()
        for part, says in ((whole[:-100], "truncated"), (b"", "empty"), (b"x" + whole[1:], "not an HDF5, NRRD or STL")):
            self.refused(*RUN, *BODY, self.write("v.h5", part), says=["v.h5", says])

    def test_nrrd_refusals(self):
        good = numpy.full(SHAPE, .5, "<f4")
        for fields, says in [
                (dict(encoding="hex"), "raw, gzip, ascii"), (dict(type="block"), "float, double"),
                (dict(endian=None), "little or big"), (dict(dimension=4), "2 or 3"), (dict(sizes="12 10"), "3 integers"),
                (dict(sizes="12 10 9"), "do not fit"), (dict(sizes="12 10 -8"), "3 integers"),
                (dict(sizes="4294967297 1 1"), "4294967297 voxels in x"),
                (dict(sizes="1000000 1000000 1000000"), "do not fit"), (dict(data_file="v.raw"), "one file, beside the header"),
                (dict(byte_skip="-1"), "byte skip"), (dict(axis_mins="0 0 0"), "axis mins"),
                (dict(spacings="1 1"), "3 numbers"), (dict(spacings="1 -1 1"), "> 0"),
                (dict(space_directions="(0,1,0) (1,0,0) (0,0,1)"), "along x, y, z"),
                (dict(space_directions="(1,0,0) (0,1,1e-5) (0,0,1)"), "along x, y, z"),
                (dict(kinds="RGB-color domain domain"), "axis 1 is not in space; accepted: domain or space"),
                (dict(kinds="domain domain vector"), "axis 3 is not in space"), (dict(kinds="domain domain"), "3 axes"),
                (dict(space_directions="(1,0,0) (0,1,0)"), "3 vectors"), (dict(space_origin="(0,0,0)"), "origin without a spacing")]:
            with self.subTest(says):
                self.refused(*RUN, *BODY, self.write("v.nrrd", nrrd(good, **fields)), says=["v.nrrd", says])
        packed, plain, words = (nrrd(good, e) for e in ("gzip", "raw", "ascii"))
        for content, says in ((plain[:-1], "do not fit"), (packed[:-12], "truncated"), (packed[:-3], "truncated"),
                              (packed[:-6] + b"?" + packed[-5:], "damaged"), (plain[:40], "header has no end"),
                              (words.replace(b"0.5\n", b"x\n"), "not a number"), (words[:-5], "too early"),
                              (plain.replace(b"g: raw", b"g: gzip"), "not packed by gzip")):
            with self.subTest(says):
                self.refused(*RUN, *BODY, self.write("v.nrrd", content), says=["v.nrrd", says])

    def test_stl_refusals(self):
        box = box_stl([.1, .1, .1], [.5, .5, .5])
        far = box_stl([.1, .1, 3], [.5, .5, 4])
        for content, says in ((binary(box[1:]), "3 of its 33 sides"), (binary(box)[:-10], "truncated"),
                              (binary([], 0), "no triangles"), (ascii_stl(box)[:-20], "truncated"),
                              (ascii_stl(box).replace(b"outer", b"inner", 1), "triangle 1"), (binary(far), "outside"),
                              (binary(box + box), "crosses itself"), (b"nothing", "too short"),
                              (binary(box) + 100 * b"x", "the data after its 12 triangles is not another solid"),
                              (ascii_stl(box) + b"facet", "triangle 13"),
                              (ascii_stl(box).replace(b"0.1", b"nan", 1), "triangle 1")):
            with self.subTest(says):
                self.refused(*RUN, *BODY, self.write("v.stl", content), says=["-part_voxels: v.stl", says])


if __name__ == "__main__":
    unittest.main()

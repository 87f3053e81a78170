// Bodies from files: the same bits on any number of ranks, and however they cut the box.
#include "scene/voxels.hpp"
#include "base/rank_zero.hpp"
#include "bodies/fill_phase.hpp"
#include "support/files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace eulastic {
namespace {

constexpr int nx = 23, ny = 17, nz = 9;

void write_nrrd(const std::string &path) {
  std::ofstream file(path, std::ios::binary);
  file << "NRRD0004\ntype: double\ndimension: 3\nsizes: " << nx << " " << ny << " " << nz
       << "\nencoding: raw\nendian: little\nspacings: 0.041 0.055 0.1\n\n";
  for (int n = 0; n < nx * ny * nz; ++n) {
    const double value = n % 7 == 0 ? 0 : std::fmod(n * 0.618, 1.0);
    file.write(reinterpret_cast<const char *>(&value), sizeof value);
  }
}

void write_stl(const std::string &path) {  // a tetrahedron askew
  const char *corner[] = {"0.1 0.2 0.15", "0.93 0.31 0.2", "0.4 0.91 0.33", "0.5 0.45 0.89"};
  std::ofstream file(path);
  file << "solid\n";
  for (const auto &t : {Int3{0, 2, 1}, Int3{0, 1, 3}, Int3{1, 2, 3}, Int3{0, 3, 2}}) {
    file << "facet normal 0 0 0\nouter loop\n";
    for (const int n : t) file << "vertex " << corner[n] << "\n";
    file << "endloop\nendfacet\n";
  }
  file << "endsolid\n";
}

Phase fill(const Domain &domain, const std::string &path) {
  SpeciesSpec spec;
  spec.name = "part";
  spec.shape = Shape::voxels;
  spec.voxels.path = path;
  Phase phase;
  Places places;
  EXPECT_EQ(fill_phase(domain, spec, {}, 5, &phase), 0);
  EXPECT_EQ(fill_voxels(domain, spec, 5, &phase, &places), 0);
  EXPECT_EQ(places.known.size(), 1u);
  return phase;
}

}  // namespace

TEST(Voxels, SameBitsOnAnyRanks) {
  const test::SharedDirectory room;
  if (test::world_rank() == 0) {
    write_nrrd(room / "v.nrrd");
    write_stl(room / "v.stl");
  }
  MPI_Barrier(run_communicator());
  int ranks;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const char *name : {"v.nrrd", "v.stl"})
    for (int along = -1; along < 3; ++along) {
      GridSpec spec;
      spec.cells = {20, 16, 12};
      if (along >= 0) spec.processors = {1, 1, 1}, spec.processors[along] = ranks;
      Domain whole, parts;
      ASSERT_EQ(parts.create(run_communicator(), spec), 0);
      spec.processors = {0, 0, 0};
      ASSERT_EQ(whole.create(PETSC_COMM_SELF, spec), 0);
      const Phase all = fill(whole, room / name), mine = fill(parts, room / name);
      const Int3 &b = parts.layout().begin;
      int solid = 0;
      for (const Segment &row : parts.rows())
        for (int i = row.i_begin; i < row.i_end; ++i) {
          const double a = all.fraction[0](b[0] + i, b[1] + row.j, b[2] + row.k), p = mine.fraction[0](i, row.j, row.k);
          ASSERT_EQ(std::memcmp(&a, &p, sizeof a), 0) << name << " " << a << " " << p;
          ASSERT_EQ(mine.label[0](i, row.j, row.k), a > 0 ? 5 : 0);
          solid += a > 0;
        }
      MPI_Allreduce(MPI_IN_PLACE, &solid, 1, MPI_INT, MPI_SUM, run_communicator());
      EXPECT_GT(solid, 300);
    }
}

TEST(Voxels, ErrorsOfOneRankAreEverybodys) {
  const test::SharedDirectory room;
  if (test::world_rank() == 0) {
    write_nrrd(room / "v.nrrd");
    std::fstream file(room / "v.nrrd", std::ios::in | std::ios::out | std::ios::binary);
    const double two = 2;
    file.seekp(-8, std::ios::end);
    file.write(reinterpret_cast<const char *>(&two), sizeof two);
  }
  MPI_Barrier(run_communicator());
  Domain domain;
  GridSpec spec;
  spec.cells = {20, 16, 12};
  ASSERT_EQ(domain.create(run_communicator(), spec), 0);
  SpeciesSpec species;
  species.name = "part";
  species.shape = Shape::voxels;
  species.voxels.path = room / "v.nrrd";
  Phase phase;
  Places places;
  ASSERT_EQ(fill_phase(domain, species, {}, 1, &phase), 0);
  const std::string wrong = test::error_of([&] { return fill_voxels(domain, species, 1, &phase, &places); });
  EXPECT_NE(wrong.find("-part_voxels: "), std::string::npos) << wrong;
  EXPECT_NE(wrong.find("voxel [8, 16, 22] is 2"), std::string::npos) << wrong;
}

}  // namespace eulastic

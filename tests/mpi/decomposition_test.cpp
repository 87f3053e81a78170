// Every rank's view of the decomposition: complete, disjoint, the same everywhere and the same as the DMDA's.
#include "base/rank_zero.hpp"
#include "field/field.hpp"
#include "field/global_vector.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

int world_size() {
  int size = 0;
  MPI_Comm_size(run_communicator(), &size);
  return size;
}

void check(const GridSpec &spec) {
  SCOPED_TRACE(::testing::Message() << spec.cells[0] << " x " << spec.cells[1] << " x " << spec.cells[2] << " as "
                                    << spec.processors[0] << " x " << spec.processors[1] << " x "
                                    << spec.processors[2]);
  Domain domain;
  ASSERT_EQ(domain.create(run_communicator(), spec), 0);
  const Layout &own = domain.layout();

  PetscInt x, y, z, nx, ny, nz;
  ASSERT_EQ(DMDAGetCorners(domain.dm(), &x, &y, &z, &nx, &ny, &nz), 0);
  EXPECT_EQ(own.begin, (Int3{int(x), int(y), int(z)}));
  // The face on a high side is a point of the DMDA, and belongs to the rank that touches the side.
  EXPECT_EQ((Int3{int(nx), int(ny), int(nz)}),
            (Int3{domain.points_end(0, true), domain.points_end(1, true), domain.points_end(2, true)}));
  PetscInt dimension, points[3], dof, width;
  DMBoundaryType type[3];
  DMDAStencilType stencil;
  ASSERT_EQ(DMDAGetInfo(domain.dm(), &dimension, &points[0], &points[1], &points[2], nullptr, nullptr, nullptr, &dof,
                        &width, &type[0], &type[1], &type[2], &stencil),
            0);
  EXPECT_EQ(dimension, domain.dimension());
  EXPECT_EQ(dof, 1);
  EXPECT_EQ(stencil, DMDA_STENCIL_BOX);
  EXPECT_LE(width, own.ghosts[0]);
  for (int d = 0; d < domain.dimension(); ++d) {
    EXPECT_EQ(points[d], spec.cells[d] + domain.is_wall(d));
    EXPECT_EQ(type[d], domain.is_wall(d) ? DM_BOUNDARY_GHOSTED : DM_BOUNDARY_PERIODIC);
  }

  const auto layout_of = [&spec](const Domain &of, int rank) {
    return of.split().box_of(rank, spec, of.spec().ghosts).layout();
  };
  const Layout mine = layout_of(domain, domain.rank());
  EXPECT_EQ(mine.begin, own.begin);
  EXPECT_EQ(mine.cells, own.cells);
  EXPECT_EQ(mine.size, own.size);
  EXPECT_EQ(mine.offset(1, 2, 3), own.offset(1, 2, 3));

  const Domain planned = Domain::planned(spec, domain.ranks());
  EXPECT_EQ(layout_of(planned, domain.rank()).begin, own.begin);
  EXPECT_EQ(layout_of(planned, domain.rank()).size, own.size);

  // What the split says of another rank is what that rank says of itself.
  std::vector<int> sizes(domain.ranks());
  const int size = static_cast<int>(own.size);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, run_communicator());

  const Int3 &n = domain.domain_cells();
  std::vector<int> times(static_cast<std::size_t>(n[0]) * n[1] * n[2]);
  int wrong_owner = 0;
  for (int rank = 0; rank < domain.ranks(); ++rank) {
    const Layout layout = layout_of(domain, rank);
    EXPECT_EQ(layout.size, sizes[rank]);
    for (int k = layout.begin[2]; k < layout.begin[2] + layout.cells[2]; ++k)
      for (int j = layout.begin[1]; j < layout.begin[1] + layout.cells[1]; ++j)
        for (int i = layout.begin[0]; i < layout.begin[0] + layout.cells[0]; ++i) {
          ++times.at(i + n[0] * (j + static_cast<std::size_t>(n[1]) * k));
          wrong_owner += domain.owner(i, j, k) != rank;
        }
    // Index N belongs to the owner of N - 1.
    const Int3 end{layout.begin[0] + layout.cells[0], layout.begin[1] + layout.cells[1],
                   layout.begin[2] + layout.cells[2]};
    wrong_owner += end == n && domain.owner(n[0], n[1], n[2]) != rank;
    wrong_owner += end[1] == n[1] && domain.owner(layout.begin[0], n[1], layout.begin[2]) != rank;
    for (int d = 0; d < 3; ++d) {
      const int part = n[d] / domain.processors(d);
      if (spec.cells[d] < 256 * domain.processors(d) || d > 0) {
        EXPECT_TRUE(layout.cells[d] == part || layout.cells[d] == part + 1) << "uneven";
      } else {
        EXPECT_EQ(layout.begin[d] % 256, 0);
        EXPECT_LT(std::abs(layout.cells[d] - double(n[d]) / domain.processors(d)), 256 + 1e-9);
      }
    }
  }
  EXPECT_EQ(wrong_owner, 0);
  EXPECT_EQ(times, std::vector<int>(times.size(), 1));
}

TEST(Decomposition, CoversEveryCellOnceAndAgreesWithTheDmda) {
  const int ranks = world_size();
  int tried = 0, split_x = 0;
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{5, 9, 7}, Int3{17, 12, 1}, Int3{1030, 3, 3}, Int3{1537, 4, 1}})
    for (const Boundary y : {Boundary::periodic, Boundary::wall})
      for (int px = 0; px <= ranks; ++px)
        for (int py = 0; py <= ranks; ++py) {
          GridSpec spec;
          spec.cells = cells;
          spec.boundary = {Boundary::periodic, y, Boundary::wall};
          spec.processors = {px, py, 0};
          if (!Domain::refusal_reason(spec, ranks).empty()) continue;
          check(spec);
          ++tried;
          split_x += px > 1;
        }
  EXPECT_GE(tried, 10);
  EXPECT_GE(split_x, ranks > 1 ? 10 : 0);
}

// The DMDA serves narrow ranks as well, and a field comes back from a Vec that PETSc has put in its natural order: with
// the faces on high sides, and the cells alone.
TEST(Decomposition, GivesFieldsAsVectorsOfTheDmda) {
  int tried = 0;
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{17, 12, 1}, Int3{3, 12, 3}})
    for (const Boundary x : {Boundary::periodic, Boundary::wall})
      for (const bool faces : {false, true}) {
        GridSpec spec;
        spec.cells = cells;
        spec.boundary = {x, Boundary::wall, Boundary::periodic};
        if (!Domain::refusal_reason(spec, world_size()).empty()) continue;
        Domain domain;
        ASSERT_EQ(domain.create(run_communicator(), spec), 0);
        Field before(domain, 1), after(domain, 1);
        const Int3 &begin = domain.layout().begin;
        Int3 points;
        for (int d = 0; d < 3; ++d) points[d] = cells[d] + (faces && domain.is_wall(d));
        const auto truth = [&](int i, int j, int k) {
          return begin[0] + i + double(points[0]) * (begin[1] + j + double(points[1]) * (begin[2] + k));
        };
        const auto for_all = [&](const auto &visit) {
          for (int k = 0; k < domain.points_end(2, faces); ++k)
            for (int j = 0; j < domain.points_end(1, faces); ++j)
              for (int i = 0; i < domain.points_end(0, faces); ++i) visit(i, j, k);
        };
        for_all([&](int i, int j, int k) { before[0](i, j, k) = truth(i, j, k); });
        DmHandle cell_dm;
        ASSERT_EQ(domain.create_cell_dm(DMDA_STENCIL_BOX, 1, cell_dm.put()), 0);
        const DM dm = faces ? domain.dm() : cell_dm.get();
        VecHandle global, natural;
        ASSERT_EQ(DMCreateGlobalVector(dm, global.put()), 0);
        ASSERT_EQ(DMDACreateNaturalVector(dm, natural.put()), 0);
        ASSERT_EQ(to_global(domain, before[0], global.get()), 0);
        ASSERT_EQ(DMDAGlobalToNaturalBegin(dm, global.get(), INSERT_VALUES, natural.get()), 0);
        ASSERT_EQ(DMDAGlobalToNaturalEnd(dm, global.get(), INSERT_VALUES, natural.get()), 0);
        PetscInt first, end;
        const double *values;
        ASSERT_EQ(VecGetOwnershipRange(natural.get(), &first, &end), 0);
        ASSERT_EQ(VecGetArrayRead(natural.get(), &values), 0);
        for (PetscInt n = first; n < end; ++n) EXPECT_EQ(values[n - first], n);
        ASSERT_EQ(VecRestoreArrayRead(natural.get(), &values), 0);
        ASSERT_EQ(from_global(domain, global.get(), after[0]), 0);
        for_all([&](int i, int j, int k) { EXPECT_EQ(after[0](i, j, k), truth(i, j, k)); });
        ++tried;
      }
  EXPECT_GE(tried, 8);
}

}  // namespace
}  // namespace eulastic

// What comes in through a side: nothing through rigid bodies, and where it is developed the steady flow along a pipe of
// that section, -lap u = 1 on the open cells of the side with u = 0 on walls and surfaces.
#include "app/openings.hpp"
#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "grid/domain.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;

// The two directions of a side of direction d, x before y before z.
struct SidePlane {
  int a, b;
  explicit SidePlane(int d) : a(d == 0 ? 1 : 0), b(d == 2 ? 1 : 2) {}
};

// What cell (i, j) sees beyond its side `high` in direction e: another cell, or a wall, where u is odd, or neither.
struct Beyond {
  bool cell = false, wall = false;
  int index = 0;
};

Beyond beyond(const Config &config, int e, int i, bool high) {
  const int n = config.grid.cells[e], next = high ? i + 1 : i - 1;
  if (n == 1 && config.grid.boundary[e] == Boundary::periodic) return {};
  if (config.grid.boundary[e] == Boundary::periodic) return {true, false, (next + n) % n};
  if (next >= 0 && next < n) return {true, false, next};
  const SideKind kind = config.sides[e][high].kind;
  return {false, kind == SideKind::wall || kind == SideKind::inflow, 0};
}

// Cells of a side that no rigid body covers, and their links (RigidFaces::Cut) low, high along a, then b; 0: a regular
// one.
struct OpenCells {
  static constexpr int values = 5;
  std::vector<double> all;
  bool open(std::size_t cell) const { return all[values * cell] > 0; }
  double link(std::size_t cell, int which, bool high) const { return all[values * cell + 1 + 2 * which + high]; }
};

// Collective.
PetscErrorCode find_open_cells(const Config &config, const Domain &domain, const RigidFaces *rigid, int d, bool high,
                               OpenCells *cells) {
  const SidePlane plane(d);
  const int na = config.grid.cells[plane.a], nb = config.grid.cells[plane.b];
  const Int3 &n = domain.cells(), &begin = domain.layout().begin;
  PetscFunctionBeginUser;
  cells->all.assign(std::size_t(OpenCells::values) * na * nb, 0);
  if (!rigid) {
    for (std::size_t v = 0; v < cells->all.size(); v += OpenCells::values) cells->all[v] = 1;
    PetscFunctionReturn(0);
  }
  const auto values = [&](const Int3 &local) {
    const std::size_t cell = (begin[plane.a] + local[plane.a]) + std::size_t(na) * (begin[plane.b] + local[plane.b]);
    return cells->all.data() + OpenCells::values * cell;
  };
  Int3 first{}, last = n;
  if (!domain.touches(d, high)) last = {};
  first[d] = high ? n[d] : 0;
  last[d] = last[d] > 0 ? first[d] + 1 : 0;
  for (int k = first[2]; k < last[2]; ++k)
    for (int j = first[1]; j < last[1]; ++j) {
      const RigidFaces::Row row = rigid->row(d, j, k);
      for (int i = first[0]; i < last[0]; ++i) {
        double *cell = values({i, j, k});
        cell[0] = 1;
        for (const RigidFaces::Run *run = row.runs; run != row.runs_end; ++run)
          if (i >= run->begin && i < run->end) cell[0] = 0;
        for (const RigidFaces::Cut *cut = row.cuts; cut != row.cuts_end; ++cut)
          for (const int which : {0, 1})
            for (const bool up : {false, true})
              if (const int link = 2 * (which == 0 ? plane.a : plane.b) + up; cut->i == i && (cut->walls >> link & 1U))
                cell[1 + 2 * which + up] = cut->link[link];
      }
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->all.data(), static_cast<int>(cells->all.size()), MPI_DOUBLE, MPI_SUM,
                             domain.comm()));
  PetscFunctionReturn(0);
}

// The part of a side that no rigid body covers, from the solid fractions of the cells beside it. Collective.
PetscErrorCode measure_open_part(const Domain &domain, const std::vector<Phase> &phases, int d, bool high,
                                 double *part) {
  PetscFunctionBeginUser;
  ExactSums covered(1);
  for_points(domain.cells_at(d, high, 1), [&](int i, int j, int k) {
    double solid = 0;
    for (const Phase &phase : phases)
      if (phase.material.is_rigid()) solid += phase.fraction[0](i, j, k);
    covered.add(0, std::min(1.0, solid));
  });
  double sum, faces = 1;
  PetscCall(covered.reduce(domain.comm(), &sum));
  for (int e = 0; e < 3; ++e)
    if (e != d) faces *= domain.domain_cells()[e];
  *part = 1 - sum / faces;
  PetscFunctionReturn(0);
}

PetscErrorCode assemble(const Config &config, int d, const OpenCells &cells, Mat matrix, bool *held) {
  const SidePlane plane(d);
  const int n[2] = {config.grid.cells[plane.a], config.grid.cells[plane.b]};
  PetscFunctionBeginUser;
  *held = false;
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i) {
      const PetscInt row = i + PetscInt(n[0]) * j;
      if (!cells.open(row)) {
        PetscCall(MatSetValue(matrix, row, row, 1, ADD_VALUES));
        continue;
      }
      for (const int which : {0, 1}) {
        const int e = which == 0 ? plane.a : plane.b;
        const double h = config.grid.length[e] / config.grid.cells[e], coupling = 1 / (h * h);
        for (const bool high : {false, true}) {
          const Beyond other = beyond(config, e, which == 0 ? i : j, high);
          const PetscInt column = which == 0 ? other.index + PetscInt(n[0]) * j : i + PetscInt(n[0]) * other.index;
          if (const double link = cells.link(row, which, high); link > 0) {
            PetscCall(MatSetValue(matrix, row, row, link, ADD_VALUES));
            *held = true;
          } else if (other.cell) {
            PetscCall(MatSetValue(matrix, row, column, -coupling, ADD_VALUES));
            PetscCall(MatSetValue(matrix, row, row, coupling, ADD_VALUES));
          } else if (other.wall) {
            PetscCall(MatSetValue(matrix, row, row, 2 * coupling, ADD_VALUES));
            *held = true;
          } else {
            PetscCall(MatSetValue(matrix, row, row, 0, ADD_VALUES));
          }
        }
      }
    }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

PetscErrorCode develop(const Config &config, int d, const OpenCells &open, SideProfile *profile) {
  const SidePlane plane(d);
  const PetscInt cells = PetscInt(config.grid.cells[plane.a]) * config.grid.cells[plane.b];
  MatHandle matrix;
  KspHandle solver;
  VecHandle one, flow;
  PC pc;
  bool held;
  const double *values;
  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, cells, cells, 5, nullptr, matrix.put()));
  PetscCall(MatSetOption(matrix.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(assemble(config, d, open, matrix.get(), &held));
  if (!held) PetscFunctionReturn(0);
  PetscCall(MatCreateVecs(matrix.get(), flow.put(), one.put()));
  for (PetscInt cell = 0; cell < cells; ++cell) PetscCall(VecSetValue(one.get(), cell, open.open(cell), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(one.get()));
  PetscCall(VecAssemblyEnd(one.get()));
  PetscCall(KSPCreate(PETSC_COMM_SELF, solver.put()));
  PetscCall(KSPSetOperators(solver.get(), matrix.get(), matrix.get()));
  PetscCall(KSPSetType(solver.get(), KSPPREONLY));
  PetscCall(KSPGetPC(solver.get(), &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(KSPSolve(solver.get(), one.get(), flow.get()));
  PetscCall(VecGetArrayRead(flow.get(), &values));
  profile->assign(values, values + cells);
  PetscCall(VecRestoreArrayRead(flow.get(), &values));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode shape_profiles(const Config &config, const Domain &domain, const RigidFaces *rigid,
                              const std::vector<Phase> &phases, BoxSides *sides, std::string *wrong) {
  PetscFunctionBeginUser;
  for (int d = 0; d < 3; ++d)
    for (const bool high : {false, true}) {
      Side &side = (*sides)[d][high];
      const bool developed = config.openings[d][high].profile == "developed";
      if (side.kind != SideKind::inflow || !(developed || rigid)) continue;
      OpenCells open;
      PetscCall(find_open_cells(config, domain, rigid, d, high, &open));
      SideProfile profile;
      if (developed) PetscCall(develop(config, d, open, &profile));
      if (profile.empty() && side.profile) profile = *side.profile;
      if (profile.empty()) profile.assign(open.all.size() / OpenCells::values, 1);
      double sum = 0;
      for (std::size_t cell = 0; cell < profile.size(); ++cell) sum += profile[cell] *= open.open(cell);
      if (!(std::fabs(sum) > 0)) {
        *wrong = std::string("-boundary_") + "xyz"[d] + (high ? "max" : "min") +
                 ": inflow, but rigid bodies cover what would come in; accepted: a side that is open";
        PetscFunctionReturn(0);
      }
      // A flow rate is that of the whole side, a velocity the mean over its open part.
      double part = 1;
      if (!config.openings[d][high].velocity.empty()) PetscCall(measure_open_part(domain, phases, d, high, &part));
      for (double &value : profile) value *= part * double(profile.size()) / sum;
      side.profile = std::make_shared<const SideProfile>(std::move(profile));
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic

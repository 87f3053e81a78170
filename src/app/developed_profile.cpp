// The steady flow along a pipe of any section, on the cells of a side: -lap u = 1 with u = 0 on walls.
#include "app/openings.hpp"
#include "base/petsc.hpp"

#include <petscksp.h>

#include <algorithm>

namespace eulastic {
namespace {

using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;
using VecHandle = Handle<Vec, VecDestroy>;

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

PetscErrorCode assemble(const Config &config, int d, Mat matrix, bool *held) {
  const SidePlane plane(d);
  const int n[2] = {config.grid.cells[plane.a], config.grid.cells[plane.b]};
  PetscFunctionBeginUser;
  *held = false;
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i) {
      const PetscInt row = i + PetscInt(n[0]) * j;
      for (const int which : {0, 1}) {
        const int e = which == 0 ? plane.a : plane.b;
        const double h = config.grid.length[e] / config.grid.cells[e], coupling = 1 / (h * h);
        for (const bool high : {false, true}) {
          const Beyond other = beyond(config, e, which == 0 ? i : j, high);
          const PetscInt column = which == 0 ? other.index + PetscInt(n[0]) * j : i + PetscInt(n[0]) * other.index;
          if (other.cell) {
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

PetscErrorCode develop(const Config &config, int d, SideProfile *profile) {
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
  PetscCall(assemble(config, d, matrix.get(), &held));
  if (!held) PetscFunctionReturn(0);
  PetscCall(MatCreateVecs(matrix.get(), flow.put(), one.put()));
  PetscCall(VecSet(one.get(), 1));
  PetscCall(KSPCreate(PETSC_COMM_SELF, solver.put()));
  PetscCall(KSPSetOperators(solver.get(), matrix.get(), matrix.get()));
  PetscCall(KSPSetType(solver.get(), KSPPREONLY));
  PetscCall(KSPGetPC(solver.get(), &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(KSPSolve(solver.get(), one.get(), flow.get()));
  PetscCall(VecGetArrayRead(flow.get(), &values));
  profile->assign(values, values + cells);
  PetscCall(VecRestoreArrayRead(flow.get(), &values));
  double sum = 0;
  for (const double value : *profile) sum += value;
  for (double &value : *profile) value *= double(cells) / sum;
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode develop_profiles(const Config &config, BoxSides *sides) {
  PetscFunctionBeginUser;
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      Side &side = (*sides)[d][high];
      if (side.kind != SideKind::inflow || config.openings[d][high].profile != "developed") continue;
      SideProfile profile;
      PetscCall(develop(config, d, &profile));
      side.profile = std::make_shared<const SideProfile>(std::move(profile));
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic

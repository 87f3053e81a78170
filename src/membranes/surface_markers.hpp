// Markers on membranes: material points that move with the flow and know where they were when the membrane was at rest,
// so that its strain does not fade; docs/method.md, section 18.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "field/surface_marker.hpp"
#include "grid/domain.hpp"
#include "membranes/surface_cells.hpp"

#include <vector>

namespace eulastic {

class SurfaceMarkers {
public:
  /// Ghosts of the velocity that move() reads, as long as nothing moves further than a cell.
  static constexpr int velocity_ghosts = 4;
  /// Cells along each direction: those whose markers a cell's strain comes from, at most.
  static constexpr int reach = 3;
  explicit SurfaceMarkers(const Domain &domain) : box_(&domain), domain_(&domain) {}
  /// In a box that is whole on this rank: no cell is wrapped around periodic sides.
  explicit SurfaceMarkers(const Box &box) : box_(&box), domain_(nullptr) {}

  /// One more at the surface beside each of the owned cells nearest to it, of the body `label`, or of all: the strain
  /// of the phase is now that against their rest. `number`: of the phase; `fields` as SurfaceCells left them.
  void place(const SurfaceCells &surface, const Field &fields, const Phase &phase, int number, int label,
             std::vector<SurfaceMarker> *markers) const;
  /// Over dt, by the midpoint rule in a flow that stays. On the grid collective: each goes to the rank that owns its
  /// cell, copies to those nearby.
  PetscErrorCode move(double dt, const Field &velocity, std::vector<SurfaceMarker> *markers);
  struct Strain {
    std::size_t cell;  ///< position among those of the surface
    std::array<double, 6> B;
  };
  /// After move(): of the owned nearest cells where markers tell.
  void find_strain(const SurfaceCells &surface, int phase, std::vector<Strain> *strains);
  /// Takes those of a phase nearer to its surface, and out what is far from it. `fields` as SurfaceCells left them.
  void settle(const SurfaceCells &surface, const Field &fields, int phase, std::vector<SurfaceMarker> *markers) const;
  /// Each to the phase that its body is in now, those of bodies that are gone away; labels with one layer of ghosts.
  void follow(const std::vector<Phase> &phases, std::vector<SurfaceMarker> *markers) const;
  /// Collective: each to the rank that owns its cell.
  PetscErrorCode send_home(std::vector<SurfaceMarker> *markers) const;

private:
  struct Near {
    std::ptrdiff_t at;  ///< its cell, offset from the origin
    int marker;         ///< of all_
  };
  PetscErrorCode exchange(std::vector<SurfaceMarker> *markers);
  /// By a part of its distance from the surface; whether that is known.
  bool approach(const SurfaceCells &surface, const Field &fields, double part, SurfaceMarker *marker) const;
  void sort(const SurfaceCells &surface, int phase);

  Int3 local_cell(const SurfaceMarker &marker) const;
  int in_domain(int d, int index) const;
  void renew_cell(SurfaceMarker *marker) const;

  const Box *box_;
  const Domain *domain_;            ///< null in a box of its own
  std::vector<SurfaceMarker> all_;  ///< since move(): owned ones and those near owned cells
  std::vector<Near> near_;          ///< of the phase that is worked on, by their place in memory
  std::vector<int> begin_;          ///< of those at every offset from the memory's start, and the end
};

}  // namespace eulastic

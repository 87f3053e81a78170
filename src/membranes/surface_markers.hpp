// Markers on membranes: material points that move with the flow and store their undeformed position, so that the strain
// of the membrane does not decay; docs/method.md, section 18.
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
  /// Ghost layers of the velocity that move() reads, if no marker moves further than a cell.
  static constexpr int velocity_ghosts = 4;
  /// Largest distance in cells, along each direction, of the markers that determine the strain of a cell.
  static constexpr int reach = 3;
  explicit SurfaceMarkers(const Domain &domain) : box_(&domain), domain_(&domain) {}
  /// For a box that is complete on this rank: cells are not wrapped around periodic boundaries.
  explicit SurfaceMarkers(const Box &box) : box_(&box), domain_(nullptr) {}

  /// Adds a marker at the surface beside each owned nearest cell of the body `label`, or of all bodies if `label` is 0.
  /// Its rest position is the present one, and its metric is that of the present strain. `number`: index of the phase;
  /// `fields` as SurfaceCells::find() left them.
  void place(const SurfaceCells &surface, const Field &fields, const Phase &phase, int number, int label,
             std::vector<SurfaceMarker> *markers) const;
  /// Moves markers over dt by the midpoint rule in a constant flow. On the grid this is collective: each marker is sent
  /// to the rank that owns its cell, and copies to the ranks nearby.
  PetscErrorCode move(double dt, const Field &velocity, std::vector<SurfaceMarker> *markers);
  struct Strain {
    std::size_t cell;  ///< index in SurfaceCells::all()
    std::array<double, 6> B;
  };
  /// Computes the strain at owned nearest cells where the markers determine it. Call after move().
  void find_strain(const SurfaceCells &surface, int phase, std::vector<Strain> *strains);
  /// Pulls the markers of a phase towards its surface and removes those far from it. `fields` as SurfaceCells::find()
  /// left them.
  void pull_to_surface(const SurfaceCells &surface, const Field &fields, int phase,
                       std::vector<SurfaceMarker> *markers) const;
  /// Assigns each marker to the present phase of its body and removes markers of bodies that have left. Reads one ghost
  /// of labels.
  void update_phases(const std::vector<Phase> &phases, std::vector<SurfaceMarker> *markers) const;
  /// Sends each marker to the rank that owns its cell. Collective.
  PetscErrorCode send_to_owners(std::vector<SurfaceMarker> *markers) const;

private:
  struct Near {
    std::ptrdiff_t at;  ///< offset of its cell from the origin
    int marker;         ///< index in all_
  };
  PetscErrorCode exchange(std::vector<SurfaceMarker> *markers);
  /// Moves a marker by `part` of its distance towards the surface; returns false if the distance is not known.
  bool approach(const SurfaceCells &surface, const Field &fields, double part, SurfaceMarker *marker) const;
  void sort(const SurfaceCells &surface, int phase);

  Int3 local_cell(const SurfaceMarker &marker) const;
  int in_domain(int d, int index) const;
  void update_cell(SurfaceMarker *marker) const;

  const Box *box_;
  const Domain *domain_;            ///< null in a box of its own
  std::vector<SurfaceMarker> all_;  ///< since move(): owned markers and those near owned cells
  std::vector<Near> near_;          ///< markers of the phase being processed, by position in memory
  std::vector<int> begin_;          ///< first index in near_ for every offset from the start of memory, and the end
};

}  // namespace eulastic

// The cells around the surface of a phase, with normal, distance and delta of the surface from the smoothed phi, and
// the extrapolation of tensors from the cells nearest to the surface; docs/method.md, section 18.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"

namespace eulastic {

class SurfaceCells {
public:
  /// Layers around the nearest cells, neighbours at corners included: as far as WENO5 reads and delta extends.
  static constexpr int layers = 3;
  struct Cell {
    Int3 place;
    std::ptrdiff_t at;  ///< offset from the origin
    Real3 normal;       ///< outward, of length 1
    double distance;    ///< from the surface, positive outside
    double delta;       ///< of the surface, 1/length
    double spread;      ///< delta with which the force is spread, (26a), 1/length
    int layer;          ///< 0: nearest cells
    bool owned;
  };

  /// The objects in `place` must outlive this.
  explicit SurfaceCells(const PhaseDomain &place) : place_(place) {}
  /// Components of `fields` after find(), ghosts included: smoothed phi, which is 0 within two cells around the rows of
  /// the phase; levels of the surface; and two step functions across it, whose slopes are delta and spread.
  static constexpr int work_fields = 4;
  enum Scratch { smoothed, level, sharp, spread };
  /// Finds the surface from phi with five ghosts. Collective on the grid.
  PetscErrorCode find(const Phase &phase, Field &fields);
  /// Returns phi of the phase as the surface is found from it: a body ends at a solid boundary, although phi continues
  /// behind it. If the body is beside one, `copy` is overwritten and returned.
  ConstView fraction_within_walls(const Phase &phase, View copy) const;
  /// The nearest cells first, then the layers around them. Nearest cells include up to four ghost layers, each further
  /// layer one less.
  const std::vector<Cell> &all() const { return cells_; }
  std::size_t nearest_count() const { return first_[1]; }
  /// Distance from the surface of a point at `offset` (in cells, at most 1) from the centre of a cell of all().
  /// `fields` as find() left them.
  double distance_at(const Field &fields, const Cell &cell, const Real3 &offset) const;
  /// Returns the largest principal curvature times the grid spacing (at most a half) in the owned nearest cells of this
  /// rank. `fields` as find() left them.
  double sharpest(const Field &fields) const;
  /// Index in all() of the cell at an offset from the origin; -1 if there is none.
  int number(std::ptrdiff_t at) const { return number_[place_.box->layout().origin + at]; }
  /// Fills the layers and three ghosts of a tensor, all of whose components are at centres, from the nearest cells.
  PetscErrorCode extend(const Phase &phase, Field &tensor) const;
  /// Labels of the bodies that owned cells belong to, in the order of all(); a layer takes them from its neighbours in
  /// the layer before. `scratch`: one component of work space. Collective on the grid.
  PetscErrorCode find_labels(const Phase &phase, Field &scratch, std::vector<int> *labels) const;

private:
  Box::Range near_box(const Phase &phase, int d, int ghosts) const;
  bool is_beside_solid_side(const Phase &phase) const;
  PetscErrorCode find_level(const Phase &phase, Field &fields);
  void find_nearest(const Phase &phase, ConstView levels);
  void find_layers(const Phase &phase);
  void measure_cell(const Field &fields, Cell *cell) const;
  double width(const Real3 &normal) const;
  PetscErrorCode exchange(const Phase &phase, Field &tensor, int width) const;

  PhaseDomain place_;
  std::vector<Cell> cells_;
  std::array<std::size_t, layers + 2> first_{};  ///< of every layer
  std::vector<int> number_;                      ///< number of the cell at an offset from the start of memory, -1: none
};

}  // namespace eulastic

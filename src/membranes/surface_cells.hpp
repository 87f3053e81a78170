// The cells around the surface of a phase: normal, distance and delta of the surface from a smoothed solid fraction,
// and what lives on the surface extended from the cells nearest to it; docs/method.md, section 18.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"

namespace eulastic {

class SurfaceCells {
public:
  /// Around the cells at the surface, neighbours at corners included: as far as WENO5 reads and delta reaches.
  static constexpr int layers = 3;
  struct Cell {
    Int3 place;
    std::ptrdiff_t at;  ///< offset from the origin
    Real3 normal;       ///< outward, unit
    double distance;    ///< from the surface, positive outside
    double delta;       ///< of the surface, 1/length
    double spread;      ///< delta that spreads the force: the velocity at the surface is as if it had no width
    int layer;          ///< 0: nearest
    bool owned;
  };

  /// What `place` points to must outlive this.
  explicit SurfaceCells(const PhasePlace &place) : place_(place) {}
  /// Of the work space, and what find() leaves there, ghosts included: phi smoothed, 0 within two cells around the rows
  /// of the phase, levels of the surface, and two steps across it, whose slopes are delta and spread.
  static constexpr int work_fields = 4;
  enum Scratch { smoothed, level, sharp, spread };
  /// Five ghosts of phi.
  PetscErrorCode find(const Phase &phase, Field &fields);
  /// Those at the surface first, then the layers around them: up to four layers of ghosts of the former, one less with
  /// every layer.
  const std::vector<Cell> &all() const { return cells_; }
  std::size_t nearest() const { return first_[1]; }  ///< how many
  /// Of a point so many cells from the centre of one of all(), a cell at most; `fields` as find() left them.
  double distance_at(const Field &fields, const Cell &cell, const Real3 &offset) const;
  /// Which of all() lies at an offset from the origin; -1: none.
  int number(std::ptrdiff_t at) const { return number_[place_.box->layout().origin + at]; }
  /// Fills layers and three ghosts of a tensor whose components all live at centres from the nearest cells.
  PetscErrorCode extend(const Phase &phase, Field &tensor) const;
  /// The bodies that owned cells belong to, in the order of all(): a layer has those of its neighbours in the one
  /// before. `scratch`: a field of work space.
  PetscErrorCode find_labels(const Phase &phase, Field &scratch, std::vector<int> *labels) const;

private:
  Box::Range near_box(const Phase &phase, int d, int ghosts) const;
  bool is_beside_solid_side(const Phase &phase) const;
  PetscErrorCode find_level(const Phase &phase, Field &fields);
  void find_nearest(const Phase &phase, ConstView levels);
  void find_layers(const Phase &phase);
  void describe(const Field &fields, Cell *cell) const;
  double width(const Real3 &normal) const;
  PetscErrorCode exchange(const Phase &phase, Field &tensor, int width) const;

  PhasePlace place_;
  std::vector<Cell> cells_;
  std::array<std::size_t, layers + 2> first_{};  ///< of every layer
  std::vector<int> number_;                      ///< of the cells, -1: none; by offset from the memory's start
};

}  // namespace eulastic

#include "field/phase.hpp"

#include <algorithm>

namespace eulastic {

void Phase::empty(const Box &box, bool labels) {
  fraction = Field::on_demand(box, 1);
  tensor.field = undeformed_tensor(box);
  tensor.centred = material.is_membrane();
  label = labels ? Field::on_demand(box, 1) : Field();
}

std::size_t Phase::bytes() const {
  if (boxed) return 0;
  return fraction.bytes() + label.bytes() + (material.carries_tensor() ? tensor.field.bytes() : 0);
}

Segment Phase::filled(const Segment &row) const {
  Segment filled = rows.within(row);
  const double *phi = fraction[0].row(row.j, row.k);
  while (filled.i_begin < filled.i_end && phi[filled.i_begin] == 0) ++filled.i_begin;
  while (filled.i_begin < filled.i_end && phi[filled.i_end - 1] == 0) --filled.i_end;
  return filled;
}

Extent Phase::extent(const Box &box) const {
  Extent extent{box.cells(), {0, 0, 0}};
  for (const Segment &row : box.rows()) {
    const Segment occupied = filled(row);
    if (occupied.size() == 0) continue;
    const Int3 first{occupied.i_begin, row.j, row.k}, end{occupied.i_end, row.j + 1, row.k + 1};
    for (int d = 0; d < 3; ++d) {
      extent.begin[d] = std::min(extent.begin[d], first[d]);
      extent.end[d] = std::max(extent.end[d], end[d]);
    }
  }
  return extent;
}

Box Phase::block(const Box &box, int before, int behind) const {
  const Extent occupied = extent(box);
  Int3 begin = box.layout().begin, cells = box.cells();
  for (int d = 0; d < box.dimension(); ++d) {
    const int first = std::max(occupied.begin[d] - before, 0);
    cells[d] = std::min(occupied.end[d] + behind, cells[d]) - first;
    begin[d] += first;
  }
  return Box(box.domain_shape(), begin, cells, 0);
}

Int3 block_offset(const Box &box, const Box &block) {
  Int3 first;
  for (int d = 0; d < 3; ++d) first[d] = block.layout().begin[d] - box.layout().begin[d];
  return first;
}

void Phase::copy_from(const Phase &other) {
  species = other.species;
  material = other.material;
  boxed = other.boxed;
  travels = other.travels;
  fraction.copy_from(other.fraction);
  tensor.field.copy_from(other.tensor.field);
  tensor.centred = other.tensor.centred;
  tensor.rule = other.tensor.rule;
  rows = other.rows;
  tensor.strained = other.tensor.strained;
  if (other.label) label.copy_from(other.label);
}

PetscErrorCode PhaseDomain::exchange_ghosts(Field &field, int width, const OccupiedRows *rows) const {
  PetscFunctionBeginUser;
  if (exchange) PetscCall(exchange->update_ghosts(field, width, rows));
  PetscFunctionReturn(0);
}

PetscErrorCode PhaseDomain::update_ghosts(Field &tensor, int width, const OccupiedRows *rows) const {
  PetscFunctionBeginUser;
  PetscCall(exchange_ghosts(tensor, width, rows));
  fill_wall_ghosts_tensor(*box, *sides, tensor, width, rows);
  PetscFunctionReturn(0);
}

}  // namespace eulastic

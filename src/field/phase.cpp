#include "field/phase.hpp"

#include "field/sides.hpp"

namespace eulastic {

void Phase::empty(const Grid &grid, bool labels) {
  fraction = FieldBlock::at_rest(grid, 1);
  tensor = tensor_at_rest(grid);
  label = labels ? FieldBlock::at_rest(grid, 1) : FieldBlock();
}

void Phase::copy_from(const Phase &other) {
  species = other.species;
  material = other.material;
  colour = other.colour;
  fraction.copy_from(other.fraction);
  tensor.copy_from(other.tensor);
  rows = other.rows;
  strained = other.strained;
  if (other.label) label.copy_from(other.label);
}

}  // namespace eulastic

#include "field/phase.hpp"

namespace eulastic {

void Phase::empty(const Box &box, bool labels) {
  fraction = Field::at_rest(box, 1);
  tensor.field = tensor_at_rest(box);
  tensor.centred = material.is_membrane();
  label = labels ? Field::at_rest(box, 1) : Field();
}

void Phase::copy_from(const Phase &other) {
  species = other.species;
  material = other.material;
  colour = other.colour;
  boxed = other.boxed;
  fraction.copy_from(other.fraction);
  tensor.field.copy_from(other.tensor.field);
  tensor.centred = other.tensor.centred;
  tensor.rule = other.tensor.rule;
  rows = other.rows;
  tensor.strained = other.tensor.strained;
  if (other.label) label.copy_from(other.label);
}

}  // namespace eulastic

#include "field/phase.hpp"

namespace eulastic {

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

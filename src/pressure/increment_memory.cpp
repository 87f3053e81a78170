#include "pressure/increment_memory.hpp"

#include "field/open_sides.hpp"

#include <algorithm>
#include <utility>

namespace eulastic {

IncrementMemory::IncrementMemory(const Box &box, int count) {
  if (count > 0) block_ = Field(box, count);
}

Field *IncrementMemory::saved() {
  if (!block_) return nullptr;
  const std::size_t size = block_.layout().size;
  double *data = block_.data();
  std::rotate(data, data + newest_ * size, data + count() * size);
  newest_ = 0;
  return &block_;
}

void IncrementMemory::clear() {
  if (block_) block_.clear();
  ghosts_valid_ = false;
}

PetscErrorCode IncrementMemory::update_ghosts(const Box &box, GhostExchange &exchange) {
  PetscFunctionBeginUser;
  if (std::exchange(ghosts_valid_, true)) PetscFunctionReturn(0);
  PetscCall(exchange.update_ghosts(block_, 1));
  for (int f = 0; f < count(); ++f) fill_ghosts_of_increment(box, block_[f], 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic

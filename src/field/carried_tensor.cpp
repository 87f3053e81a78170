#include "field/carried_tensor.hpp"

namespace eulastic {

const std::vector<TensorComponent> &tensor_components(int dimension, bool centred) {
  using Components = std::vector<TensorComponent>;
  static const Components flat{{0, 0}, {1, 1}, {0, 1, at_edge(0, 1)}};
  static const Components full{
      {0, 0}, {1, 1}, {2, 2}, {1, 2, at_edge(1, 2)}, {0, 2, at_edge(0, 2)}, {0, 1, at_edge(0, 1)}};
  static const Components flat_centred{{0, 0}, {1, 1}, {0, 1}};
  static const Components full_centred{{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  if (dimension == 2) return centred ? flat_centred : flat;
  return centred ? full_centred : full;
}

std::vector<TensorComponent> tensor_locations(int dimension) {
  const std::vector<TensorComponent> &all = tensor_components(dimension);
  return {all.begin() + (dimension - 1), all.end()};  // the last diagonal component represents the centres
}

Field undeformed_tensor(const Box &box) {
  const int dimension = box.dimension();
  return Field::on_demand(box, static_cast<int>(tensor_components(dimension).size()), dimension);
}

}  // namespace eulastic

#include "bodies/colours.hpp"

#include "field/walls.hpp"

#include <algorithm>
#include <utility>

namespace eulastic {
namespace {

// Where the bodies of one phase go.
class Ways {
public:
  Ways(const std::vector<BodyMove> &moves, int from) {
    for (const BodyMove &move : moves)
      if (move.from == from) ways_.push_back(move);
  }
  bool empty() const { return ways_.empty(); }
  /// Position of the phase, or -1.
  int of(double label) const {
    if (label < ways_.front().label || label > ways_.back().label) return -1;
    const auto found = std::lower_bound(ways_.begin(), ways_.end(), label,
                                        [](const BodyMove &move, double wanted) { return move.label < wanted; });
    return found->label == label ? found->to : -1;
  }

private:
  std::vector<BodyMove> ways_;  // by label
};

void copy_component(const Grid &grid, const Ways &ways, ConstView label, const TensorComponent &c, int f, int from,
                    std::vector<Phase> *phases) {
  const Staggering at = c.staggering();
  const bool edge = c.a != c.b;
  const std::ptrdiff_t a = edge ? label.stride(c.a) : 0, b = edge ? label.stride(c.b) : 0;
  const ConstView tensor = (*phases)[from].tensor[f];
  for (int k = 0; k < grid.points_end(2, at[2]); ++k)
    for (int j = 0; j < grid.points_end(1, at[1]); ++j)
      for (int i = 0; i < grid.points_end(0, at[0]); ++i) {
        const double *q = &label.row(j, k)[i];
        for (const double name : {q[0], q[-a], q[-b], q[-a - b]}) {
          const int to = name > 0 ? ways.of(name) : -1;
          if (to >= 0) (*phases)[to].tensor[f](i, j, k) = tensor(i, j, k);
        }
      }
}

}  // namespace

void add_colour(const Grid &grid, int like, std::vector<Phase> *phases) {
  const auto &components = tensor_components(grid.dimension());
  const Phase &phase = (*phases)[like];
  Phase colour;
  colour.species = phase.species;
  colour.material = phase.material;
  for (const Phase &other : *phases) colour.colour += other.species == phase.species;
  colour.separate = phase.separate;
  colour.fraction = FieldBlock(grid, 1);
  colour.tensor = FieldBlock(grid, static_cast<int>(components.size()));
  for (std::size_t c = 0; c < components.size(); ++c)
    if (components[c].a == components[c].b) colour.tensor.fill(static_cast<int>(c), 1.0);
  if (phase.label) colour.label = FieldBlock(grid, 1);
  phases->push_back(std::move(colour));
}

std::vector<long> species_of_colours(const std::vector<Phase> &phases) {
  std::vector<long> first;
  for (const Phase &phase : phases) {
    if (phase.colour == 0) continue;
    const auto same = [&](const Phase &other) { return other.colour == 0 && other.species == phase.species; };
    first.push_back(std::find_if(phases.begin(), phases.end(), same) - phases.begin());
  }
  return first;
}

bool set_colours(const Grid &grid, const std::vector<long> &first, std::vector<Phase> *phases) {
  const auto is_colour = [](const Phase &phase) { return phase.colour > 0; };
  phases->erase(std::remove_if(phases->begin(), phases->end(), is_colour), phases->end());
  const long species = static_cast<long>(phases->size());
  for (const long p : first) {
    if (p < 0 || p >= species || !(*phases)[p].separate) return false;
    add_colour(grid, static_cast<int>(p), phases);
  }
  return true;
}

void move_bodies(const Grid &grid, const std::vector<BodyMove> &moves, std::vector<Phase> *phases) {
  const auto &components = tensor_components(grid.dimension());
  for (int from = 0; from < static_cast<int>(phases->size()); ++from) {
    const Ways ways(moves, from);
    if (ways.empty()) continue;
    Phase &phase = (*phases)[from];
    for (std::size_t c = 0; c < components.size(); ++c)
      copy_component(grid, ways, phase.label[0], components[c], static_cast<int>(c), from, phases);
  }
  for (int from = 0; from < static_cast<int>(phases->size()); ++from) {
    const Ways ways(moves, from);
    if (ways.empty()) continue;
    const View fraction = (*phases)[from].fraction[0], label = (*phases)[from].label[0];
    for (const Segment &row : grid.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) {
        double &name = label(i, row.j, row.k);
        const int to = name > 0 ? ways.of(name) : -1;
        if (to < 0) continue;
        (*phases)[to].fraction[0](i, row.j, row.k) = std::exchange(fraction(i, row.j, row.k), 0);
        (*phases)[to].label[0](i, row.j, row.k) = std::exchange(name, 0);
      }
  }
}

}  // namespace eulastic

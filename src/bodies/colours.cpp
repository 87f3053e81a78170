#include "bodies/colours.hpp"

#include "bodies/near_bodies.hpp"
#include "field/sides.hpp"

#include <algorithm>

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

// `tensor`: the component in the phase that `ways` lead away from, before any body has moved.
void copy_component(const Box &box, const Ways &ways, const BodyCells &cells, const TensorComponent &c, int f,
                    ConstView tensor, std::vector<Phase> *phases) {
  const std::ptrdiff_t a = c.on_edge() ? cells.label.stride(c.a) : 0, b = c.on_edge() ? cells.label.stride(c.b) : 0;
  for (int k = 0; k < box.points_end(2, c.at[2]); ++k)
    for (int j = 0; j < box.points_end(1, c.at[1]); ++j)
      for (int i = 0; i < box.points_end(0, c.at[0]); ++i) {
        const double *name = &cells.label.row(j, k)[i], *phi = &cells.fraction.row(j, k)[i];
        for (const std::ptrdiff_t cell : {std::ptrdiff_t(0), -a, -b, -a - b}) {
          const int to = phi[cell] > BodyCells::threshold && name[cell] > 0 ? ways.of(name[cell]) : -1;
          if (to >= 0) (*phases)[to].tensor.field[f](i, j, k) = tensor(i, j, k);
        }
      }
}

// Copies of one field of every phase that bodies leave, taken by `member(phase)`.
template <class Member>
std::vector<Field> copies(const std::vector<Ways> &ways, std::vector<Phase> *phases, Member member) {
  std::vector<Field> result(phases->size());
  for (std::size_t p = 0; p < phases->size(); ++p)
    if (!ways[p].empty()) result[p].copy_from(member((*phases)[p]));
  return result;
}

}  // namespace

void add_colour(const Box &box, int like, std::vector<Phase> *phases) {
  const Phase &phase = (*phases)[like];
  Phase colour;
  colour.species = phase.species;
  colour.material = phase.material;
  for (const Phase &other : *phases) colour.colour += other.species == phase.species;
  colour.separate = phase.separate;
  colour.tensor.rule = phase.tensor.rule;
  colour.empty(box, bool(phase.label));
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

bool set_colours(const Box &box, const std::vector<long> &first, std::vector<Phase> *phases) {
  const auto is_colour = [](const Phase &phase) { return phase.colour > 0; };
  phases->erase(std::remove_if(phases->begin(), phases->end(), is_colour), phases->end());
  const long species = static_cast<long>(phases->size());
  if (static_cast<long>(first.size()) > (most_colours - 1) * species) return false;
  for (const long p : first) {
    if (p < 0 || p >= species || !(*phases)[p].separate) return false;
    add_colour(box, static_cast<int>(p), phases);
  }
  return true;
}

// Bodies may change places: every field is copied before it is written.
void move_bodies(const Box &box, const std::vector<BodyMove> &moves, std::vector<Phase> *phases) {
  const int count = static_cast<int>(phases->size());
  std::vector<Ways> ways;
  for (int from = 0; from < count; ++from) ways.emplace_back(moves, from);
  const auto label = copies(ways, phases, [](Phase &phase) { return phase.label.part(0, 1); });
  const auto fraction = copies(ways, phases, [](Phase &phase) { return phase.fraction.part(0, 1); });
  for (int c = 0; c < static_cast<int>(tensor_components(box.dimension()).size()); ++c) {
    const auto tensor = copies(ways, phases, [c](Phase &phase) { return phase.tensor.field.part(c, 1); });
    for (int from = 0; from < count; ++from)
      if (!ways[from].empty())
        copy_component(box, ways[from], {label[from][0], fraction[from][0]}, (*phases)[from].tensor.components()[c], c,
                       tensor[from][0], phases);
  }
  for (const bool arrive : {false, true})
    for (int from = 0; from < count; ++from) {
      if (ways[from].empty()) continue;
      for_points(box.rows(), [&](int i, int j, int k) {
        const double name = label[from][0](i, j, k), phi = fraction[from][0](i, j, k);
        const int to = name > 0 ? ways[from].of(name) : -1;
        if (to < 0) return;
        Phase &phase = (*phases)[arrive ? to : from];
        double &there = phase.fraction[0](i, j, k);
        if (!arrive || phi >= there) phase.label[0](i, j, k) = arrive ? name : 0;
        there = arrive ? std::min(there + phi, 1.0) : 0;
      });
    }
}

}  // namespace eulastic

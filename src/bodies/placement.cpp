#include "bodies/placement.hpp"

#include "base/number_rows.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "bodies/random.hpp"
#include "bodies/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

std::string text(double value) { return print("%.10g", value); }

std::string read_list(const SpeciesSpec &spec, int dimension, std::vector<BodyPlace> *places) {
  static const RowFormat format{
      "rows of x,y,z or x,y,z,angle_x,angle_y,angle_z", {"x", "y", "z", "angle_x", "angle_y", "angle_z"}, {3, 6}, true};
  std::string bytes;
  if (!read_file_locally(spec.positions_file, &bytes)) return "cannot read " + spec.positions_file;
  Random random(spec.seed, spec.name);
  return read_rows(spec.positions_file, bytes, format, [&](const std::vector<double> &row) {
    BodyPlace place{{row[0], row[1], row[2]}, spec.orientation};
    if (spec.random_orientation) place.orientation = random.orientation(dimension);
    if (row.size() == 6) place.orientation = {row[3], row[4], row[5]};
    places->push_back(place);
    return std::string();
  });
}

// Returns why the lumen of a tube is not inside the domain, or an empty string.
std::string why_no_lumen(const SpeciesSpec &spec, const DomainShape &grid, const Real3 &centre) {
  const double throat = spec.shape == Shape::constricted_tube ? spec.throat_length / 2 : 0;
  for (int d = 0; d < (grid.cells[2] == 1 ? 2 : 3); ++d) {
    const double half = d == spec.axis ? throat : spec.radius, slack = 1e-5 * grid.length[d];
    if (centre[d] - half >= -slack && centre[d] + half <= grid.length[d] + slack) continue;
    return std::string(d == spec.axis ? "its throat" : "its lumen") + " leaves the box: " + "xyz"[d] + " = " +
           text(centre[d] - half) + " ... " + text(centre[d] + half) + ", the box is 0 ... " + text(grid.length[d]);
  }
  return {};
}

// Returns why a body cannot be at `place`, or an empty string.
std::string refusal_reason(const SpeciesSpec &spec, const Surface &surface, const DomainShape &grid,
                           const BodyPlace &place) {
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  if (dimension == 2 && (place.orientation[0] != 0 || place.orientation[1] != 0)) return "rotates only about z in 2-D";
  const bool may_cross = spec.shape == Shape::cylinder || is_anchored(spec.shape);
  if (may_cross && place.orientation != Real3{})
    return "cannot be rotated: cylinders, slabs and tubes have an axis instead of an orientation";
  if (is_tube(spec.shape)) return why_no_lumen(spec, grid, place.centre);
  for (int d = 0; d < dimension; ++d) {
    const double centre = place.centre[d], length = grid.length[d], bound = surface.bounding_radius();
    const std::string direction(1, "xyz"[d]);
    if (!(centre >= 0 && centre <= length))
      return "its centre " + direction + " = " + text(centre) + " is outside the box, 0 ... " + text(length);
    if (centre >= bound && centre + bound <= length) continue;
    const double extent = surface.support(rotation(place.orientation)[d]), slack = 1e-5 * length;
    if (std::isfinite(extent) && 2 * extent > length + slack)
      return "it is " + text(2 * extent) + " long in " + direction + ", the box only " + text(length);
    if (grid.boundary[d] == Boundary::periodic || may_cross) continue;
    if (centre - extent < -slack || centre + extent > length + slack)
      return "it reaches into the wall: " + direction + " = " + text(centre - extent) + " ... " +
             text(centre + extent) + ", the box is 0 ... " + text(length);
  }
  return {};
}

// Checks and stores the bodies of a species in order.
class Placing {
public:
  Placing(const SpeciesSpec &spec, const DomainShape &grid, const KeptBodies &kept, Places *places)
      : spec_(spec), grid_(grid), surface_(spec, grid.cells[2] == 1 ? 2 : 3), kept_(kept), places_(*places) {}

  void expect(int count) {
    places_.count = count;
    own_ = BodyRange::of(count, kept_.rank, kept_.ranks);
    places_.known.reserve(own_.size());
  }
  /// Adds the next body; returns an error, or an empty string.
  std::string add(BodyPlace place) {
    const int index = next_++;
    if (grid_.cells[2] == 1) place.centre[2] = grid_.length[2] / 2;
    const std::string reason = refusal_reason(spec_, surface_, grid_, place);
    if (!reason.empty()) return places_.count > 1 ? "body " + std::to_string(index + 1) + ": " + reason : reason;
    if (own_.has(index)) places_.known.push_back({place, index});
    return {};
  }
  std::string add_only(const BodyPlace &place) {
    expect(1);
    return add(place);
  }

private:
  const SpeciesSpec &spec_;
  const DomainShape &grid_;
  Surface surface_;
  KeptBodies kept_;
  Places &places_;
  BodyRange own_;
  int next_ = 0;
};

// Rank 0 reads the list and broadcasts it in pieces.
std::string place_list(const SpeciesSpec &spec, int dimension, Placing *placing) {
  std::vector<BodyPlace> all, piece;
  if (std::string wrong = on_rank_0([&] { return read_list(spec, dimension, &all); }); !wrong.empty()) return wrong;
  std::size_t count = all.size();
  share(&count);
  placing->expect(static_cast<int>(count));
  for (std::size_t begin = 0; begin < count; begin += BodyRange::piece) {
    if (!all.empty()) piece.assign(all.begin() + begin, all.begin() + std::min(count, begin + BodyRange::piece));
    share(&piece);
    for (const BodyPlace &place : piece)
      if (std::string wrong = placing->add(place); !wrong.empty()) return wrong;
  }
  return {};
}

std::string make_lattice(const SpeciesSpec &spec, const DomainShape &grid, Placing *placing) {
  const Int3 &n = spec.count;
  if (n[0] < 1 || n[1] < 1 || n[2] < 1) return "a lattice needs at least one body in every direction";
  if (grid.cells[2] == 1 && n[2] != 1) return "a lattice has one layer in z in 2-D";
  if (double(n[0]) * n[1] * n[2] > most_bodies) return "at most " + std::to_string(most_bodies) + " bodies";
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  const Surface surface(spec, dimension);
  Random random(spec.seed, spec.name);
  Real3 pitch, range{};
  for (int d = 0; d < 3; ++d) {
    pitch[d] = grid.length[d] / n[d];
    const bool turns = spec.random_orientation;
    const double half = turns ? surface.bounding_radius() : surface.support(rotation(spec.orientation)[d]);
    if (d < dimension) range[d] = spec.jitter * std::max(0.0, pitch[d] / 2 - half);
  }
  placing->expect(n[0] * n[1] * n[2]);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        BodyPlace place{{}, spec.orientation};
        const Int3 index{i, j, k};
        for (int d = 0; d < 3; ++d) {
          place.centre[d] = (index[d] + 0.5) * grid.length[d] / n[d];
          if (range[d] > 0) place.centre[d] += random.between(-range[d], range[d]);
        }
        if (spec.random_orientation) place.orientation = random.orientation(dimension);
        if (std::string wrong = placing->add(place); !wrong.empty()) return wrong;
      }
  return {};
}

}  // namespace

Places::Places(const std::vector<BodyPlace> &all) : count(static_cast<int>(all.size())) {
  for (int b = 0; b < count; ++b) known.push_back({all[b], b});
}

void Places::share_among(int rank, int ranks) {
  const BodyRange own = BodyRange::of(count, rank, ranks);
  const auto other = [&](const NumberedPlace &place) { return !own.has(place.index); };
  known.erase(std::remove_if(known.begin(), known.end(), other), known.end());
  known.shrink_to_fit();
  everywhere = ranks == 1;
}

std::string place_bodies(const SpeciesSpec &spec, const DomainShape &grid, Places *places, const KeptBodies &kept) {
  const int dimension = grid.cells[2] == 1 ? 2 : 3;
  *places = {};
  if (spec.shape == Shape::voxels || spec.shape == Shape::state) return {};  // from files
  if (std::string wrong = why_no_shape(spec, dimension); !wrong.empty()) return wrong;
  BodyPlace place{{grid.length[0] / 2, grid.length[1] / 2, grid.length[2] / 2}, spec.orientation};
  if (is_anchored(spec.shape) && spec.placement != Placement::one) return "slabs and tubes are placed once";
  Placing placing(spec, grid, kept, places);
  if (spec.shape == Shape::slab) {
    place.centre[spec.axis] = (spec.interval[0] + spec.interval[1]) / 2;
    return placing.add_only(place);
  }
  if (spec.placement == Placement::list) return place_list(spec, dimension, &placing);
  if (spec.placement != Placement::one) return make_lattice(spec, grid, &placing);
  if (spec.centre_given) place.centre = spec.centre;
  if (spec.random_orientation) place.orientation = Random(spec.seed, spec.name).orientation(dimension);
  return placing.add_only(place);
}

}  // namespace eulastic

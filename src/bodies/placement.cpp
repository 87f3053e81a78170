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

// Why a body cannot be where it is: the option that says otherwise, without the name of the species, and one sentence.
struct Refusal {
  std::string option, why;
};

// Empty if the lumen of a tube is inside the domain.
Refusal refuse_lumen(const SpeciesSpec &spec, const DomainShape &grid, const Real3 &centre) {
  const double throat = spec.shape == Shape::constricted_tube ? spec.throat_length / 2 : 0;
  for (int d = 0; d < grid.dimension(); ++d) {
    const bool along = d == spec.axis;
    const double half = along ? throat : spec.radius, slack = 1e-5 * grid.length[d];
    if (centre[d] - half >= -slack && centre[d] + half <= grid.length[d] + slack) continue;
    return {"centre", std::string(along ? "the throat" : "the lumen") + " leaves the box: " + "xyz"[d] + " = " +
                          text(centre[d] - half) + " ... " + text(centre[d] + half) + "; accepted: within 0 ... " +
                          text(grid.length[d])};
  }
  return {};
}

// Empty if a body can be at `place`.
Refusal refuse(const SpeciesSpec &spec, const Surface &surface, const DomainShape &grid, const BodyPlace &place) {
  const int dimension = grid.dimension();
  if (dimension == 2 && (place.orientation[0] != 0 || place.orientation[1] != 0))
    return {"orientation", "a body is rotated about z only in 2-D; accepted: 0,0,angle"};
  const bool may_cross = spec.shape == Shape::cylinder || is_anchored(spec.shape);
  if (may_cross && place.orientation != Real3{})
    return {"orientation", "cylinders, slabs and tubes cannot be rotated; accepted: 0,0,0, with their direction as -" +
                               spec.name + "_axis"};
  if (is_tube(spec.shape)) return refuse_lumen(spec, grid, place.centre);
  const char *position = spec.shape == Shape::slab              ? "interval"
                         : spec.placement == Placement::lattice ? "count"
                                                                : "centre";
  for (int d = 0; d < dimension; ++d) {
    const double centre = place.centre[d], length = grid.length[d], bound = surface.bounding_radius();
    const std::string direction(1, "xyz"[d]);
    const auto within = [&] { return "; accepted: within 0 ... " + text(length); };
    if (!(centre >= 0 && centre <= length))
      return {position, direction + " = " + text(centre) + " is outside the box" + within()};
    if (centre >= bound && centre + bound <= length) continue;
    const double extent = surface.support(rotation(place.orientation)[d]), slack = 1e-5 * length;
    if (std::isfinite(extent) && 2 * extent > length + slack)
      return {"shape", "the body is " + text(2 * extent) + " long in " + direction + "; accepted: at most " +
                           text(length) + ", the length of the box"};
    if (grid.boundary[d] == Boundary::periodic || may_cross) continue;
    if (centre - extent < -slack || centre + extent > length + slack)
      return {position, "the body reaches into the wall: " + direction + " = " + text(centre - extent) + " ... " +
                            text(centre + extent) + within()};
  }
  return {};
}

// Checks and stores the bodies of a species in order.
class Placing {
public:
  Placing(const SpeciesSpec &spec, const DomainShape &grid, const KeptBodies &kept, Places *places)
      : spec_(spec), grid_(grid), surface_(spec, grid.dimension()), kept_(kept), places_(*places) {}

  void expect(int count) {
    places_.count = count;
    own_ = BodyRange::of(count, kept_.rank, kept_.ranks);
    places_.known.reserve(own_.size());
  }
  /// Adds the next body; returns an error, or an empty string.
  std::string add(BodyPlace place) {
    const int index = next_++;
    if (grid_.dimension() == 2) place.centre[2] = grid_.length[2] / 2;
    const Refusal refusal = refuse(spec_, surface_, grid_, place);
    if (!refusal.why.empty())
      return "-" + spec_.name + "_" + (spec_.placement == Placement::list ? "positions" : refusal.option) + ": " +
             (places_.count > 1 ? "body " + std::to_string(index + 1) + ": " : "") + refusal.why;
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
  if (const std::string wrong = on_rank_0([&] { return read_list(spec, dimension, &all); }); !wrong.empty())
    return "-" + spec.name + "_positions: " + wrong;
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
  const int dimension = grid.dimension();
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
  const int dimension = grid.dimension();
  *places = {};
  if (is_from_file(spec.shape)) return {};
  BodyPlace place{{grid.length[0] / 2, grid.length[1] / 2, grid.length[2] / 2}, spec.orientation};
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

#include "scene/initial_state.hpp"

#include "bodies/body_owners.hpp"
#include "bodies/fill_phase.hpp"
#include "io/fail_together.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>

namespace eulastic {
namespace {

constexpr double overshoot = 0.1;  // of phi of a WENO5 run
constexpr AcceptedValues finite_numbers{"finite numbers", [](double q) { return std::isfinite(q); }};
constexpr AcceptedValues positive_numbers{"positive numbers", [](double q) { return std::isfinite(q) && q > 0; }};
constexpr AcceptedValues zero_to_one{"0 ... 1", [](double q) { return q >= -overshoot && q <= 1 + overshoot; }};
constexpr AcceptedValues ids{"0 and the ids of bodies", [](double q) {
                               return q >= 0 && q <= std::numeric_limits<int>::max() && q == std::floor(q);
                             }};
const std::vector<TensorComponent> all_components = tensor_components(3);

std::string tensor_name(const TensorComponent &c) { return "left_cauchy_green_" + c.name(); }

std::int64_t global_index(const Box &box, int i, int j, int k) {
  const Int3 &b = box.layout().begin, &n = box.domain_cells();
  return b[0] + i + n[0] * (b[1] + j + n[1] * std::int64_t(b[2] + k));
}

Int3 cell_at(const Box &box, std::int64_t index) {
  const Int3 &n = box.domain_cells();
  return {int(index % n[0]), int(index / n[0] % n[1]), int(index / n[0] / n[1])};
}

// Calls visit(value) for every point on the high wall of direction d.
template <class Visit>
void for_high_wall(const Box &box, const Staggering &at, int d, View field, Visit visit) {
  if (!at[d] || !box.touches_high(d)) return;
  Int3 begin{}, end{};
  for (int e = 0; e < 3; ++e) end[e] = box.points_end(e, at[e]);
  begin[d] = end[d] - 1;
  for_points({begin, end}, [&](int i, int j, int k) { visit(&field(i, j, k)); });
}

}  // namespace

PetscErrorCode InitialState::fail(const std::string &problem) const {
  const std::string source = "-initial_state: " + config_->initial_state + ": ";
  return fail_together(domain_->comm(), problem.empty() ? problem : source + problem);
}

PetscErrorCode InitialState::open() {
  PetscFunctionBeginUser;
  if (config_->initial_state.empty()) PetscFunctionReturn(0);
  PetscCall(file_.open(domain_->comm(), config_->initial_state));
  open_ = true;
  PetscCall(check_names());
  PetscFunctionReturn(0);
}

PetscErrorCode InitialState::check_names() {
  PetscFunctionBeginUser;
  std::vector<std::string> flow{"velocity_x", "velocity_y", "velocity_z", "pressure"}, solid{"solid_fraction", "body"};
  for (const TensorComponent &c : all_components) solid.push_back(tensor_name(c));
  std::set<std::string> known(flow.begin(), flow.end());
  known.insert("velocity");  // of snapshots, for pictures
  for (const std::string &base : solid) {
    known.insert(base);
    for (const SpeciesSpec &species : config_->species) known.insert(base + "_" + species.name);
    if (config_->species.empty() && file_.has(base))
      PetscCall(
          fail("dataset " + base + " belongs to a species; accepted: with -species and the options of the species"));
  }
  for (const std::string &name : file_.datasets()) {
    if (known.count(name) == 0 && name.rfind("wall_shear_stress", 0) != 0)
      PetscCall(fail("unknown dataset " + name + "; accepted: " + join(flow, ", ") + ", " + join(solid, ", ") +
                     ", the latter also followed by _ and the name of a species"));
  }
  if (config_->species.size() > 1)
    for (const std::string &base : solid) {
      const bool own = std::any_of(config_->species.begin(), config_->species.end(),
                                   [&](const SpeciesSpec &species) { return file_.has(base + "_" + species.name); });
      if (file_.has(base) && !own)
        PetscCall(fail("dataset " + base + " could be of any species; accepted: " + base + "_" +
                       config_->species[0].name + ", ..."));
    }
  PetscFunctionReturn(0);
}

// The dataset of a species, or nothing. A dataset without the name of a species is not used where there are several.
std::string InitialState::name_for(const std::string &base, const SpeciesSpec &species) const {
  const std::string own = base + "_" + species.name;
  if (file_.has(own)) return own;
  return config_->species.size() == 1 && file_.has(base) ? base : std::string();
}

bool InitialState::holds(const SpeciesSpec &species) const {
  if (!open_) return false;
  bool any = !name_for("solid_fraction", species).empty();
  for (const TensorComponent &c : all_components) any = any || !name_for(tensor_name(c), species).empty();
  return any;
}

PetscErrorCode InitialState::read(const std::string &name, const Staggering &staggering, const AcceptedValues &accepted,
                                  View field) {
  PetscFunctionBeginUser;
  PetscCall(file_.read_field(*domain_, name, staggering, field));
  const Int3 &first = domain_->layout().begin;
  std::string problem;
  for_points(domain_->rows(), [&](int i, int j, int k) {
    const double value = field(i, j, k);
    if (!problem.empty() || accepted.has(value)) return;
    problem = "dataset " + name + " [" + std::to_string(first[2] + k) + ", " + std::to_string(first[1] + j) + ", " +
              std::to_string(first[0] + i) + "] is " + to_text(value) + "; accepted: " + accepted.text;
  });
  PetscCall(fail(problem));
  PetscFunctionReturn(0);
}

// A component that 2-D does not have.
PetscErrorCode InitialState::read_constant(const std::string &name, double value) {
  PetscFunctionBeginUser;
  if (name.empty() || !file_.has(name)) PetscFunctionReturn(0);
  Field field(*domain_, 1);
  PetscCall(read(name, at_centre, finite_numbers, field[0]));
  bool same = true;
  for_points(domain_->rows(), [&](int i, int j, int k) { same = same && field[0](i, j, k) == value; });
  PetscCall(fail(same ? std::string() : "dataset " + name + " in 2-D; accepted: " + to_text(value) + " everywhere"));
  PetscFunctionReturn(0);
}

// A file without the faces on a high boundary, such as a snapshot, does not say what flows through an open one: as much
// as through the faces before it, until the velocity is made solenoidal.
PetscErrorCode InitialState::read_flow(State *state) {
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  PetscFunctionBeginUser;
  if (!open_) PetscFunctionReturn(0);
  for (int c = 0; c < domain_->dimension(); ++c) {
    const std::string name = std::string("velocity_") + "xyz"[c];
    if (!file_.has(name)) continue;
    const View field = state->velocity[c];
    for_high_wall(*domain_, at_face[c], c, field, [](double *q) { *q = missing; });
    PetscCall(read(name, at_face[c], finite_numbers, field));
    for_high_wall(*domain_, at_face[c], c, field, [&](double *q) {
      if (std::isnan(*q)) *q = domain_->is_open(c, true) ? q[-field.stride(c)] : 0;
    });
  }
  if (domain_->dimension() == 2) PetscCall(read_constant("velocity_z", 0));
  if (file_.has("pressure")) PetscCall(read("pressure", at_centre, finite_numbers, state->pressure[0]));
  PetscFunctionReturn(0);
}

PetscErrorCode InitialState::read_tensor(const SpeciesSpec &species, Phase *phase) {
  PetscFunctionBeginUser;
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  for (const TensorComponent &c : all_components) {
    const std::string name = name_for(tensor_name(c), species);
    if (name.empty()) continue;
    const auto &components = phase->tensor.components();
    const auto own = std::find_if(components.begin(), components.end(),
                                  [&](const TensorComponent &other) { return other.a == c.a && other.b == c.b; });
    if (own == components.end()) {  // in 2-D
      PetscCall(read_constant(name, c.rest()));
      continue;
    }
    const View field = phase->tensor.field[static_cast<int>(own - components.begin())];
    const Staggering &at = own->at;
    // Edges on the high wall are part of the state; a file without them has them extrapolated.
    for (int d = 0; d < 3; ++d) for_high_wall(*domain_, at, d, field, [](double *q) { *q = missing; });
    PetscCall(read(name, at, c.a == c.b ? positive_numbers : finite_numbers, field));
    for (int d = 0; d < 3; ++d)
      for_high_wall(*domain_, at, d, field, [s = field.stride(d)](double *q) {
        if (std::isnan(*q)) *q = 2 * q[-s] - q[-2 * s];
      });
  }
  PetscFunctionReturn(0);
}

PetscErrorCode InitialState::read_phase(const SpeciesSpec &species, int first_label, Phase *phase, Places *places) {
  PetscFunctionBeginUser;
  const std::string fraction = open_ ? name_for("solid_fraction", species) : std::string();
  if (species.shape == Shape::state && fraction.empty())
    PetscCall(
        fail("dataset solid_fraction is missing; accepted: a file with this dataset, or -" + species.name + "_shape"));
  if (!open_) PetscFunctionReturn(0);
  if (species.is_membrane() && holds(species))
    PetscCall(fail("the file has a solid fraction or a strain of " + species.name +
                   ", whose membrane needs the shape at rest; accepted: a file with velocities and pressure, or "
                   "without -initial_state"));
  if (!fraction.empty()) {
    PetscCall(read(fraction, at_centre, zero_to_one, phase->fraction[0]));
    for_points(domain_->rows(),
               [phi = phase->fraction[0]](int i, int j, int k) { phi(i, j, k) = std::clamp(phi(i, j, k), 0.0, 1.0); });
    stretch_phase(*domain_, species, phase);
    PetscCall(read_bodies(species, first_label, phase, places));
  }
  if (phase->material.carries_tensor()) PetscCall(read_tensor(species, phase));
  PetscFunctionReturn(0);
}

PetscErrorCode InitialState::read_bodies(const SpeciesSpec &species, int first_label, Phase *phase, Places *places) {
  PetscFunctionBeginUser;
  const View label = phase->label[0], phi = phase->fraction[0];
  const std::string name = name_for("body", species);
  int range[2] = {first_label, -first_label};  // the largest label, minus the smallest
  if (name.empty()) {
    for_points(domain_->rows(), [&](int i, int j, int k) { label(i, j, k) = phi(i, j, k) > 0 ? first_label : 0; });
  } else {
    PetscCall(read(name, at_centre, ids, label));
    for_points(domain_->rows(), [&](int i, int j, int k) {
      const int body = static_cast<int>(label(i, j, k));
      if (body == 0) return;
      range[0] = std::max(range[0], body);
      range[1] = std::max(range[1], -body);
    });
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_INT, MPI_MAX, domain_->comm()));
  }
  const double bodies = double(range[0]) - first_label + 1;
  if (-range[1] < first_label || bodies > domain_->domain_cell_count())
    PetscCall(fail("dataset " + name + " has the ids " + std::to_string(-range[1]) + " ... " +
                   std::to_string(range[0]) + "; accepted for species " + species.name + ": " +
                   std::to_string(first_label) + " and following"));
  PetscCall(find_bodies(first_label, static_cast<int>(bodies), *phase, places));
  has_bodies_ = true;
  PetscFunctionReturn(0);
}

// The first cell of each body, one that is more than half full if there is any.
PetscErrorCode InitialState::find_bodies(int first_label, int bodies, const Phase &phase, Places *places) const {
  PetscFunctionBeginUser;
  const double cells = domain_->domain_cell_count();
  std::map<int, double> first;
  for_points(domain_->rows(), [&](int i, int j, int k) {
    const int body = static_cast<int>(phase.label[0](i, j, k)) - first_label;
    if (body < 0) return;
    const double rank = double(global_index(*domain_, i, j, k)) + (phase.fraction[0](i, j, k) > 0.5 ? 0 : cells);
    double &least = first.try_emplace(body, rank).first->second;
    least = std::min(least, rank);
  });
  std::vector<int> here;
  std::vector<double> last;
  for (const auto &[body, rank] : first) {
    here.push_back(body);
    last.push_back(-rank);
  }
  BodyOwners owners;
  PetscCall(owners.connect(domain_->comm(), bodies, std::move(here)));
  std::vector<double> owned(owners.owned().size(), -2 * cells);
  PetscCall(owners.reduce(1, MPI_MAX, last, &owned));
  *places = {};
  places->count = bodies;
  places->everywhere = domain_->ranks() == 1;
  for (std::size_t b = 0; b < owned.size(); ++b) {
    const Int3 cell = cell_at(*domain_, static_cast<std::int64_t>(-owned[b]) % static_cast<std::int64_t>(cells));
    NumberedPlace &place = places->known.emplace_back();
    place.index = owners.owned().begin + static_cast<int>(b);
    for (int d = 0; d < 3; ++d) place.centre[d] = (cell[d] + 0.5) * domain_->spacing()[d];
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic

#include "io/snapshot_fields.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr const char *axes = "xyz";

// A centred field averaged to the positions of component (a, b) of the tensor of a phase.
double at_component(ConstView q, const TensorComponent &c, int i, int j, int k) {
  const double *p = &q.row(j, k)[i];
  if (!c.on_edge()) return p[0];
  const std::ptrdiff_t a = q.stride(c.a), b = q.stride(c.b);
  return 0.25 * ((p[0] + p[-a - b]) + (p[-a] + p[-b]));
}

}  // namespace

void SnapshotFields::centre_velocity(const Field &velocity) {
  if (!velocity_) velocity_ = Field(*box_, 3);
  for (int c = 0; c < velocity.count(); ++c) {
    const ConstView from = velocity[c];
    const View to = velocity_[c];
    const std::ptrdiff_t s = from.stride(c);
    for_points(box_->rows(), [&](int i, int j, int k) {
      const double *p = &from.row(j, k)[i];
      to(i, j, k) = 0.5 * (p[0] + p[s]);
    });
  }
}

void SnapshotFields::mix_fractions(const std::vector<Phase> &phases) {
  if (!fraction_) fraction_ = Field(*box_, 1);
  for_points(box_->rows(), [&](int i, int j, int k) {
    double sum = 0;
    for (const Phase &phase : phases) sum += phase.fraction[0](i, j, k);
    fraction_[0](i, j, k) = sum;
  });
}

// The label of the phase that fills most of the cell.
void SnapshotFields::mix_labels(const std::vector<Phase> &phases) {
  if (!label_) label_ = Field(*box_, 1);
  for_points(box_->rows(), [&](int i, int j, int k) {
    const auto most = std::max_element(phases.begin(), phases.end(), [&](const Phase &p, const Phase &q) {
      return p.fraction[0](i, j, k) < q.fraction[0](i, j, k);
    });
    label_[0](i, j, k) = most->label[0](i, j, k);
  });
}

// I + sum of phi (B - I) over the phases that are not membranes, phi averaged to the positions of the component.
void SnapshotFields::mix_tensors(const std::vector<Phase> &phases) {
  if (!tensor_.field) tensor_.field = Field(*box_, phases[0].tensor.field.count());
  for (int c = 0; c < tensor_.field.count(); ++c) {
    const TensorComponent &component = tensor_.components()[c];
    for_points(box_->rows(), [&](int i, int j, int k) {
      double sum = component.rest();
      for (const Phase &phase : phases)
        if (!phase.material.is_membrane())
          sum +=
              at_component(phase.fraction[0], component, i, j, k) * (phase.tensor.field[c](i, j, k) - component.rest());
      tensor_.field[c](i, j, k) = sum;
    });
  }
}

std::vector<SnapshotField> SnapshotFields::collect(const std::vector<std::string> &wanted, Stored precision,
                                                   const Field &velocity, const Field &pressure,
                                                   const std::vector<Phase> &phases) {
  std::vector<SnapshotField> fields;
  const auto is_wanted = [&](const char *name) {
    return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  const bool solid_fraction = is_wanted("solid_fraction"), left_cauchy_green = is_wanted("left_cauchy_green");
  const bool body = is_wanted("body") && !phases.empty() && phases[0].label;
  const auto add = [&](const std::string &name, ConstView view, const Staggering &staggering, Stored stored) {
    SnapshotField &field = fields.emplace_back();
    field.format = {name, staggering, stored};
    field.components = {view};
  };
  const auto add_tensor = [&](const CarriedTensor &tensor, const std::string &suffix) {
    for (int c = 0; c < tensor.field.count(); ++c)
      add("left_cauchy_green_" + tensor.components()[c].name() + suffix, tensor.field[c], tensor.components()[c].at,
          precision);
  };
  const Field &flow = velocity_;
  if (is_wanted("velocity")) {
    for (int c = 0; c < velocity.count(); ++c)
      add(std::string("velocity_") + axes[c], velocity[c], at_face[c], precision);
    centre_velocity(velocity);
    add("velocity", flow[0], at_centre, precision);
    fields.back().components = {flow[0], flow[1], flow[2]};
  }
  if (is_wanted("pressure")) add("pressure", pressure[0], at_centre, precision);
  if (phases.empty()) return fields;
  const bool several = phases.size() > 1;
  if (several) {
    if (solid_fraction) mix_fractions(phases);
    if (left_cauchy_green) mix_tensors(phases);
    if (body) mix_labels(phases);
  }
  const auto add_phase = [&](const Field &fraction, const CarriedTensor &tensor, const Field &label,
                             const std::string &suffix) {
    if (solid_fraction) add("solid_fraction" + suffix, fraction[0], at_centre, precision);
    if (left_cauchy_green) add_tensor(tensor, suffix);
    if (body) add("body" + suffix, label[0], at_centre, Stored::int32);
  };
  if (several) add_phase(fraction_, tensor_, label_, "");
  for (const Phase &phase : phases)
    add_phase(phase.fraction, phase.tensor, phase.label, several ? "_" + phase.species : "");
  return fields;
}

}  // namespace eulastic

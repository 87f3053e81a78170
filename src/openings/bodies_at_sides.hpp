// Bodies at open boundaries: they flow out or are removed whole, and copies enter from inlet generators
// (docs/method.md, section 20).
#pragma once

#include "boxes/boxed_bodies.hpp"
#include "openings/inlet_generators.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class BodiesAtSides final : public FlowPart {
public:
  /// `generators`: null without inlet generators.
  BodiesAtSides(Flow *flow, BoxedBodies *boxed, InletGenerators *generators)
      : flow_(*flow), boxed_(*boxed), generators_(generators) {}

  PetscErrorCode start() override { return check_sides(true); }
  PetscErrorCode end_step() override { return check_sides(false); }
  PetscErrorCode update_after_labels() override;

private:
  /// State of a body that has passed the end of its inlet generator, on the rank that stores it; has_left on others.
  enum class Coming : int { has_left, waits, comes_in };
  PetscErrorCode check_sides(bool start);
  PetscErrorCode remove_bodies(bool whole);
  PetscErrorCode remove_boxed_bodies(const std::vector<std::size_t> &leaving);
  PetscErrorCode sum_fractions(Field *sum);
  PetscErrorCode find_coming(const std::vector<int> &labels, std::vector<Coming> *states);
  PetscErrorCode copy_boxed_from_inlets(const std::vector<int> &labels);

  Flow &flow_;
  BoxedBodies &boxed_;
  InletGenerators *generators_;
};

}  // namespace eulastic

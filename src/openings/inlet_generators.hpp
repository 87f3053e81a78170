// Inlet generators: stretches of the box beside inflow boundaries; velocity and bodies that pass their end also enter
// through the boundary (docs/method.md, section 20).
#pragma once

#include "boxes/boxed_bodies.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <map>
#include <vector>

namespace eulastic {

class InletGenerators final : public FlowPart {
public:
  /// Cells beyond the end of the stretch that the whole body must have passed; it enters at the same distance from the
  /// boundary.
  static constexpr int beyond = 2;

  InletGenerators(Flow *flow, const BoxedBodies *boxed) : flow_(*flow), boxed_(*boxed) {}
  InletGenerators(const InletGenerators &) = delete;
  InletGenerators &operator=(const InletGenerators &) = delete;
  ~InletGenerators() override;
  PetscErrorCode create();
  PetscErrorCode start() override;
  PetscErrorCode begin_resume() override;
  PetscErrorCode constrain(double dt) override;
  int count() const { return static_cast<int>(stretches_.size()); }

  /// Returns the labels, ascending, of the bodies that have passed the end of their stretch and have not been
  /// forgotten.
  PetscErrorCode find_passed(std::vector<int> *labels) const;
  /// Returns the shift, in cells, from a body to the copy of it that enters.
  Int3 shift_of(int label) const;
  /// Removes a body from its stretch.
  void forget(int label) { inside_.erase(label); }
  /// Adds the body `other` to the stretch of a body.
  void let_in(int label, int other) { inside_[other] = inside_.at(label); }

  /// The stretch of each body that is in one, by its label; the persistent state.
  const std::map<int, int> &inside() const { return inside_; }
  /// Sets inside() to the union over all ranks of `here`. Collective.
  PetscErrorCode set_inside(const std::map<int, int> &here);

private:
  struct Stretch {
    int d, high, cells;
    MPI_Comm line;  ///< ranks along d
  };
  /// Visits the cells of a block that are in the stretch or just beyond its end.
  template <class Visit>
  static void for_cells(const Box &box, const Stretch &stretch, const Visit &visit);
  template <class Visit>
  void for_bodies(const Visit &visit) const;
  PetscErrorCode check_lumen() const;

  Flow &flow_;
  const BoxedBodies &boxed_;
  std::vector<Stretch> stretches_;
  std::map<int, int> inside_;  ///< the same on all ranks
};

}  // namespace eulastic

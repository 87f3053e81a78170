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

  /// Bodies that have passed the end of their stretch, ascending; they keep being named until forget().
  PetscErrorCode find_passed(std::vector<int> *labels) const;
  /// Where a body comes in, relative to where it is.
  Int3 shift_of(int label) const;
  /// A body is not in its stretch any more; another one has come into that.
  void forget(int label) { inside_.erase(label); }
  void come_in(int label, int other) { inside_[other] = inside_.at(label); }

  /// By the labels of bodies: which stretch each is in, if in any. All that a restart needs.
  const std::map<int, int> &inside() const { return inside_; }
  /// Of which every rank names some. Collective.
  PetscErrorCode set_inside(const std::map<int, int> &here);

private:
  struct Stretch {
    int d, high, cells;
    MPI_Comm line;  ///< ranks along d
  };
  template <class Visit>  ///< those of a block, and those just beyond the stretch
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

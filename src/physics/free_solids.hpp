// Elastic bodies that are not attached and never merge with others: each lies in a box of its own, an aligned block of
// the grid around the body, which is whole on one rank. Between the velocity that comes from the grid and the force
// that goes back a body needs no message: docs/architecture.md.
#pragma once

#include "base/petsc.hpp"
#include "field/box_exchange.hpp"
#include "field/phase.hpp"
#include "physics/interface.hpp"
#include "physics/solid_transport.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

class FreeSolids {
public:
  struct Body {
    int number;   ///< from 1 on; no other body of any rank has it
    Box box;      ///< its indices do not wrap around periodic sides
    Phase phase;  ///< of this body alone, on the box; no labels
    /// div(sigma)/rho on the faces phase.tensor.stressed, and the same before the last advance(), until add_forces()
    /// puts the difference there.
    Field force, change;
  };

  /// `sides` must outlive this.
  FreeSolids(const Domain &domain, const Fluid &fluid, const BoxSides &sides);

  /// Adds a body to this rank: `phase` has material, rule and the owned cells of phi and B on `box`, which may be any
  /// block that holds the body. The body must be shorter than a periodic domain by the layers around it.
  PetscErrorCode add(int number, const Box &box, Phase &&phase);

  struct Step {
    double time;  ///< of the velocity
    double dt;
    std::int64_t number;  ///< of the step; orders the directions of the interface
  };
  /// Moves all bodies over dt with a velocity on the grid's faces, of the middle of the step, and finds their forces.
  /// Collective.
  PetscErrorCode advance(const Step &step, const Field &velocity);
  struct Slope {
    Field *field = nullptr;  ///< null: not wanted
    double scale = 0;
  };
  /// Adds the force per mass to `rate`, and `scale` times what the last advance() has changed it by to a slope. Once
  /// after each advance(). Collective.
  PetscErrorCode add_forces(Field &rate, const Slope &slope);

  const std::vector<Body> &bodies() const noexcept { return bodies_; }

private:
  /// Cells between the body and the ends of its box that a step needs: the body moves by less than one, and the faces
  /// of another one feel its stress. And those for what moves until the next fit.
  static constexpr int needed = 2, travel = 2;
  bool is_near_an_end(const Body &body) const;
  PetscErrorCode fit(Body *body, int layers) const;
  PetscErrorCode fit_boxes();

  const Domain *domain_;
  Fluid fluid_;
  const BoxSides *sides_;
  BoxExchange exchange_;
  InterfaceTransport interface_;
  SolidTransport solids_{true};
  std::vector<Body> bodies_;  ///< by their numbers
  std::vector<double> scratch_;
  bool fitted_ = false;  ///< the boxes are those that the exchange knows
};

}  // namespace eulastic

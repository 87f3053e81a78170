// One step of `-method classic`, the scheme of the paper: explicit Euler, and bodies move with the new velocity;
// docs/method.md, section 1.
#pragma once

#include "solver/scheme.hpp"

namespace eulastic {

class ClassicStep final : public Scheme {
public:
  using Scheme::Scheme;
  PetscErrorCode step(double dt, const Observer &in_middle, const Observer &with_pressure) override;

private:
  PetscErrorCode predict(double dt);
};

}  // namespace eulastic

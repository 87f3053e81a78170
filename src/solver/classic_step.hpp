// The scheme of the paper, `-method classic`: plain Euler in time, bodies follow the new velocity; docs/method.md,
// section 1.
#pragma once

#include "solver/scheme.hpp"

namespace eulastic {

class ClassicStep final : public Scheme {
public:
  using Scheme::Scheme;
  PetscErrorCode step(double dt, const Look &in_middle, const Look &with_pressure) override;

private:
  PetscErrorCode predict(double dt);
};

}  // namespace eulastic

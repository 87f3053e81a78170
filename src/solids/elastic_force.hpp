// The elastic force per mass, div(sigma), at faces, for the law of each phase; (7).
#pragma once

#include "base/petsc.hpp"
#include "field/net_force.hpp"
#include "field/phase.hpp"

#include <vector>

namespace eulastic {

/// Adds scale div(sigma) to `force` on rows j_begin <= j < j_end of plane k at the faces that the stress reaches, and,
/// with its factor, to `slope`. Reads one ghost of phi and B.
void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, int j_begin, int j_end, int k,
                       Field &force, const WeightedTarget &slope = {});
/// Does the same for faces of component a outside these rows: those on open boundaries.
void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, const Segment &faces, int a,
                       Field &force, const WeightedTarget &slope = {});

/// force = scale div(sigma), 0 at owned faces without stress.
PetscErrorCode compute_elastic_force(const Box &box, double scale, const std::vector<Phase> &phases, Field &force);

/// force = scale div(sigma) of one phase at the faces in phase.tensor.stressed; other faces keep their values.
void compute_elastic_force(const Box &box, double scale, const Phase &phase, Field &force);

/// Flops of the force on all owned faces.
double elastic_flops(int dimension, const std::vector<Phase> &phases);
double elastic_flops(int dimension, const Phase &phase);

}  // namespace eulastic

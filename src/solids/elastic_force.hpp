// The elastic force div(sigma) per mass at faces, of the law of every phase; (7).
#pragma once

#include "base/petsc.hpp"
#include "field/net_force.hpp"
#include "field/phase.hpp"

#include <vector>

namespace eulastic {

/// force += scale div(sigma) on rows j_begin <= j < j_end of plane k, where they feel any; with a factor also to
/// `slope`. One ghost of phi and B.
void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, int j_begin, int j_end, int k,
                       Field &force, const WeightedTarget &slope = {});
/// The same on faces of component a beyond the rows, those of open sides.
void add_elastic_force(const Box &box, const std::vector<Phase> &phases, double scale, const Segment &faces, int a,
                       Field &force, const WeightedTarget &slope = {});

/// force = scale div(sigma), 0 at owned faces that feel none.
PetscErrorCode compute_elastic_force(const Box &box, double scale, const std::vector<Phase> &phases, Field &force);

/// force = scale div(sigma) of one phase where its faces feel any, phase.tensor.stressed; other faces are not touched.
void compute_elastic_force(const Box &box, double scale, const Phase &phase, Field &force);

/// Of all owned faces.
double elastic_flops(int dimension, const std::vector<Phase> &phases);
double elastic_flops(int dimension, const Phase &phase);

}  // namespace eulastic

// Memory that a run needs and memory of the machine, compared before anything is allocated.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Estimate of the bytes in fields of the largest of `parts` ranks.
double bytes_per_rank(const Config &config, const Int3 &parts);
/// Estimate of the bytes of all bodies in boxes, of all ranks; bytes_per_rank() counts a share of them.
double bytes_in_boxes(const Config &config);

/// Bytes of physical memory of this machine.
double memory_limit();

/// Collective. `refusal`: one line if some node has too little memory for its ranks (-guard_memory), or if a rank would
/// hold more numbers than PETSc's indices can count.
PetscErrorCode check_sizes(MPI_Comm comm, const Config &config, std::string *refusal);

}  // namespace eulastic

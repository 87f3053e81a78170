#include "solids/transport_rows.hpp"

namespace eulastic::transport {
namespace {

// A function for each viscosity: in one for both the compiler keeps too little in registers.
EULASTIC_CLONES Evolved with_same_viscosity(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                            const Field &B, Field &out) {
  return advance_tensor<3>(t, kernels::SameViscosity{}, part, phase, B, out);
}

EULASTIC_CLONES Evolved with_own_viscosity(const TransportTerms &t, const RowPart &part, const Phase &phase,
                                           const Field &B, Field &out) {
  return advance_tensor<3>(t, kernels::OwnViscosity{phase.tensor.rule.viscosity_excess}, part, phase, B, out);
}

}  // namespace

Evolved advance_tensor_3d(const TransportTerms &t, const RowPart &part, const Phase &phase, const Field &B,
                          Field &out) {
  return phase.tensor.rule.viscosity_excess != 0 ? with_own_viscosity(t, part, phase, B, out)
                                                 : with_same_viscosity(t, part, phase, B, out);
}

}  // namespace eulastic::transport

#include "physics/transport_rows.hpp"

namespace eulastic::transport {
namespace {

EULASTIC_CLONES Evolved tensor_2d(const TransportTerms &t, const RowPart &part, const Phase &phase, const Field &B,
                                  Field &out) {
  return with_viscosity(phase.tensor.rule, [&](const auto &viscosity) EULASTIC_BODY {
    return advance_tensor<2>(t, viscosity, part, phase, B, out);
  });
}

}  // namespace

Evolved advance_tensor_2d(const TransportTerms &t, const RowPart &part, const Phase &phase, const Field &B,
                          Field &out) {
  return tensor_2d(t, part, phase, B, out);
}

}  // namespace eulastic::transport

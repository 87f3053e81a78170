// A split as uneven as it may be: what -load_balance can lead to.
#pragma once

#include "grid/domain.hpp"

namespace eulastic {

/// `spec`, of which all processors are given, with three cells in y and z for every rank but the last ones.
inline GridSpec lopsided(GridSpec spec) {
  const Int3 &parts = spec.processors;
  const Domain even = Domain::planned(spec, parts[0] * parts[1] * parts[2]);
  for (int d = 0; d < 3; ++d) {
    for (int p = 0; p < parts[d]; ++p) spec.starts[d].push_back(d == 0 ? even.split().starts[0][p] : 3 * p);
    spec.starts[d].push_back(spec.cells[d]);
  }
  return spec;
}

/// Adds `spec`, if its cells can be shared as it says, evenly and lopsided.
inline void add_splits(const GridSpec &spec, std::vector<GridSpec> *specs) {
  const Int3 &parts = spec.processors;
  if (!Domain::refusal_reason(spec, parts[0] * parts[1] * parts[2]).empty()) return;
  specs->push_back(spec);
  if (parts[1] * parts[2] > 1) specs->push_back(lopsided(spec));
}

}  // namespace eulastic

// Whether work is skipped where a scene has nothing to compute. Skipping must not change a bit of the result, so tests
// switch it off and compare (tests/same_bits).
#pragma once

namespace eulastic {

/// With true every cell of every row is computed, and work space is filled with a wrong value each time it is leased.
/// Must be set before there is a grid. The default is false.
void set_skip_nothing(bool nothing) noexcept;
bool skips_nothing() noexcept;

}  // namespace eulastic

// A switch for skipping work where a scene has nothing to compute. Skipping must not change a bit of the result; tests
// switch it off and compare (tests/same_bits).
#pragma once

namespace eulastic {

/// With true every cell of every row is computed, and work space is filled with a wrong value each time it is leased.
/// Must be called before a grid is created. The default is false.
void set_skip_nothing(bool nothing) noexcept;
bool skips_nothing() noexcept;

}  // namespace eulastic

#include "grid/skipping.hpp"

namespace eulastic {
namespace {

bool skip_nothing = false;

}  // namespace

void set_skip_nothing(bool nothing) noexcept { skip_nothing = nothing; }
bool skips_nothing() noexcept { return skip_nothing; }

}  // namespace eulastic

#include "field/work_space.hpp"

#include "grid/occupied_rows.hpp"

#include <algorithm>

namespace eulastic {
namespace {

#ifdef NDEBUG
constexpr bool debug = false;
#else
constexpr bool debug = true;
#endif
// A routine that reads values it has not written then gives wrong results. NaN is not used, because 0 times NaN is NaN
// and coefficients are 0 at walls.
constexpr double poison = 1e200;

}  // namespace

WorkSpace::Lease::~Lease() {
  if (space_) std::fill_n(space_->holder_.begin() + first_, fields_.count(), nullptr);
}

std::string WorkSpace::holders() const {
  std::string text;
  for (std::size_t f = 0; f < holder_.size(); ++f) text += std::string(f ? ", " : "") + (holder_[f] ? holder_[f] : "-");
  return text;
}

PetscErrorCode WorkSpace::reserve(int count) {
  PetscFunctionBeginUser;
  if (count <= fields_.count()) PetscFunctionReturn(0);
  const bool in_use = std::any_of(holder_.begin(), holder_.end(), [](const char *name) { return name != nullptr; });
  PetscCheck(!in_use, domain_->comm(), PETSC_ERR_PLIB, "work space cannot grow while it is used: %s",
             holders().c_str());
  fields_ = {};
  fields_ = Field(*domain_, count);
  holder_.assign(count, nullptr);
  PetscFunctionReturn(0);
}

PetscErrorCode WorkSpace::lease(const char *name, int count, Lease *lease) {
  PetscFunctionBeginUser;
  const auto at = std::search_n(holder_.begin(), holder_.end(), count, nullptr);
  PetscCheck(at != holder_.end() || count == 0, domain_->comm(), PETSC_ERR_PLIB, "no work space for %s (%d fields): %s",
             name, count, holders().c_str());
  std::fill_n(at, count, name);
  lease->space_ = this;
  lease->first_ = static_cast<int>(at - holder_.begin());
  lease->fields_ = fields_.part(lease->first_, count);
  for (int f = 0; f < count && (debug || skips_nothing()); ++f) lease->fields_.fill(f, poison);
  PetscFunctionReturn(0);
}

}  // namespace eulastic

// Fields that the verbs of a step need one after the other: each takes what it needs, by name, for a scope.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

#include <string>
#include <vector>

namespace eulastic {

class WorkSpace {
public:
  /// Fields of the work space, given back at the end of the scope. Their values are anything; debug builds spoil them.
  class Lease {
  public:
    Lease() = default;
    Lease(const Lease &) = delete;
    Lease &operator=(const Lease &) = delete;
    ~Lease();
    Field &fields() noexcept { return fields_; }
    /// `count` of them, from `first` on.
    Field part(int first, int count) noexcept { return fields_.part(first, count); }

  private:
    friend class WorkSpace;
    WorkSpace *space_ = nullptr;
    int first_ = 0;
    Field fields_;
  };

  explicit WorkSpace(const Domain &domain) : domain_(&domain) {}
  /// At least so many fields; while none is out.
  PetscErrorCode reserve(int count);
  /// `count` fields that follow each other. Fails where so many are not free, with the names of who holds them.
  PetscErrorCode take(const char *name, int count, Lease *lease);
  std::size_t bytes() const { return fields_.bytes(); }

private:
  std::string holders() const;

  const Domain *domain_;
  Field fields_;
  std::vector<const char *> holder_;  ///< of every field, or null
};

}  // namespace eulastic

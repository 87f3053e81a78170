// Fields that the routines of a step use one after the other: each routine leases fields, under a name, for a scope.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// Owns fields on a domain that routines lease.
class WorkSpace {
public:
  /// Leased fields, which are returned at the end of the scope. Their initial values are undefined; debug builds fill
  /// them with a wrong value.
  class Lease {
  public:
    Lease() = default;
    Lease(const Lease &) = delete;
    Lease &operator=(const Lease &) = delete;
    ~Lease();
    Field &fields() noexcept { return fields_; }
    /// Returns `count` of the fields, from `first` on.
    Field part(int first, int count) noexcept { return fields_.part(first, count); }

  private:
    friend class WorkSpace;
    WorkSpace *space_ = nullptr;
    int first_ = 0;
    Field fields_;
  };

  explicit WorkSpace(const Domain &domain) : domain_(&domain) {}
  /// Makes sure that there are at least `count` fields. No field may be leased.
  PetscErrorCode reserve(int count);
  /// Leases `count` consecutive fields. Fails if there are not enough free fields, with the names of all holders.
  PetscErrorCode lease(const char *name, int count, Lease *lease);
  std::size_t bytes() const { return fields_.bytes(); }

private:
  std::string holders() const;

  const Domain *domain_;
  Field fields_;
  std::vector<const char *> holder_;  ///< name of the holder of every field, or null
};

}  // namespace eulastic

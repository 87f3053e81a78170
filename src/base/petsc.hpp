// RAII handles of PETSc objects, and the PETSc headers that all files need.
#pragma once

#include <petscdmda.h>
#include <petscsf.h>
#include <petscsys.h>
#include <petscvec.h>

#include <utility>

namespace eulastic {

/// Owns one PETSc object; movable, not copyable. Pass put() to a Create function.
template <class T, PetscErrorCode (*Destroy)(T *)>
class Handle {
public:
  Handle() = default;
  Handle(const Handle &) = delete;
  Handle &operator=(const Handle &) = delete;
  Handle(Handle &&other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle &operator=(Handle &&other) noexcept {
    if (this != &other) {
      reset();
      object_ = std::exchange(other.object_, nullptr);
    }
    return *this;
  }
  ~Handle() { reset(); }

  T get() const noexcept { return object_; }
  explicit operator bool() const noexcept { return object_ != nullptr; }
  T *put() {
    reset();
    return &object_;
  }
  void reset() noexcept {
    if (object_) (void)Destroy(&object_);
    object_ = nullptr;
  }

private:
  T object_ = nullptr;
};

using DmHandle = Handle<DM, DMDestroy>;
using VecHandle = Handle<Vec, VecDestroy>;
using SfHandle = Handle<PetscSF, PetscSFDestroy>;

}  // namespace eulastic

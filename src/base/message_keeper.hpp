// Keeps the first message of PETSc's error handling for the error message of the program, and suppresses tracebacks.
#pragma once

#include <petscsys.h>

#include <string>

namespace eulastic {

/// Handles PETSc's errors during its lifetime.
class MessageKeeper {
public:
  MessageKeeper() { (void)PetscPushErrorHandler(keep, &text_); }
  ~MessageKeeper() { (void)PetscPopErrorHandler(); }
  MessageKeeper(const MessageKeeper &) = delete;
  MessageKeeper &operator=(const MessageKeeper &) = delete;

  /// Returns the first message since construction, empty if there was none.
  const std::string &text() const { return text_; }

private:
  static PetscErrorCode keep(MPI_Comm, int, const char *, const char *, PetscErrorCode code, PetscErrorType type,
                             const char *message, void *text) {
    std::string &kept = *static_cast<std::string *>(text);
    if (type == PETSC_ERROR_INITIAL && message && kept.empty()) kept = message;
    return code;
  }

  std::string text_;
};

}  // namespace eulastic

// Errors of one rank made everybody's: all ranks return the same message, nobody waits for one that has left.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

/// Collective. Succeeds if `problem` is empty on every rank; else fails on all with the text of the lowest rank. Ends
/// the job if a rank that has failed waits in vain for the others.
PetscErrorCode fail_together(MPI_Comm comm, const std::string &problem);

/// Runs `call`, all of whose errors are of fail_together() or fatal; such an error becomes `problem` instead.
template <class Call>
PetscErrorCode catch_together(Call call, std::string *problem) {
  const auto keep = [](MPI_Comm, int, const char *, const char *, PetscErrorCode code, PetscErrorType type,
                       const char *message, void *text) {
    std::string &kept = *static_cast<std::string *>(text);
    if (type == PETSC_ERROR_INITIAL && message && kept.empty()) kept = message;  // not those of cleaning up after it
    return code;
  };
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(keep, problem));
  const PetscErrorCode code = call();
  PetscCall(PetscPopErrorHandler());
  if (code != 0 && code != PETSC_ERR_FILE_UNEXPECTED)
    SETERRQ(PETSC_COMM_SELF, code, "%s", std::exchange(*problem, std::string()).c_str());
  PetscFunctionReturn(0);
}

}  // namespace eulastic

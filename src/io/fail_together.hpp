// Errors of one rank made everybody's: all ranks return the same message, nobody waits for one that has left.
#pragma once

#include "base/message_keeper.hpp"
#include "base/petsc.hpp"

#include <string>

namespace eulastic {

/// Collective. Succeeds if `problem` is empty on every rank; else fails on all with the text of the lowest rank. Ends
/// the job if a rank that has failed waits in vain for the others.
PetscErrorCode fail_together(MPI_Comm comm, const std::string &problem);

/// Runs `call`, all of whose errors are of fail_together() or fatal; such an error becomes `problem` instead.
template <class Call>
PetscErrorCode catch_together(Call call, std::string *problem) {
  PetscErrorCode code = 0;
  PetscFunctionBeginUser;
  {
    const MessageKeeper keeper;
    code = call();
    if (problem->empty()) *problem = keeper.text();
  }
  if (code != 0 && code != PETSC_ERR_FILE_UNEXPECTED)
    SETERRQ(PETSC_COMM_SELF, code, "%s", std::exchange(*problem, std::string()).c_str());
  PetscFunctionReturn(0);
}

/// For collective calls into HDF5 that do not come back: a rank that fails alone inside one cleans up by collective
/// calls of its own, where it waits for ever, as the others do elsewhere. Ends every rank, with one line that names
/// `path`, if this object lives for more than five minutes. One at a time, for collective calls: all ranks have one.
class Deadline {
public:
  Deadline(int rank, const std::string &path);
  ~Deadline();
  Deadline(const Deadline &) = delete;
  Deadline &operator=(const Deadline &) = delete;
};

}  // namespace eulastic

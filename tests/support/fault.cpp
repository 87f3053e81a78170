// Preloaded by tests: lets one rank fail at the beginning of a verb. EULASTIC_FAULT="KIND VERB RANK COUNT": the
// COUNT-th time RANK begins VERB (a name of base/events.cpp)
//   memory   an allocation fails
//   error    its next MPI call returns an error
//   flush    its next H5Fflush fails, and it alone does not take part
//   crash    it meets SIGSEGV
//   exit     it leaves without a word
#include <dlfcn.h>
#include <hdf5.h>
#include <petscsys.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

// PETSc counts calls by macros of these names.
#undef MPI_Allreduce
#undef MPI_Iallreduce
#undef MPI_Startall
#undef MPI_Bcast

namespace {

char kind[16], verb[32];
int wanted_rank = -1, left = 0;
bool next_call_fails = false, next_flush_fails = false;

PetscErrorCode begin(PetscLogEvent event, int, PetscObject, PetscObject, PetscObject, PetscObject) {
  if (left <= 0 || std::strcmp(petsc_stageLog->eventLog->eventInfo[event].name, verb) != 0) return 0;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank != wanted_rank || --left > 0) return 0;
  std::fprintf(stderr, "fault: %s in %s\n", kind, verb);
  if (!std::strcmp(kind, "memory")) throw std::bad_alloc();
  if (!std::strcmp(kind, "crash")) std::raise(SIGSEGV);
  if (!std::strcmp(kind, "exit")) _exit(0);
  (std::strcmp(kind, "flush") ? next_call_fails : next_flush_fails) = true;
  return 0;
}

int fails() {
  if (!next_call_fails) return MPI_SUCCESS;
  next_call_fails = false;
  return MPI_ERR_OTHER;
}

__attribute__((constructor)) void set() {
  const char *fault = std::getenv("EULASTIC_FAULT");
  if (fault && std::sscanf(fault, "%15s %31s %d %d", kind, verb, &wanted_rank, &left) == 4) PetscLogPLB = begin;
}

}  // namespace

extern "C" {

int MPI_Allreduce(const void *in, void *out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const int failed = fails();
  return failed ? failed : PMPI_Allreduce(in, out, count, type, op, comm);
}

int MPI_Iallreduce(const void *in, void *out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm,
                   MPI_Request *request) {
  const int failed = fails();
  return failed ? failed : PMPI_Iallreduce(in, out, count, type, op, comm, request);
}

int MPI_Startall(int count, MPI_Request requests[]) {
  const int failed = fails();
  return failed ? failed : PMPI_Startall(count, requests);
}

int MPI_Bcast(void *buffer, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  const int failed = fails();
  return failed ? failed : PMPI_Bcast(buffer, count, type, root, comm);
}

herr_t H5Fflush(hid_t file, H5F_scope_t scope) {
  if (next_flush_fails) return -1;
  static const auto flush = reinterpret_cast<herr_t (*)(hid_t, H5F_scope_t)>(dlsym(RTLD_NEXT, "H5Fflush"));
  return flush(file, scope);
}

}  // extern "C"

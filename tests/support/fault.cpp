// Preloaded by tests: lets one rank fail at the beginning of a verb. EULASTIC_FAULT="KIND VERB RANK COUNT": the
// COUNT-th time RANK begins VERB (a name of base/events.cpp)
//   memory   an allocation fails
//   error    its next MPI call returns an error
//   size     it cannot tell HDF5 the size of the next file that is opened
//   bcast    it does not hear what another rank tells while HDF5 opens the next file
//   absent   it cannot open files that are being written
//   flush    its next H5Fflush fails, and it alone does not take part
//   crash    it meets SIGSEGV
//   locked   it meets SIGSEGV while it holds a lock that MPI_Abort waits for
//   heap     malloc finds its memory overwritten and aborts, with its lock held
//   exit     it leaves without a word
// EULASTIC_FSYNC="NAME COUNT": the COUNT-th fsync of a file with NAME in its path fails, and a later one of that file
// is reported. Deadline (io/fail_together.hpp) waits three seconds, not five minutes.
#include <dlfcn.h>
#include <fcntl.h>
#include <hdf5.h>
#include <petscsys.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

// PETSc counts calls by macros of these names.
#undef MPI_Allreduce
#undef MPI_Iallreduce
#undef MPI_Startall
#undef MPI_Bcast
#undef MPI_Abort

namespace {

char kind[16], verb[32];
int wanted_rank = -1, left = 0;
bool next_call_fails = false, met = false;

void overwrite_heap() {
  constexpr std::size_t size = 100000;
  volatile char *const block = static_cast<char *>(std::malloc(size));
  for (std::size_t n = 0; n < 64; ++n) block[size + n] = -1;
  for (int n = 0; n < 100000; ++n) *static_cast<volatile char *>(std::malloc(size)) = 1;
}

PetscErrorCode begin(PetscLogEvent event, int, PetscObject, PetscObject, PetscObject, PetscObject) {
  if (left <= 0 || std::strcmp(petsc_stageLog->eventLog->eventInfo[event].name, verb) != 0) return 0;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank != wanted_rank || --left > 0) return 0;
  std::fprintf(stderr, "fault: %s in %s\n", kind, verb);
  if (!std::strcmp(kind, "memory")) throw std::bad_alloc();
  if (!std::strcmp(kind, "heap")) overwrite_heap();
  met = !std::strcmp(kind, "locked");
  if (!std::strcmp(kind, "crash") || met) std::raise(SIGSEGV);
  if (!std::strcmp(kind, "exit")) _exit(0);
  (std::strcmp(kind, "error") ? met : next_call_fails) = true;
  return 0;
}

bool meets(const char *fault) { return met && !std::strcmp(kind, fault); }

template <class Function>
Function *next(const char *name) {
  return reinterpret_cast<Function *>(dlsym(RTLD_NEXT, name));
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

int MPI_Abort(MPI_Comm comm, int code) {
  while (meets("locked")) ::pause();
  return PMPI_Abort(comm, code);
}

int fsync(int file) {
  static char failed[PATH_MAX];
  static int count = 0;
  char name[64] = "", link[32], path[PATH_MAX] = "";
  int wanted = 0;
  const char *fault = std::getenv("EULASTIC_FSYNC");
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  if (fault && std::sscanf(fault, "%63s %d", name, &wanted) == 2 && ::readlink(link, path, sizeof path - 1) > 0 &&
      std::strstr(path, name)) {
    if (failed[0] && !std::strcmp(path, failed)) std::fprintf(stderr, "fault: fsync again of %s\n", path);
    if (++count == wanted) {
      std::strcpy(failed, path);
      errno = EIO;
      return -1;
    }
  }
  return next<int(int)>("fsync")(file);
}

int MPI_File_open(MPI_Comm comm, const char *name, int mode, MPI_Info info, MPI_File *file) {
  next_call_fails = meets("bcast");
  return PMPI_File_open(comm, name, mode, info, file);
}

int MPI_File_get_size(MPI_File file, MPI_Offset *size) {
  return meets("size") ? MPI_ERR_IO : PMPI_File_get_size(file, size);
}

unsigned alarm(unsigned seconds) {
  const itimerval soon{{0, 0}, {0, static_cast<suseconds_t>(seconds * 10000)}};
  return setitimer(ITIMER_REAL, &soon, nullptr) == 0 ? 0 : 1;
}

int open(const char *path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);  // is there if it is used
  va_end(more);
  if (!meets("absent") || !std::strstr(path, ".tmp"))
    return next<int(const char *, int, ...)>("open")(path, flags, mode);
  errno = ENOENT;
  return -1;
}

herr_t H5Fflush(hid_t file, H5F_scope_t scope) {
  return meets("flush") ? -1 : next<herr_t(hid_t, H5F_scope_t)>("H5Fflush")(file, scope);
}

}  // extern "C"

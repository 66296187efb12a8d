// Open MPI behind the table of `module.hpp`: one collective operation at a time, never blocking, so that the program may look at
// its signals meanwhile.
#define OMPI_SKIP_MPICXX  // classes that MPI has given up
#include <mpi.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

#include "core/ranks/module.hpp"

namespace sysid::ranks {
namespace {

MPI_Request pending = MPI_REQUEST_NULL;

void copy(std::string_view text, char* to, std::size_t size) {
  if (size == 0) return;
  std::size_t const length = std::min(text.size(), size - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

void library(char* text, std::size_t size) {
  char words[MPI_MAX_LIBRARY_VERSION_STRING] = {};
  int length = 0;
  MPI_Get_library_version(words, &length);
  std::string_view const all(words, static_cast<std::size_t>(std::max(0, length)));
  copy(all.substr(0, all.find(',')), text, size);
}

bool failed(int code, char const* what, char* why, std::size_t why_size) {
  if (code == MPI_SUCCESS) return false;
  char words[MPI_MAX_ERROR_STRING] = {};
  int length = 0;
  MPI_Error_string(code, words, &length);
  copy(std::string(what) + ": " + words, why, why_size);
  return true;
}

bool start(int* rank, int* size, char* why, std::size_t why_size) {
  int provided = 0;
  if (failed(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread", why, why_size)) return false;
  if (provided < MPI_THREAD_FUNNELED) {
    copy("this MPI library supports no threads", why, why_size);
    return false;
  }
  return !failed(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler", why, why_size) &&
         !failed(MPI_Comm_rank(MPI_COMM_WORLD, rank), "MPI_Comm_rank", why, why_size) &&
         !failed(MPI_Comm_size(MPI_COMM_WORLD, size), "MPI_Comm_size", why, why_size);
}

bool gather(void const* mine, void* all, int const* counts, int const* places) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return MPI_Iallgatherv(mine, counts[rank], MPI_BYTE, all, counts, places, MPI_BYTE, MPI_COMM_WORLD, &pending) == MPI_SUCCESS;
}

int state() {
  int done = 0;
  if (MPI_Test(&pending, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) return -1;
  return done != 0 ? 1 : 0;
}

void finish() { MPI_Finalize(); }

}  // namespace
}  // namespace sysid::ranks

extern "C" __attribute__((visibility("default"))) sysid::ranks::Module const* sysid_mpi_module() {
  using namespace sysid::ranks;
  static Module const module{SYSID_VERSION, &library, &start, &gather, &state, &finish};
  return &module;
}

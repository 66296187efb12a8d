// The functions of MPI that the program uses. The program and the module that is linked with it share this header and nothing else,
// so a program that is not started under MPI needs nothing of it.
#pragma once
#include <cstddef>

namespace sysid::ranks {

/// The symbol of the module: its version is that of the program that it was built with. All but `library` after `start`, and from
/// the thread that called it.
struct Module {
  char const* version;
  /// Of the MPI library, in its own words.
  void (*library)(char* text, std::size_t size);
  /// Whether this process is now one of those that were started together; where not, the reason in `why`.
  bool (*start)(int* rank, int* size, char* why, std::size_t why_size);
  /// Begins to bring the bytes of each rank to all: counts[r] of rank r, to places[r] of `all`. False where that cannot be.
  bool (*gather)(void const* mine, void* all, int const* counts, int const* places);
  /// Of what was begun last: 1 when it is done, 0 while it is not, -1 where it has failed.
  int (*state)();
  /// All ranks take leave of each other.
  void (*finish)();
};
using ModuleEntry = Module const* (*)();
inline constexpr char const* module_entry = "sysid_mpi_module";

}  // namespace sysid::ranks

// Processes that run one program together: each runs all of it and takes the same decisions, as all random numbers are counted, but
// computes only its part of large batches, whose results they exchange. Rank 0 leads: it alone writes and prints. In a program that
// is not started under MPI there is one rank, and nothing here costs anything.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid::ranks {

/// What the environment says of the launcher (mpirun, or srun with PMIx or PMI-2): whoever was started alone is rank 0 of 1.
struct Launched {
  int rank = 0, size = 1;
  bool first_on_node = true;  // where the launcher says which is
};
Launched launched();

/// There is no MPI, or not the one of the launcher: in words for the user.
struct Unjoined {
  std::string why, help;
};

/// Becomes one of the ranks that were started together; nothing where this one was started alone. Calls from then on come from this
/// thread. Throws Unjoined.
void join();

/// "Open MPI v4.1.4"; empty where there is none, with the reason in why_no_mpi. Loads the module.
std::string mpi_library();
std::string why_no_mpi();

int rank();
int size();
inline bool leads() { return rank() == 0; }
/// For each rank the same: so many that the processors of no node are shared by two threads. Once joined.
int threads();

/// Whether there are several ranks and the calling thread is at a place that all of them reach: the thread that joined, outside of
/// `Apart` and `Own`.
bool together();

/// While it lives the thread exchanges nothing: it does what all ranks do, but not in the same order.
class Apart {
 public:
  Apart();
  ~Apart();
  Apart(Apart const&) = delete;
  Apart& operator=(Apart const&) = delete;
};

/// While it lives the thread works for its rank alone, on something that is exchanged afterwards: a request to stop is heard at
/// once, where otherwise all ranks hear it at their next exchange.
class Own {
 public:
  Own();
  ~Own();
  Own(Own const&) = delete;
  Own& operator=(Own const&) = delete;
};

/// The other ranks have ended, or are elsewhere in the program: this one ends, with the exit code.
struct Parted {
  int code;
};

// What follows must be reached by all ranks, in the same order. It waits for the last of them, and then all know whether one was
// asked to stop. Throws Parted. Outside of `together` there is nobody to exchange with.

/// What each rank has: [size].
std::vector<std::string> gather(std::string_view mine);
/// What rank 0 has.
std::string from_leader(std::string mine);
/// What was written before by rank 0 can be read after it.
void wait_for_all();
/// Whether an interruption was asked for, the same on all ranks; they look for it together about ten times a second. at_once: now.
bool interrupted(bool at_once = false);

/// How often results have been exchanged so far.
std::uint64_t exchanges();

/// [s] of one exchange of nothing, as it is expected now.
double exchange_seconds();

/// Something that all ranks must have alike, in words ("`bench.csv`"), and what it is made of or a digest of that.
struct Alike {
  std::string what, made_of;
};
struct Difference {
  int rank = 0;     // the first that has something other than rank 0
  std::string who;  // "rank 3 (process 1234 on node07)"
  Alike leading;    // what rank 0 has in this place,
  Alike other;      // and what that rank has; empty where it has nothing more
  std::size_t place = 0;
};
/// Of the lists of all ranks; the same answer on all. Nothing outside of `together`.
std::optional<Difference> difference(std::vector<Alike> const& mine);

/// The last exchange: the exit code of this rank as it should be returned. said: what a rank that does not lead would have
/// printed; where it alone has failed the user reads it. parted: in place of an exchange, after Parted.
int end(int code, std::string const& said, bool parted);

}  // namespace sysid::ranks

// Every exchange begins with a word of each rank to all: where it is in the program, whether it was asked to stop, how much it has
// to say. So ranks that have come apart, or have ended, are noticed before anything is waited for.
#include "core/ranks/ranks.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <thread>

#include "core/ranks/module.hpp"
#include "core/ranks/node.hpp"
#include "core/ranks/own.hpp"
#include "core/ranks/worth.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/module.hpp"

namespace sysid::ranks {
namespace {

using Clock = std::chrono::steady_clock;

/// [s] between looks of all ranks for a request to stop, and the most calls without one.
constexpr double look_interval = 0.1;
constexpr int most_silent_looks = 1024;

/// [s] for which a rank that was told to end waits for the others. mpirun kills a second after it has asked, SLURM half a minute.
constexpr double patience_of_mpirun = 0.6, patience_of_others = 8;

/// Bytes of one collective operation: counts are numbers of type int.
constexpr std::int64_t most_at_once = std::int64_t{1} << 30;

/// Exit codes of the program (app/session/options.hpp) that are decided here.
constexpr int internal = 70, interrupted_code = 75;

enum class Kind : std::uint32_t { gather = 1, look, end, wait };

struct Word {
  Kind kind;
  std::uint32_t stop;  // 1: this rank was asked to
  std::uint64_t number, same;
  std::int64_t bytes;  // that follow; of `end` the exit code
  double seconds;      // since the last exchange
  double whole;        // of the last exchange of results, the work before it included; 0: the last was none
};

struct All {
  Module const* module = nullptr;  // null: a single rank
  int rank = 0, size = 1, threads = 1;
  std::thread::id thread;
  Places places;
  Worth worth;
  std::uint64_t exchanges = 0, gathered = 0;
  bool stop = false;  // agreed
  int looks = 0, looks_between = 1;
  Clock::time_point last = Clock::now();
  double whole = 0, longest = 0, bytes = 0;  // of the last exchange: here; the longest `seconds` of all; of results
  double patience = patience_of_others;
  int ended = -1, ended_code = 0;  // a rank that has ended before the others
};

All all;
thread_local int apart = 0, own = 0;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

void say(std::string const& text) { (void)!write(STDERR_FILENO, text.data(), text.size()); }

/// There is no way on from the middle of the program without the others: what was stored last is kept.
[[noreturn]] void lost(std::string const& what) {
  // The leader speaks, or, where it is the one, the first of the others.
  int const gone = all.places.ended(all.rank);
  if (leads() || (gone == 0 && all.rank == 1))
    say(fmt::format(
        "\nsysid: error[{0}]: {1}\nhelp: checkpoints are kept: continue with --resume, on any number of ranks\nmore: sysid explain "
        "{0}\n",
        "E6214", gone >= 0 ? fmt::format("rank {} ({}) has ended in the middle of the run", gone, all.places.words(gone)) : what));
  _exit(interrupted_code);
}

/// Until the operation is done. The processor is left to others when that takes longer than a message.
void wait() {
  Clock::time_point const began = Clock::now();
  double looked = 0;
  for (int tries = 0;; ++tries) {
    int const state = all.module->state();
    if (state == 1) return;
    if (state < 0) lost("the connection to another rank has failed");
    if (tries < 100) {
      sched_yield();
      continue;
    }
    double const waited = seconds_since(began);
    // A twentieth of what it has taken so far.
    std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(waited / 20, 10e-6, 2e-3)));
    if (waited - looked < (interrupt_is_final() ? 0.02 : 1)) continue;
    looked = waited;
    if (all.places.ended(all.rank) >= 0) {
      // Its last words may still be on their way.
      for (int k = 0; k < 50 && all.module->state() == 0; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (all.module->state() != 1) lost("a rank has ended");
      return;
    }
    if (interrupt_is_final() && std::min(waited, seconds_since_final_interrupt()) > all.patience)
      lost("another rank does not answer, after this one was told to stop");
  }
}

/// Bytes of each rank to all, each of so many.
std::string exchange(void const* mine, std::vector<std::int64_t> const& bytes) {
  std::int64_t total = 0;
  std::vector<std::int64_t> begin;
  for (std::int64_t const each : bytes) {
    begin.push_back(total);
    total += each;
  }
  std::string result(static_cast<std::size_t>(total), '\0');
  std::int64_t const part = std::max<std::int64_t>(1, most_at_once / all.size);
  std::int64_t const longest = *std::max_element(bytes.begin(), bytes.end());
  for (std::int64_t from = 0; from < longest; from += part) {
    std::vector<int> counts, places;
    std::int64_t sum = 0;
    for (std::int64_t const each : bytes) {
      counts.push_back(static_cast<int>(std::clamp<std::int64_t>(each - from, 0, part)));
      places.push_back(static_cast<int>(sum));
      sum += counts.back();
    }
    bool const whole = longest <= part;
    std::string piece(whole ? 0 : static_cast<std::size_t>(sum), '\0');
    if (!all.module->gather(static_cast<char const*>(mine) + std::min(from, bytes[static_cast<std::size_t>(all.rank)]),
                            whole ? result.data() : piece.data(), counts.data(), places.data()))
      lost("the connection to another rank has failed");
    wait();
    for (std::size_t r = 0; r < bytes.size() && !whole; ++r)
      std::copy_n(piece.begin() + places[r], counts[r], result.begin() + static_cast<std::ptrdiff_t>(begin[r] + from));
  }
  return result;
}

/// The words of all; a request of any to stop is from now on one of all.
std::vector<Word> words(Kind kind, std::int64_t bytes, std::uint64_t same = 0) {
  Word const mine{kind, interrupt_heard() ? 1U : 0U, ++all.exchanges, same, bytes, seconds_since(all.last), all.whole};
  std::string const text = exchange(&mine, std::vector<std::int64_t>(static_cast<std::size_t>(all.size), sizeof mine));
  std::vector<Word> result(static_cast<std::size_t>(all.size));
  std::memcpy(result.data(), text.data(), text.size());
  double longest = 0, whole = 0;
  for (Word const& each : result) {
    all.stop = all.stop || each.stop != 0;
    longest = std::max(longest, each.seconds);
    whole = std::max(whole, each.whole);
  }
  // What went beyond the work of the slowest rank went into messages, or into waiting for a processor.
  if (whole > 0) all.worth.learn(whole - all.longest, all.bytes);
  all.longest = longest;
  all.whole = 0;
  all.last = Clock::now();
  return result;
}

/// Words of ranks that are at the same place of the program; throws Parted where they are not.
std::vector<Word> words_of_all(Kind kind, std::int64_t bytes, std::uint64_t same = 0) {
  std::vector<Word> result = words(kind, bytes, same);
  for (std::size_t r = 0; r < result.size(); ++r)
    if (result[r].kind == Kind::end) {
      all.ended = static_cast<int>(r);
      all.ended_code = static_cast<int>(result[r].bytes);
      throw Parted{all.ended_code != 0 ? all.ended_code : internal};
    }
  bool const alike = std::all_of(result.begin(), result.end(), [&](Word const& each) {
    return each.kind == result.front().kind && each.number == result.front().number && each.same == result.front().same;
  });
  if (!alike) throw Parted{internal};
  return result;
}

/// What each rank has.
std::vector<std::string> collect(std::uint64_t same, std::string_view mine) {
  std::vector<std::int64_t> bytes;
  for (Word const& each : words_of_all(Kind::gather, static_cast<std::int64_t>(mine.size()), same)) bytes.push_back(each.bytes);
  std::string const text = exchange(mine.data(), bytes);
  std::vector<std::string> result;
  std::size_t from = 0;
  for (std::int64_t const each : bytes) {
    result.push_back(text.substr(from, static_cast<std::size_t>(each)));
    from += static_cast<std::size_t>(each);
  }
  all.last = Clock::now();
  return result;
}

/// Plug-ins of MPI look for its library among what is open to all.
OpenedModule<Module> const& opened() {
  static auto const once = open_module<Module>("sysid_mpi.so", module_entry, ModuleNames::open_to_all);
  return once;
}

bool interruption(bool heard) { return all.stop || (heard && own > 0); }

/// The least of a few, as the leader has measured it.
Worth measure(bool crowded) {
  auto const of_leader = [](double seconds) {
    std::string const text = from_leader({reinterpret_cast<char const*>(&seconds), sizeof seconds});
    std::memcpy(&seconds, text.data(), sizeof seconds);
    return seconds;
  };
  auto const least = [&](std::string const& mine) {
    double result = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 6; ++k) {
      Clock::time_point const began = Clock::now();
      gather(mine);
      result = std::min(result, seconds_since(began));
    }
    return of_leader(result);
  };
  constexpr double megabyte = 1 << 20;
  double const empty = least("");
  double const full = least(std::string(static_cast<std::size_t>(megabyte / all.size), 'x'));
  return {empty, megabyte / std::max(full - empty, 1e-6), crowded};
}

}  // namespace

void join() {
  Launched const launcher = launched();
  if (launcher.size < 2) return;
  if (opened().table == nullptr)
    throw Unjoined{opened().why, "install Open MPI (Debian: sysid-mpi, openmpi-bin) on each node, or run without mpirun"};
  int rank = 0, size = 1;
  char why[512] = {};
  if (!opened().table->start(&rank, &size, why, sizeof why)) throw Unjoined{why, "check that `mpirun -n 2 hostname` works there"};
  if (size != launcher.size)
    throw Unjoined{fmt::format("the launcher has started {} processes, of which MPI sees {}", launcher.size, size),
                   "start it with the mpirun of Open MPI, or with `srun --mpi=pmix`"};
  all.module = opened().table;
  all.rank = rank;
  all.size = size;
  all.thread = std::this_thread::get_id();
  all.patience = std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr ? patience_of_mpirun : patience_of_others;
  set_interruption(&interruption);
  if (rank > 0) leave_files_to_another();
  all.places = Places(gather(place_of_this_process()));
  all.threads = all.places.threads();
  all.worth = measure(all.places.crowded());
  all.gathered = 0;
}

std::string mpi_library() {
  if (opened().table == nullptr) return {};
  char text[128] = {};
  opened().table->library(text, sizeof text);
  return text;
}

std::string why_no_mpi() { return opened().why; }

int rank() { return all.rank; }
int size() { return all.size; }
int threads() { return all.threads; }
double exchange_seconds() { return all.worth.exchange(); }
std::uint64_t exchanges() { return all.gathered; }

bool together() { return all.module != nullptr && apart == 0 && own == 0 && std::this_thread::get_id() == all.thread; }

Apart::Apart() { ++apart; }
Apart::~Apart() { --apart; }
Own::Own() { ++own; }
Own::~Own() { --own; }
bool on_its_own() { return own > 0; }

std::vector<std::string> gather(std::string_view mine) {
  if (!together()) return {std::string(mine)};
  ++all.gathered;
  return collect(0, mine);
}

std::vector<std::string> gather_about(std::uint64_t same, std::string_view mine) {
  if (!together()) return {std::string(mine)};
  ++all.gathered;
  Clock::time_point const before = all.last;
  std::vector<std::string> result = collect(same, mine);
  all.bytes = 0;
  for (std::string const& each : result) all.bytes += static_cast<double>(each.size());
  all.whole = std::chrono::duration<double>(all.last - before).count();
  return result;
}

std::string from_leader(std::string mine) {
  if (!together()) return mine;
  return std::move(gather(leads() ? std::string_view(mine) : std::string_view()).front());
}

std::optional<Difference> difference(std::vector<Alike> const& mine) {
  if (!together()) return std::nullopt;
  std::string text;
  for (Alike const& each : mine) text += each.what + '\0' + each.made_of + '\0';
  auto const read = [](std::string const& from) {
    std::vector<Alike> list;
    for (std::size_t at = 0; at < from.size();) {
      std::size_t const middle = from.find('\0', at), end = from.find('\0', middle + 1);
      list.push_back({from.substr(at, middle - at), from.substr(middle + 1, end - middle - 1)});
      at = end + 1;
    }
    return list;
  };
  std::vector<std::string> const texts = collect(0, text);
  std::vector<Alike> const leading = read(texts.front());
  for (int r = 1; r < all.size; ++r) {
    if (texts[static_cast<std::size_t>(r)] == texts.front()) continue;
    std::vector<Alike> const other = read(texts[static_cast<std::size_t>(r)]);
    for (std::size_t i = 0; i < std::max(leading.size(), other.size()); ++i) {
      Alike const one = i < leading.size() ? leading[i] : Alike(), two = i < other.size() ? other[i] : Alike();
      if (one.what != two.what || one.made_of != two.made_of)
        return Difference{r, fmt::format("rank {} ({})", r, all.places.words(r)), one, two, i};
    }
  }
  return std::nullopt;
}

void wait_for_all() {
  if (together()) words_of_all(Kind::wait, 0);
}

bool interrupted(bool at_once) {
  if (!together() || all.stop) return interrupt_requested();
  if (++all.looks < all.looks_between && !at_once) return false;
  double longest = 0;
  for (Word const& each : words_of_all(Kind::look, 0)) longest = std::max(longest, each.seconds);
  double const wanted = look_interval * all.looks / std::max(longest, 1e-9);
  all.looks_between = static_cast<int>(std::clamp<double>(wanted, 1, most_silent_looks));
  all.looks = 0;
  return all.stop;
}

bool worth(double seconds, double bytes) { return all.worth.worth(seconds, bytes); }
bool perhaps_worth(double seconds) { return all.worth.perhaps(seconds); }

int end(int code, std::string const& said, bool parted) {
  if (all.module == nullptr) return code;
  int result = leads() ? code : 0;
  if (!parted) {
    std::vector<Word> const last = words(Kind::end, code);
    bool const alone = std::any_of(last.begin(), last.end(), [](Word const& each) { return each.kind != Kind::end; });
    if (alone) {
      result = code;
      if (!leads()) say(fmt::format("sysid: rank {} ({}) has failed:\n{}", all.rank, all.places.words(all.rank), said));
    }
  } else if (leads()) {
    say(all.ended >= 0
            ? fmt::format("sysid: stopped, as rank {} has failed\n", all.ended)
            : fmt::format("sysid: this is an error in sysid, not in your file: the ranks came to different places of the "
                          "program at exchange {}\n",
                          all.exchanges));
  }
  all.module->finish();
  all.module = nullptr;
  return result;
}

}  // namespace sysid::ranks

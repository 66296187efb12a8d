// A place as plain data: the name of the node, the process and its name space, and the processors that it may use.
#include "core/ranks/node.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace sysid::ranks {
namespace {

struct Place {
  char node[64];
  std::int64_t process;
  std::uint64_t name_space;  // of process numbers
  cpu_set_t processors;
};

Place read(std::string const& bytes) {
  Place place = {};
  std::memcpy(&place, bytes.data(), std::min(sizeof place, bytes.size()));
  place.node[sizeof place.node - 1] = '\0';
  return place;
}

bool same_node(Place const& a, Place const& b) { return std::strcmp(a.node, b.node) == 0; }

}  // namespace

std::string place_of_this_process() {
  Place place = {};
  (void)gethostname(place.node, sizeof place.node - 1);
  place.process = getpid();
  struct stat facts = {};
  if (stat("/proc/self/ns/pid", &facts) == 0) place.name_space = facts.st_ino;
  CPU_ZERO(&place.processors);
  (void)sched_getaffinity(0, sizeof place.processors, &place.processors);
  return {reinterpret_cast<char const*>(&place), sizeof place};
}

Places::Places(std::span<std::string const> all) : all_(all.begin(), all.end()) {}

/// Of the rank that has the fewest; those that several may use are divided.
double Places::processors() const {
  std::vector<Place> places;
  for (std::string const& each : all_) places.push_back(read(each));
  double least = CPU_SETSIZE;
  for (Place const& own : places) {
    double processors = 0;
    for (int k = 0; k < CPU_SETSIZE; ++k) {
      if (!CPU_ISSET(k, &own.processors)) continue;
      processors += 1.0 / static_cast<double>(std::count_if(places.begin(), places.end(), [&](Place const& other) {
                      return same_node(own, other) && CPU_ISSET(k, &other.processors);
                    }));
    }
    least = std::min(least, processors);
  }
  return least;
}

int Places::threads() const { return std::max(1, static_cast<int>(processors() + 1e-6)); }

bool Places::crowded() const { return processors() < 1 - 1e-6; }

int Places::ended(int own) const {
  if (all_.empty()) return -1;
  Place const here = read(all_[static_cast<std::size_t>(own)]);
  for (std::size_t r = 0; r < all_.size(); ++r) {
    Place const other = read(all_[r]);
    if (!same_node(here, other) || here.name_space != other.name_space || here.name_space == 0) continue;
    if (kill(static_cast<pid_t>(other.process), 0) != 0 && errno == ESRCH) return static_cast<int>(r);
  }
  return -1;
}

std::string Places::words(int rank) const {
  Place const place = read(all_[static_cast<std::size_t>(rank)]);
  return fmt::format("process {} on {}", place.process, place.node);
}

}  // namespace sysid::ranks

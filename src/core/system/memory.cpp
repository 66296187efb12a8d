// Linux: /proc/meminfo, the limit of the address space, the limits of control groups (version 2).
#include "core/system/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

double available() {
  std::ifstream in("/proc/meminfo");
  for (std::string name, unit; in >> name;) {
    double kilobytes = 0;
    if (!(in >> kilobytes)) break;
    std::getline(in, unit);
    if (name == "MemAvailable:") return 1024 * kilobytes;
  }
  return unknown;
}

double within_address_space() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(::sysconf(_SC_PAGESIZE)));
}

double within_control_group() {
  double limit = 0, used = 0;
  if (!(std::ifstream("/sys/fs/cgroup/memory.max") >> limit)) return unknown;  // "max" is no number
  std::ifstream("/sys/fs/cgroup/memory.current") >> used;
  return std::max(0.0, limit - used);
}

}  // namespace

double free_memory() { return std::min({available(), within_address_space(), within_control_group()}); }

std::string format_bytes(double bytes) {
  char const* unit = "B";
  for (char const* larger : {"kB", "MB", "GB", "TB", "PB"}) {
    if (bytes < 999.5) break;
    bytes /= 1000;
    unit = larger;
  }
  return fmt::format("{:.{}f} {}", bytes, bytes < 9.95 && *unit != 'B' ? 1 : 0, unit);
}

int recorded_numbers(int samples, int quantities) {
  std::int64_t const numbers = std::int64_t{samples} * quantities;
  if (numbers > std::numeric_limits<int>::max())
    throw UserError({Severity::error,
                     "E5003",
                     fmt::format("{} samples of {} quantities are more numbers than a simulation records", samples, quantities),
                     std::nullopt,
                     {},
                     "use fewer samples"});
  return static_cast<int>(numbers);
}

void require_memory(std::string const& what, double bytes, std::string const& help) {
  double const free = free_memory();
  if (bytes <= free) return;
  throw UserError({Severity::error,
                   "E5003",
                   fmt::format("{} needs about {} of memory, and {} are free", what, format_bytes(bytes), format_bytes(free)),
                   std::nullopt,
                   {},
                   help});
}

}  // namespace sysid

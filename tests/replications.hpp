// How large statistical tests are. An ordinary run makes them as small as still finds the error that each of them names; a full
// run, before a release, as large as what the documentation reports: SYSID_TEST_SIZE=full ./tests/run (docs/architecture.md).
#pragma once
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ranges>
#include <stdexcept>
#include <string>

namespace sysid {

inline bool full_size() {
  char const* const size = std::getenv("SYSID_TEST_SIZE");
  if (size == nullptr || std::string(size) == "quick") return false;
  if (std::string(size) == "full") return true;
  throw std::runtime_error("SYSID_TEST_SIZE is `quick` or `full`, not `" + std::string(size) + "`");
}

/// How often a test repeats itself; SYSID_REPLICATIONS=N asks for another number, for a study of one test.
inline int replications(int quick, int full) {
  char const* const asked = std::getenv("SYSID_REPLICATIONS");
  return asked != nullptr ? std::atoi(asked) : full_size() ? full : quick;
}

/// Seeds, or numbers of records, to go through.
inline auto counted_from(std::uint64_t first, int count) {
  return std::views::iota(first, first + static_cast<std::uint64_t>(count));
}
inline auto seeds(int quick, int full, std::uint64_t first = 1) { return counted_from(first, replications(quick, full)); }

/// Of `trials`, each with this chance: the number that is exceeded less than once in a thousand times.
inline int rarely_more(int trials, double chance) {
  double term = std::pow(1 - chance, trials), below = term;
  int number = 0;
  for (; below < 0.999; ++number) {
    term *= (trials - number) / (number + 1.0) * chance / (1 - chance);
    below += term;
  }
  return number;
}

/// Between what the mean square of so many standard normal numbers lies but for once in `1/(1 - Phi(sds))` times on either side:
/// the cube root of a chi-square is normal (Wilson and Hilferty 1931).
struct MeanSquare {
  double least, most;
};
inline MeanSquare mean_square_of(double count, double sds = 3.1) {
  double const spread = 2 / (9 * count), low = 1 - spread - sds * std::sqrt(spread);
  return {low > 0 ? std::pow(low, 3) : 0, std::pow(1 - spread + sds * std::sqrt(spread), 3)};
}

}  // namespace sysid

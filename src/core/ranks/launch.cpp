// Launchers say in the environment of a process which one it is.
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "core/ranks/ranks.hpp"

namespace sysid::ranks {
namespace {

std::optional<int> number(char const* name) {
  char const* const text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  std::string_view const digits(text);
  int value = 0;
  auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace

Launched launched() {
  Launched result;
  auto const take = [&](char const* rank, char const* size) {
    std::optional<int> const r = number(rank), n = number(size);
    if (!r || !n || *r >= *n) return false;
    result.rank = *r;
    result.size = *n;
    return true;
  };
  // A job script of SLURM has the number of its tasks in its environment, too, but is none of them: it has no rank of PMI.
  if (!take("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE") && !take("PMI_RANK", "PMI_SIZE") &&
      !take("PMIX_RANK", "SLURM_STEP_NUM_TASKS"))
    take("PMIX_RANK", "SLURM_NTASKS");
  for (char const* name : {"OMPI_COMM_WORLD_LOCAL_RANK", "SLURM_LOCALID"})
    if (auto const local = number(name)) {
      result.first_on_node = *local == 0;
      break;
    }
  return result;
}

}  // namespace sysid::ranks

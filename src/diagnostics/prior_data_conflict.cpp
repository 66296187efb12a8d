// Wording of prior_far_from_data.
#include "diagnostics/prior_data_conflict.hpp"

#include <fmt/format.h>

#include "core/text/number.hpp"

namespace sysid {

std::string times_apart(double ratio) {
  return fmt::format("{} times {}", significant(ratio > 1 ? ratio : 1 / ratio, 2), ratio > 1 ? "larger" : "smaller");
}

Finding prior_far_from_data(std::vector<std::string> names, std::string message) {
  return {FindingCode::prior_far_from_data, Severity::warning, std::move(names), std::move(message),
          "check the units of the data columns, and priors that are wide or misplaced"};
}

}  // namespace sysid

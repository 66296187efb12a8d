// Names of filters, in the order of their rules.
#include "model/filter_rule.hpp"

#include <array>

namespace sysid {
namespace {

constexpr std::array<std::string_view, 5> names{"auto", "kalman", "extended", "unscented", "particle"};

}  // namespace

std::string_view filter_name(FilterRule rule) { return names[static_cast<std::size_t>(rule)]; }

std::optional<FilterRule> find_filter(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<FilterRule>(i);
  return std::nullopt;
}

std::vector<std::string> filter_names() { return {names.begin(), names.end()}; }

}  // namespace sysid

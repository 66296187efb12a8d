// "Did you mean": near names by edit distance.
#include <fmt/format.h>

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"

namespace sysid {

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = last;
    last = row;
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::vector<std::string> nearest(std::string_view text, std::vector<std::string> const& known) {
  std::string const lower_text = in_small_letters(text);
  std::vector<std::pair<int, std::string>> near;
  for (std::string const& name : known) {
    if (name.empty() || name == text) continue;
    std::size_t const longer = std::max(text.size(), name.size());
    // A one-letter name resembles every other: only its capital is near.
    int const cutoff = longer < 2 ? 0 : longer < 5 ? 1 : longer < 9 ? 2 : 3;
    std::string const lower_name = in_small_letters(name);
    // Differences in capitals cost nothing unless everything else is equal.
    std::size_t const surplus = longer - std::min(text.size(), name.size());  // as many edits at least
    int const distance = surplus > static_cast<std::size_t>(cutoff) ? cutoff + 1 : edit_distance(lower_text, lower_name);
    if (distance <= cutoff)
      near.emplace_back(distance, name);
    else if (text.size() >= 3 && lower_name.starts_with(lower_text))
      near.emplace_back(cutoff + 1, name);
  }
  std::stable_sort(near.begin(), near.end(), [](auto const& a, auto const& b) { return a.first < b.first; });
  std::vector<std::string> out;
  for (auto& [distance, name] : near) {
    if (out.size() == 3) break;
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

std::string did_you_mean(std::string_view text, std::vector<std::string> const& known) {
  std::vector<std::string> const names = nearest(text, known);
  switch (names.size()) {
    case 0:
      return "";
    case 1:
      return fmt::format("did you mean `{}`?", names[0]);
    case 2:
      return fmt::format("did you mean `{}` or `{}`?", names[0], names[1]);
    default:
      return fmt::format("did you mean `{}`, `{}` or `{}`?", names[0], names[1], names[2]);
  }
}

}  // namespace sysid

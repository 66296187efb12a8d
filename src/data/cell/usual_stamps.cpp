// A cell is tried with dates and times as programs write them.
#include "data/cell/usual_stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/time_stamp.hpp"

namespace sysid {
namespace {

/// Behind a colon stand the digits of a fraction, or frames, or milliseconds without zeros in front: digits of a fraction only
/// where there are as many in all cells, and more than two.
bool fit(std::string const& text, std::vector<std::string> const& cells) {
  auto const pattern = StampPattern::parse(text);
  auto const first = pattern ? pattern->read(cells.front()) : std::nullopt;
  if (!first) return false;
  bool const counted = pattern->has_counted_fraction();
  constexpr int most_of_frames = 2;
  return (!counted || first->decimals > most_of_frames) && std::all_of(cells.begin(), cells.end(), [&](std::string const& cell) {
           auto const stamp = pattern->read(cell);
           return stamp && (!counted || stamp->decimals == first->decimals);
         });
}

/// What a name says that two numbers with a colon between them are: `mm:ss` of `Zeit [min:s]`; empty: it does not.
std::string two_numbers_in(std::string_view name) {
  std::string const small = in_small_letters(name);
  struct Words {
    std::string_view words, pattern;
  };
  static constexpr Words known[] = {{"mm:ss", "mm:ss"},   {"m:ss", "mm:ss"},   {"min:sec", "mm:ss"}, {"min:s", "mm:ss"},
                                    {"m:s", "mm:ss"},     {"mi:se", "mm:ss"},  {"hh:mm", "hh:mm"},   {"h:mm", "hh:mm"},
                                    {"h:min", "hh:mm"},   {"hr:min", "hh:mm"}, {"std:min", "hh:mm"}, {"hours:min", "hh:mm"},
                                    {"hrs:min", "hh:mm"}, {"h:m", "hh:mm"}};
  auto const is_letter = [&](std::size_t at) { return at < small.size() && small[at] >= 'a' && small[at] <= 'z'; };
  for (Words const& each : known) {
    std::size_t const at = small.find(each.words), end = at + each.words.size();
    bool const longer = at == std::string::npos || (at > 0 && (is_letter(at - 1) || small[at - 1] == ':')) || is_letter(end) ||
                        (end < small.size() && small[end] == ':');
    if (!longer) return std::string(each.pattern);
  }
  return {};
}

/// 0 of steps without gaps, 1 of times that do not fall, 2 of others.
int roughness(std::string const& text, std::vector<std::string> const& cells) {
  auto const pattern = StampPattern::parse(text);
  std::vector<double> steps;
  std::optional<TimeStamp> before;
  for (std::string const& cell : cells) {
    auto const stamp = pattern->read(cell);
    if (before) steps.push_back(seconds_between(*before, *stamp));
    before = stamp;
  }
  if (steps.empty()) return 0;
  std::sort(steps.begin(), steps.end());
  constexpr double of_gap = 1.5;
  return steps.front() < 0 ? 2 : steps.back() > of_gap * steps[(steps.size() - 1) / 2] ? 1 : 0;
}

}  // namespace

std::vector<std::string> patterns_of(std::vector<std::string> const& cells, std::string_view name) {
  static constexpr std::string_view dates[] = {
      "",           "YYYY-MM-DD",  "YYYY/MM/DD",  "YYYY.MM.DD", "DD.MM.YYYY", "DD/MM/YYYY", "MM/DD/YYYY",  "DD-MM-YYYY",
      "MM-DD-YYYY", "DD.MM.YY",    "YY.MM.DD",    "DD/MM/YY",   "MM/DD/YY",   "YY/MM/DD",   "DD-MM-YY",    "MM-DD-YY",
      "YY-MM-DD",   "DD-MMM-YYYY", "DD MMM YYYY", "DD-MMM-YY",  "YYYY-DDD",   "YYYY-DD-MM", "MMM DD YYYY", "YYYYMMDD"};
  static constexpr std::string_view between[] = {" ", "T", ", ", "-", "_", ","};
  static constexpr std::string_view times[] = {"",           "hh:mm:ss",    "hh:mm:ss.f",    "hh:mm:ss,f",
                                               "hh:mm:ss:f", "hh:mm:ss AP", "hh:mm:ss.f AP", "hh:mm",
                                               "hh:mm AP",   "mm:ss.f",     "mm:ss",         "hhmmss"};
  std::vector<std::string> found;
  if (cells.empty()) return found;
  auto const fits = [&](std::string const& text) { return fit(text, cells); };
  if (fits("iso")) return {"iso"};
  // `2024-13` is no thirteenth day of a year.
  auto const digit = [](std::string const& cell, std::size_t at) { return at < cell.size() && is_decimal_digit(cell[at]); };
  bool const days_of_year = std::all_of(cells.begin(), cells.end(), [&](std::string const& cell) {
    return digit(cell, 5) && digit(cell, 6) && digit(cell, 7) && !digit(cell, 8);
  });
  for (std::string_view const date : dates) {
    bool taken = false;
    if ((date == "YYYY-DDD" && !days_of_year) || (date == "YYYY-DD-MM" && !found.empty())) continue;
    for (std::string_view const time : times) {
      if (date.empty() && (time.empty() || time == "hhmmss")) continue;
      for (std::string_view const joint : between) {
        if ((date.empty() || time.empty()) && joint != between[0]) continue;
        for (std::string_view const zone : {std::string_view(), std::string_view("zone")}) {
          if (time.empty() && !zone.empty()) continue;  // `-04` behind a date is no zone
          std::string text = fmt::format("{}{}{}{}", date, date.empty() || time.empty() ? "" : joint, time, zone);
          if (taken || !fits(text)) continue;
          // `00:01` may be hours and minutes, or minutes and seconds.
          bool const either = date.empty() && text == "hh:mm" && fits("mm:ss");
          std::string const told = either ? two_numbers_in(name) : std::string();
          if (told.empty()) found.push_back(std::move(text));
          if (told.empty() && either) found.emplace_back("mm:ss");
          if (!told.empty()) found.push_back(told);
          taken = true;
        }
      }
    }
  }
  // Gaps of a year decide nothing, but they tell which is likely.
  if (found.size() > 1 && !found.front().starts_with("hh"))
    std::stable_sort(found.begin(), found.end(),
                     [&](std::string const& a, std::string const& b) { return roughness(a, cells) < roughness(b, cells); });
  return found;
}

std::string question_of(std::vector<std::string> const& patterns, std::vector<std::string> const& cells) {
  if (patterns.front() == "hh:mm") return fmt::format("`{}` may be hours and minutes or minutes and seconds", cells.back());
  std::vector<std::string> firsts;
  for (std::string_view const first : {"day", "month", "year"})
    if (std::any_of(patterns.begin(), patterns.end(), [&](std::string const& each) { return (each[0] | 0x20) == first[0]; }))
      firsts.emplace_back(first);
  std::string text;
  for (std::size_t i = 0; i < firsts.size(); ++i)
    text += (i == 0 ? "the " : i + 1 == firsts.size() ? " or the " : ", the ") + firsts[i];
  return fmt::format("`{}` may have {} first", cells.front(), text);
}

}  // namespace sysid

// A table of habits, then rules in the order of what is likeliest: a power without its sign, capitals, a product without its blank.
#include "syntax/unit_slips.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/numeric/unit.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr std::pair<std::string_view, std::string_view> quotients[] = {
    {"ms2", "m/s^2"}, {"mss", "m/s^2"},    {"kmh", "km/h"},   {"kph", "km/h"},  {"mps", "m/s"},
    {"rps", "rev/s"}, {"fps", "ft/s"},     {"mph", "mile/h"}, {"lpm", "l/min"}, {"bpm", "1/min"},
    {"dps", "deg/s"}, {"psf", "lbf/ft^2"}, {"cSt", "mm^2/s"},
};

// In small letters they are lengths.
constexpr std::pair<std::string_view, std::string_view> molar[] = {
    {"M", "mol/l"}, {"mM", "mmol/l"}, {"uM", "umol/l"}, {"µM", "umol/l"}, {"μM", "umol/l"}, {"nM", "nmol/l"}, {"pM", "pmol/l"}};

// Of which the letters would tell something else.
constexpr std::pair<std::string_view, std::string_view> other_names[] = {
    {"lbs", "lb"},      {"lbm", "lb"},  {"revs", "rev"},       {"kp", "kgf"},        {"klbf", "kip"},
    {"mseconds", "ms"}, {"msec", "ms"}, {"usec", "us"},        {"pct", "percent"},   {"Vrms", "V"},
    {"dyn", "dyne"},    {"G", "g_n"},   {"µε", "microstrain"}, {"με", "microstrain"}};
constexpr std::pair<std::string_view, std::string_view> products[] = {{"mNm", "mN m"}, {"NS", "N s"}};

bool is_common(std::string_view word) {
  return std::find(common_unit_names().begin(), common_unit_names().end(), word) != common_unit_names().end();
}

// The one common unit that differs in capitals alone.
std::optional<std::string> in_other_capitals(std::string_view word) {
  std::vector<std::string> found;
  for (std::string const& name : common_unit_names())
    if (in_small_letters(name) == in_small_letters(word)) found.push_back(name);
  return found.size() == 1 ? std::optional(found.front()) : std::nullopt;
}

// Of a word that would need several other capitals, `mn` for `MN`: the one common unit that a finger on the key beside gives.
std::optional<std::string> on_neighbouring_key(std::string_view word, std::string_view in_capitals) {
  constexpr std::string_view keyboard[] = {"qwertyuiop", "asdfghjkl", "zxcvbnm"};
  std::ptrdiff_t changed = 0;
  for (std::size_t i = 0; i < word.size(); ++i) changed += word[i] != in_capitals[i] ? 1 : 0;
  if (changed < 2) return std::nullopt;
  std::vector<std::string> found;
  for (std::size_t i = 0; i < word.size(); ++i)
    for (std::string_view const row : keyboard) {
      std::size_t const at = row.find(word[i]);
      if (at == std::string_view::npos) continue;
      for (std::size_t const beside : {at - 1, at + 1}) {
        std::string meant(word);
        if (beside < row.size()) meant[i] = row[beside];
        if (is_common(meant)) found.push_back(std::move(meant));
      }
    }
  return found.size() == 1 ? std::optional(found.front()) : std::nullopt;
}

// Two common units without a blank between them.
std::optional<std::string> as_product(std::string_view word) {
  for (std::size_t i = 1; i < word.size(); ++i)
    if (is_common(word.substr(0, i)) && is_common(word.substr(i)))
      return std::string(word.substr(0, i)) + " " + std::string(word.substr(i));
  return std::nullopt;
}

}  // namespace

std::optional<UnitSlip> unit_slip(std::string_view word) {
  for (auto const& [written, meant] : quotients)
    if (word == written) return UnitSlip{UnitSlip::Kind::quotient, std::string(meant)};
  for (auto const& [written, meant] : other_names)
    if (word == written) return UnitSlip{UnitSlip::Kind::key, std::string(meant)};
  for (auto const& [written, meant] : products)
    if (word == written) return UnitSlip{UnitSlip::Kind::product, std::string(meant)};
  for (auto const& [written, meant] : molar)
    if (word == written) return UnitSlip{UnitSlip::Kind::molar, std::string(meant)};
  std::size_t const end = word.find_last_not_of("0123456789") + 1;
  if (end > 0 && end < word.size()) {
    std::string_view const stem = word.substr(0, end);
    std::optional<std::string> base;
    if (unit_atom(stem)) base = stem;
    if (!base) base = in_other_capitals(stem);
    if (!base) base = as_product(stem);
    if (!base) return std::nullopt;
    return UnitSlip{UnitSlip::Kind::power, *base + "^" + std::string(word.substr(end))};
  }
  if (auto name = in_other_capitals(word)) {
    if (auto key = on_neighbouring_key(word, *name)) return UnitSlip{UnitSlip::Kind::key, *std::move(key)};
    return UnitSlip{UnitSlip::Kind::capitals, *std::move(name)};
  }
  if (auto product = as_product(word)) return UnitSlip{UnitSlip::Kind::product, *std::move(product)};
  return std::nullopt;
}

}  // namespace sysid

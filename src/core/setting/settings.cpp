// Named settings: reading defaults from their table, and typed access.
#include "core/setting/settings.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/setting/table.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

template <class Number>
Number parse_number(SettingRow const& row) {
  Number value{};
  char const* const end = row.fallback.data() + row.fallback.size();
  auto const [stop, error] = std::from_chars(row.fallback.data(), end, value);
  if (error != std::errc() || stop != end)
    throw InternalError(fmt::format("setting `{}` has the unreadable default `{}`", row.name, row.fallback));
  return value;
}

SettingValue fallback_value(SettingRow const& row) {
  switch (row.kind) {
    case SettingKind::integer:
      return parse_number<std::int64_t>(row);
    case SettingKind::real:
      return parse_number<double>(row);
    case SettingKind::word:
      return std::string(row.fallback);
    case SettingKind::flag:
      if (row.fallback != "yes" && row.fallback != "no")
        throw InternalError(fmt::format("the default of setting `{}` is neither yes nor no", row.name));
      return row.fallback == "yes";
    case SettingKind::numbers:
      return std::vector<double>{};
  }
  throw InternalError(fmt::format("setting `{}` has no kind", row.name));
}

bool is_choice(std::string_view choices, std::string_view word) {
  while (!choices.empty()) {
    std::size_t const blank = choices.find(' ');
    if (choices.substr(0, blank) == word) return !word.empty();
    if (blank == std::string_view::npos) return false;
    choices.remove_prefix(blank + 1);
  }
  return false;
}

std::string allowed_range(SettingRow const& row) {
  bool const above = row.minimum > -std::numeric_limits<double>::infinity();
  bool const below = row.maximum < std::numeric_limits<double>::infinity();
  if (row.least_positive > 0) return fmt::format(", 0 or from {} to {}", row.least_positive, row.maximum);
  if (above && below) return fmt::format(" from {} to {}", row.minimum, row.maximum);
  if (above) return fmt::format(" of at least {}", row.minimum);
  if (below) return fmt::format(" of at most {}", row.maximum);
  return {};
}

}  // namespace

std::string setting_text(SettingValue const& value) {
  return std::visit(
      [](auto const& v) -> std::string {
        using Value = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<Value, bool>)
          return v ? "yes" : "no";
        else if constexpr (std::is_same_v<Value, std::vector<double>>)
          return fmt::format("({})", fmt::join(v, ", "));
        else
          return fmt::format("{}", v);  // numbers: the shortest decimal that reads back as the same
      },
      value);
}

SettingRow const* find_setting(std::span<SettingRow const> rows, std::string_view name) { return row_named(rows, name); }

std::string refuse(SettingRow const& row, SettingValue const& value) {
  auto const inside = [&](double x) { return x >= row.minimum && x <= row.maximum && (x <= 0 || x >= row.least_positive); };
  auto const* const whole = std::get_if<std::int64_t>(&value);
  auto const* const number = std::get_if<double>(&value);
  auto const* const word = std::get_if<std::string>(&value);
  switch (row.kind) {
    case SettingKind::integer:
      if (whole && inside(static_cast<double>(*whole))) return {};
      return fmt::format("it must be a whole number{}", allowed_range(row));
    case SettingKind::real:
      if ((whole && inside(static_cast<double>(*whole))) || (number && inside(*number))) return {};
      return fmt::format("it must be a number{}", allowed_range(row));
    case SettingKind::word:
      if (word && is_choice(row.choices, *word)) return {};
      return fmt::format("it must be one of: {}", row.choices);
    case SettingKind::flag:
      if (std::holds_alternative<bool>(value)) return {};
      return "it must be yes or no";
    case SettingKind::numbers:
      if (auto const* const list = std::get_if<std::vector<double>>(&value);
          list && std::all_of(list->begin(), list->end(), inside))
        return {};
      return fmt::format("it must be a list of numbers{}", allowed_range(row));
  }
  return {};
}

Settings::Settings(std::span<SettingRow const> rows) {
  for (SettingRow const& row : rows) values_[std::string(row.name)] = fallback_value(row);
}

SettingValue const& Settings::at(std::string const& name) const {
  auto const found = values_.find(name);
  if (found == values_.end()) throw InternalError(fmt::format("there is no setting `{}`", name));
  return found->second;
}

std::int64_t Settings::integer(std::string const& name) const {
  if (auto const* const value = std::get_if<std::int64_t>(&at(name))) return *value;
  throw InternalError(fmt::format("setting `{}` is not a whole number", name));
}

double Settings::real(std::string const& name) const {
  SettingValue const& value = at(name);
  if (auto const* const number = std::get_if<double>(&value)) return *number;
  if (auto const* const whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  throw InternalError(fmt::format("setting `{}` is not a number", name));
}

std::string const& Settings::word(std::string const& name) const {
  if (auto const* const value = std::get_if<std::string>(&at(name))) return *value;
  throw InternalError(fmt::format("setting `{}` is not a word", name));
}

std::vector<double> const& Settings::numbers(std::string const& name) const {
  if (auto const* const value = std::get_if<std::vector<double>>(&at(name))) return *value;
  throw InternalError(fmt::format("setting `{}` is not a list of numbers", name));
}

bool Settings::flag(std::string const& name) const {
  if (auto const* const value = std::get_if<bool>(&at(name))) return *value;
  throw InternalError(fmt::format("setting `{}` is not true or false", name));
}

}  // namespace sysid

// Digits of a literal that was split at a comma: `1,000`, `0,5`.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "syntax/ast.hpp"

namespace sysid {

/// The digits of a whole number without a sign or a unit, zeros in front kept; empty for all else. Told from the value and
/// the width: what could be `0.5`, `2.0` or `1e0` as well has none, and so `002` has none; three zeros are taken for digits.
inline std::string whole_digits(ast::Argument const& argument) {
  auto const* number = std::get_if<ast::Number>(&argument.value.node);
  if (number == nullptr || number->unit || number->value != std::floor(number->value)) return {};
  std::size_t const width = number->span.end - number->span.begin;
  std::string const digits = fmt::format("{:.0f}", number->value);
  bool const zeros = number->value == 0 && width == 3;
  if (digits.size() > width || (width - digits.size() > 1 && !zeros)) return {};
  return std::string(width - digits.size(), '0') + digits;
}

/// Whether `000` behind a comma is a group of digits that continues `1` or `12,500`. before: the digits of the argument before it.
inline bool continues_group(std::string const& before, bool before_is_group, std::string const& digits) {
  bool const first = !before.empty() && before.size() <= 3 && before.front() != '0';
  return digits.size() == 3 && (before_is_group || first);
}

}  // namespace sysid

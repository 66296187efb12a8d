// From cells to numbers, and which notation a cell may have.
#include "data/cell/number_notation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "data/cell/cells.hpp"

namespace sysid {
namespace {

CellKind parse_plain(std::string_view cell, double& value) {
  if (!cell.empty() && cell.front() == '+') {
    cell.remove_prefix(1);
    if (cell.empty() || cell.front() == '-') return CellKind::text;
  }
  char const* const end = cell.data() + cell.size();
  auto const [stop, error] = std::from_chars(cell.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return CellKind::text;
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is zero to within one; too large is a mistake.
    long double wide = 0;
    if (std::from_chars(cell.data(), end, wide).ec != std::errc{} || std::fabs(wide) > 1) return CellKind::out_of_range;
    value = 0;
  }
  return std::isfinite(value) ? CellKind::number : CellKind::not_finite;
}

/// With `-` for the sign U+2212 that word processors write, and `e` for the letter of Fortran's `1.5D-03`; nothing where neither is
/// there. Without a point before the letter it may be a code, as in `12D3`.
std::optional<std::string> with_usual_signs(std::string_view cell) {
  constexpr std::string_view minus = "\u2212";
  if (cell.find_first_of("dD\xe2") == std::string_view::npos) return std::nullopt;
  std::string text(cell);
  for (std::size_t at; (at = text.find(minus)) != std::string::npos;) text.replace(at, minus.size(), "-");
  std::size_t const letter = text.find_first_of("dD");
  if (letter != std::string::npos && letter > 0 && text.find_first_of(".,") < letter &&
      text.find_first_not_of("0123456789+-.,' ") == letter) {
    std::size_t const digit = text.find_first_of("+-", letter) == letter + 1 ? letter + 2 : letter + 1;
    if (digit < text.size() && text.find_first_not_of("0123456789", digit) == std::string::npos) text[letter] = 'e';
  }
  return text == cell ? std::nullopt : std::optional(text);
}

CellKind parse_in(NumberNotation const& notation, std::string_view cell, double& value) {
  if (notation.plain()) return parse_plain(cell, value);
  std::optional<std::string> const plain = in_plain_notation(cell, notation);
  return plain ? parse_plain(*plain, value) : CellKind::text;
}

}  // namespace

std::optional<std::string> in_plain_notation(std::string_view cell, NumberNotation const& notation) {
  std::string out;
  std::size_t at = 0, group = 0;  // digits since the last sign
  bool grouped = false;
  auto const width = [&]() -> std::size_t {  // of the sign between groups at `at`
    if (notation.thousands == 0 || at >= cell.size()) return 0;
    if (cell[at] == notation.thousands) return 1;
    if (notation.thousands != ' ') return 0;
    for (std::string_view const blank : wide_blanks)
      if (cell.substr(at).starts_with(blank)) return blank.size();
    return 0;
  };
  while (at < cell.size()) {
    if (is_decimal_digit(cell[at])) {
      ++group;
      out += cell[at++];
    } else if (std::size_t const sign = width()) {
      if (group == 0 || group > 3 || (grouped && group != 3)) return std::nullopt;
      if (!grouped && out[out.size() - group] == '0') return std::nullopt;  // 0.500 has no thousands
      grouped = true;
      group = 0;
      at += sign;
    } else if (out.find_first_of("0123456789") == std::string::npos && (cell[at] == '+' || cell[at] == '-')) {
      out += cell[at++];
    } else {
      break;
    }
  }
  if (grouped && group != 3) return std::nullopt;
  if (at < cell.size() && cell[at] == notation.decimal) {
    out += '.';
    ++at;
  } else if (at < cell.size() && (cell[at] == '.' || cell[at] == ',')) {
    return std::nullopt;  // the sign of another notation
  }
  if (cell.substr(at).find_first_of(".,") != std::string_view::npos) return std::nullopt;
  return out + std::string(cell.substr(at));
}

namespace {

/// word: in the notation of the file or, where it is no number there, with a point.
bool same_number(std::string const& word, NumberNotation const& notation, double value) {
  double number = 0;
  std::optional<std::string> const plain = notation.plain() ? std::nullopt : in_plain_notation(word, notation);
  return parse_plain(plain ? *plain : word, number) == CellKind::number && number == value;
}

}  // namespace

CellKind parse_cell(std::string_view cell, NumberNotation const& notation, double& value) {
  cell = trimmed(cell, cell_blanks);
  if (is_quoted_cell(cell)) cell = trimmed(cell.substr(1, cell.size() - 2), cell_blanks);
  if (cell.empty() || cell == "NA") return CellKind::missing;
  for (std::string const& word : notation.missing)
    if (cell == word) return CellKind::missing;
  CellKind kind = parse_in(notation, cell, value);
  if (kind == CellKind::text)
    if (auto const usual = with_usual_signs(cell)) kind = parse_in(notation, *usual, value);
  if (kind == CellKind::number)
    for (std::string const& word : notation.missing)
      if (same_number(word, notation, value)) return CellKind::missing;
  return kind;
}

std::string text_of_number(double value, NumberNotation const& notation) {
  std::string text = fmt::format("{}", value);
  std::replace(text.begin(), text.end(), '.', notation.decimal);
  return text;
}

NotationEvidence notation_of(std::string_view cell) {
  cell = trimmed(cell, cell_blanks);
  if (is_quoted_cell(cell)) cell = trimmed(cell.substr(1, cell.size() - 2), cell_blanks);
  std::string text = with_plain_blanks(cell);
  if (auto usual = with_usual_signs(text)) text = std::move(*usual);
  NotationEvidence evidence;
  std::size_t at = text.empty() || (text[0] != '+' && text[0] != '-') ? 0 : 1;
  std::vector<std::size_t> digits{0};
  std::string marks;
  for (; at < text.size(); ++at) {
    if (is_decimal_digit(text[at])) {
      ++digits.back();
    } else if (std::string_view(".,' ").find(text[at]) != std::string_view::npos) {
      marks += text[at];
      digits.push_back(0);
    } else {
      break;
    }
  }
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    std::size_t const digit = at + 1 < text.size() && (text[at + 1] == '+' || text[at + 1] == '-') ? at + 2 : at + 1;
    if (digit >= text.size() || text.find_first_not_of("0123456789", digit) != std::string::npos) return evidence;
  } else if (at < text.size()) {
    return evidence;
  }
  std::size_t all = 0;
  for (std::size_t const each : digits) all += each;
  if (all == 0) return evidence;
  if (marks.empty()) {
    evidence.number = evidence.plain_digits = true;
    return evidence;
  }
  bool const last_differs = marks.size() > 1 && marks.back() != marks[marks.size() - 2];
  char const last = marks.back();
  std::string_view const groups = std::string_view(marks).substr(0, last_differs ? marks.size() - 1 : marks.size());
  if (groups.find_first_not_of(groups.front()) != std::string_view::npos) return evidence;
  auto const in_threes = [&](std::size_t count) {  // the first `count` signs stand between groups
    if (digits[0] == 0 || digits[0] > 3) return false;
    for (std::size_t i = 1; i <= count; ++i)
      if (digits[i] != 3) return false;
    return true;
  };
  bool const can_be_decimal = last == '.' || last == ',';
  if (last_differs) {
    evidence.number = can_be_decimal && in_threes(groups.size());
    if (evidence.number) evidence.decimal = last, evidence.thousands = groups.front();
  } else if (marks.size() > 1) {
    evidence.number = in_threes(marks.size());
    if (evidence.number) evidence.thousands = last;
  } else if (!can_be_decimal) {
    evidence.number = in_threes(1);
    if (evidence.number) evidence.thousands = last;
  } else {
    evidence.number = true;
    bool const zero = text[text.find_first_of("0123456789.,")] == '0';
    if (in_threes(1) && !zero && at == text.size())
      evidence.either = last;
    else
      evidence.decimal = last;
  }
  return evidence;
}

}  // namespace sysid

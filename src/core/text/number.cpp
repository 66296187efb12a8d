// Numbers, units and columns as text.
#include "core/text/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/text/utf8.hpp"

namespace sysid {

int decade(double x) {
  int power = static_cast<int>(std::floor(std::log10(std::fabs(x))));
  // log10 may round up to the next whole number just below a power of ten.
  if (std::fabs(x) < std::pow(10.0, power)) --power;
  return power;
}

bool needs_exponent(int power) { return power >= 6 || power <= -5; }

std::string with_exponent(double value, int decimals, int exponent) {
  std::string text = fmt::format("{:.{}f}", value / std::pow(10.0, exponent), std::clamp(decimals, 0, 15));
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') text.erase(0, 1);
  return exponent == 0 ? text : fmt::format("{}e{}", text, exponent);
}

std::string shortest(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Inf" : "-Inf";
  return fmt::format("{}", value);
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  // Rounding may lift the value into the next decade: 9.996 has four digits as 10.00.
  double const rounded = leading_number(fmt::format("{:.{}e}", value, digits - 1));
  int const power = decade(rounded);
  int const exponent = needs_exponent(power) ? power : 0;
  return with_exponent(rounded, digits - 1 - power + exponent, exponent);
}

double leading_number(std::string_view text) {
  double number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string superscript(int number) {
  static constexpr std::string_view digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (char const c : std::to_string(number)) out += c == '-' ? "⁻" : digits[c - '0'];
  return out;
}

std::string pretty_number(std::string_view text) {
  std::string out;
  std::size_t const e = text.find('e');
  if (text.starts_with('-') && text.size() > 1) {
    out = "−";
    out += text.substr(1, e == std::string_view::npos ? e : e - 1);
  } else {
    out = text.substr(0, e);
  }
  return e == std::string_view::npos ? out : out + "·10" + superscript(std::stoi(std::string(text.substr(e + 1))));
}

std::string pretty_powers(std::string_view words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::size_t end = i + 1;
    if (words[i] == '^') {
      if (end < words.size() && words[end] == '-') ++end;
      while (end < words.size() && words[end] >= '0' && words[end] <= '9') ++end;
    }
    // A fraction (m^1.5) or an expression (N^(1-n)) stays as it is written.
    bool const number = end > i + 1 && words[end - 1] != '-' && (end == words.size() || words[end] != '.') && end - i < 5;
    if (words[i] == '^' && number) {
      out += superscript(std::stoi(std::string(words.substr(i + 1, end - i - 1))));
      i = end - 1;
    } else {
      out += words[i];
    }
  }
  return out;
}

std::string pretty_unit(std::string_view unit) {
  std::string out;
  for (char const c : pretty_powers(unit)) {
    if (c != ' ' && c != '*')
      out += c;
    else if (!out.ends_with("·"))
      out += "·";
  }
  return out;
}

std::string pretty_units(std::string_view words) {
  std::string out;
  while (true) {
    std::size_t const begin = words.find(" [");
    std::size_t const end = begin == words.npos ? words.npos : words.find(']', begin);
    if (end == words.npos) return out.append(words);
    out.append(words.substr(0, begin + 2)).append(pretty_unit(words.substr(begin + 2, end - begin - 2)));
    words.remove_prefix(end);
  }
}

std::string unit_after_number(std::string_view unit) {
  return unit.empty() || unit == "-" ? std::string() : fmt::format(" {}", unit);
}

std::string probability_text(double probability) {
  return probability > 0 && probability < 0.0005 ? "< 0.001" : fmt::format("{:.3f}", probability);
}

std::string align_columns(std::vector<std::vector<std::string>> const& rows, int left) {
  std::vector<int> widths;
  for (auto const& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], text_width(row[c]));
  }
  std::string out;
  for (auto const& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      std::string const blanks(static_cast<std::size_t>(widths[c] - text_width(row[c])), ' ');
      if (c > 0) line += "  ";
      line += static_cast<int>(c) < left ? row[c] + blanks : blanks + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

}  // namespace sysid

// Rounding by Monte Carlo error, and the alignment of columns.
#include "report/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sysid {

namespace {

/// Power of ten of the leading digit; x finite and not 0.
int decade(double x) {
  int power = static_cast<int>(std::floor(std::log10(std::fabs(x))));
  // log10 may round up to the next whole number just below a power of ten.
  if (std::fabs(x) < std::pow(10.0, power)) --power;
  return power;
}

/// Plain notation reads best between these powers of ten.
bool needs_exponent(int power) { return power >= 6 || power <= -5; }

std::string with_exponent(double value, int decimals, int exponent) {
  std::string text = fmt::format("{:.{}f}", value / std::pow(10.0, exponent), std::clamp(decimals, 0, 15));
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') text.erase(0, 1);
  return exponent == 0 ? text : fmt::format("{}e{}", text, exponent);
}

}  // namespace

std::string shortest(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Inf" : "-Inf";
  return fmt::format("{}", value);
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  // Rounding may lift the value into the next decade: 9.996 has four digits as 10.00.
  // (`stod` would throw where a value is denormal.)
  double const rounded = std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr);
  int const power = decade(rounded);
  int const exponent = needs_exponent(power) ? power : 0;
  return with_exponent(rounded, digits - 1 - power + exponent, exponent);
}

SummaryText format_summary(Summary const& s) {
  SummaryText out;
  double largest = 0;
  for (double const v : {s.mean, s.median, s.q5, s.q95})
    if (std::isfinite(v)) largest = std::max(largest, std::fabs(v));
  int const power = largest > 0 ? decade(largest) : 0;
  int const exponent = needs_exponent(power) ? power : 0;
  // The last digit shown is the leading digit of the error: what lies below it is chance.
  double const error = std::isfinite(s.mcse_mean) && s.mcse_mean > 0 ? s.mcse_mean : s.sd / 10;
  int const decimals = std::isfinite(error) && error > 0 ? exponent - decade(error) : exponent - power + 3;
  auto const location = [&](double v) { return std::isfinite(v) ? with_exponent(v, decimals, exponent) : std::string("-"); };
  // A spread is known to 1/sqrt(2 ess) of itself: two digits.
  auto const spread = [&](double v) {
    if (!std::isfinite(v) || v <= 0) return significant(v, 2);
    // Under the row's power of ten, unless it would read as 20000000e-6 there, or have no digit left.
    int const above = decade(v) - exponent;
    bool const shared = above < 6 && above > -10;
    return shared ? with_exponent(v, exponent - decade(v) + 1, exponent) : significant(v, 2);
  };
  out.mean = location(s.mean);
  out.median = location(s.median);
  out.q5 = location(s.q5);
  out.q95 = location(s.q95);
  out.sd = spread(s.sd);
  out.mad = spread(s.mad);
  out.rhat = std::isfinite(s.rhat) ? fmt::format("{:.3f}", s.rhat) : "-";
  out.ess_bulk = std::isfinite(s.ess_bulk) ? fmt::format("{:.0f}", s.ess_bulk) : "-";
  out.ess_tail = std::isfinite(s.ess_tail) ? fmt::format("{:.0f}", s.ess_tail) : "-";
  return out;
}

std::string superscript(int number) {
  static constexpr std::string_view digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (char const c : std::to_string(number)) out += c == '-' ? "⁻" : digits[c - '0'];
  return out;
}

std::string mean_and_sd(Summary const& summary) {
  if (!std::isfinite(summary.mean)) return "-";
  if (!std::isfinite(summary.sd) || summary.sd <= 0) return pretty_number(significant(summary.mean, 4));
  int const power = decade(std::max(std::fabs(summary.mean), summary.sd));
  int const exponent = needs_exponent(power) ? power : 0;
  double const unit = std::pow(10.0, exponent);
  int const decimals = std::clamp(exponent - decade(summary.sd) + 1, 0, 15);
  std::string const mean = pretty_number(fmt::format("{:.{}f}", summary.mean / unit, decimals));
  std::string const sd = fmt::format("{:.{}f}", summary.sd / unit, decimals);
  return exponent == 0 ? fmt::format("{} ± {}", mean, sd) : fmt::format("({} ± {})·10{}", mean, sd, superscript(exponent));
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

int text_width(std::string_view text) {
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
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

// Axes: round ticks, one power of ten, numbers that do not run into each other, labels with units.
#include "report/figure/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"

namespace sysid::plot {

double Axis::scaled(double value) const { return (value - origin) / std::pow(10.0, exponent); }
double Axis::unscaled(double number) const { return origin + number * std::pow(10.0, exponent); }
double Axis::scaled_width(double width) const { return width / std::pow(10.0, exponent); }

namespace {

/// counted: where numbers are, whatever the range.
Axis make_axis(double low, double high, int count, double margin, bool counted) {
  // What differs in its rounding alone is constant: ticks between could not be told apart, nor counted.
  if (!(high - low > 1e-12 * std::max(std::fabs(low), std::fabs(high)))) {
    double const around = low == 0 ? 1 : 0.05 * std::fabs(low);
    low -= around;
    high += around;
  }
  double const width = high - low;
  low -= margin * width;
  high += margin * width;
  Axis out;
  if (counted || high - low < 1e-5 * std::max(std::fabs(low), std::fabs(high))) {
    // As many digits as all numbers in the range share, which is what the text says as well.
    double const digit = std::pow(10.0, std::ceil(std::log10(high - low)));
    out.origin = std::round((low + high) / 2 / digit) * digit;
    if (out.origin != 0)
      out.origin_text =
          pretty_number(fmt::format("{:.{}g}", out.origin, 2 + static_cast<int>(std::log10(std::fabs(out.origin) / digit))));
  }
  double const largest = std::max(std::fabs(low - out.origin), std::fabs(high - out.origin));
  int const power = static_cast<int>(std::floor(std::log10(largest)));
  if (power >= 4 || power <= -3) out.exponent = static_cast<int>(std::floor(power / 3.0)) * 3;
  out.low = out.scaled(low);
  out.high = out.scaled(high);
  double const rough = (out.high - out.low) / std::max(count, 1);
  double const unit = std::pow(10.0, std::floor(std::log10(rough)));
  auto const ticks_at = [&](double step) { return std::floor(out.high / step + 1e-9) - std::ceil(out.low / step - 1e-9) + 1; };
  double step = unit;
  // The finest that is no finer than asked for, as long as two ticks are left to read a scale from.
  for (double const factor : {2.0, 5.0, 10.0})
    if (step < 0.7 * rough && ticks_at(factor * unit) >= 2) step = factor * unit;
  int const decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(out.low / step - 1e-9); k * step <= out.high + 1e-9 * step; ++k) {
    double const value = k == 0 ? 0 : k * step;
    // A real minus, as wide as a digit.
    out.ticks.emplace_back(value, fmt::format("{}{:.{}f}", value < 0 ? "−" : "", std::fabs(value), decimals));
  }
  return out;
}

}  // namespace

Axis axis(double low, double high, int count, double margin) { return make_axis(low, high, count, margin, false); }
Axis counted_axis(double low, double high, int count, double margin) {
  // What spans zero has no digits to share.
  return make_axis(low, high, count, margin, low > 0 || high < 0);
}

namespace {

/// "mm" for 10⁻³ m: a power of ten as a prefix, where the unit is one that takes it.
std::string prefixed(std::string_view unit, int exponent) {
  static constexpr std::string_view takers[] = {"m", "s", "N", "V", "A", "W", "J", "Pa", "Hz"};
  static constexpr std::pair<int, std::string_view> prefixes[] = {{-9, "n"}, {-6, "µ"}, {-3, "m"}, {3, "k"}, {6, "M"}, {9, "G"}};
  if (std::find(std::begin(takers), std::end(takers), unit) == std::end(takers)) return "";
  for (auto const& [power, prefix] : prefixes)
    // Nobody counts in kiloseconds.
    if (power == exponent && !(unit == "s" && power > 0)) return std::string(prefix) + std::string(unit);
  return "";
}

}  // namespace

std::string axis_label(std::string_view name, std::string_view unit, int exponent) {
  if (std::string const unit_with_prefix = prefixed(unit, exponent); !unit_with_prefix.empty())
    return fmt::format("{} [{}]", name, unit_with_prefix);
  std::string inside = exponent == 0 ? "" : "10" + superscript(exponent);
  std::string const unit_text = pretty_unit(unit);
  if (!unit_text.empty() && unit_text != "-") inside += (inside.empty() ? "" : " ") + unit_text;
  return inside.empty() ? std::string(name) : fmt::format("{} [{}]", name, inside);
}

std::string axis_label(std::string_view name, std::string_view unit, Axis const& axis) {
  if (axis.origin_text.empty()) return axis_label(name, unit, axis.exponent);
  bool const below = axis.origin < 0;
  return axis_label(
      fmt::format("{} {} {}", name, below ? "+" : "−", below ? axis.origin_text.substr(std::string("−").size()) : axis.origin_text),
      unit, axis.exponent);
}

void Axis::reach_ticks() {
  if (ticks.size() < 2) return;
  double const step = ticks[1].first - ticks[0].first;
  double const next = ticks.back().first + step, slack = 0.02 * (high - low);
  if (next > high && next - high < slack) {
    high = next;
    std::string const& last = ticks.back().second;
    std::size_t const dot = last.find('.');
    ticks.emplace_back(next, fmt::format("{:.{}f}", next, dot == std::string::npos ? 0 : last.size() - dot - 1));
  }
}

void Axis::clear_edges(double share) {
  double const edge = share * (high - low);
  std::erase_if(ticks, [&](auto const& tick) { return tick.first < low + edge || tick.first > high - edge; });
}

std::size_t Axis::numbers() const {
  return static_cast<std::size_t>(std::count_if(ticks.begin(), ticks.end(), [](auto const& tick) { return !tick.second.empty(); }));
}

void Axis::thin_numbers(double pixels, bool upright) {
  if (ticks.size() < 2) return;
  double const per_unit = pixels / (high - low);
  auto const room = [&](std::size_t i) { return upright ? 14 : text_pixels(ticks[i].second) + 7; };
  auto const fits = [&](std::size_t first, std::size_t stride) {
    for (std::size_t i = first; i + stride < ticks.size(); i += stride)
      if ((room(i) + room(i + stride)) / 2 > (ticks[i + stride].first - ticks[i].first) * per_unit) return false;
    return true;
  };
  // Where there is a zero it keeps its number.
  std::size_t zero = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (ticks[i].first == 0) zero = i;
  std::size_t stride = 1;
  while (stride < ticks.size() && !fits(zero % stride, stride)) ++stride;
  // One number alone tells no scale: then the outermost two, where they are clear of each other.
  std::size_t const last = ticks.size() - 1, left = (last - zero % stride) / stride + 1;
  bool const outermost = left < 2 && fits(0, last);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (outermost ? i != 0 && i != last : i % stride != zero % stride) ticks[i].second.clear();
}

}  // namespace sysid::plot

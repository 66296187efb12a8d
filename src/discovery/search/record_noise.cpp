// Shortest decimal forms of samples; a search over one ratio.
#include "discovery/search/record_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr int all_digits = 15;
constexpr double steps_of_offset = 4;  // halvings below the root mean square

/// |value| = d.ddd * 10^exponent with so many digits, trailing zeros left out.
struct Decimal {
  int digits = 0, exponent = 0;
};

Decimal decimal_of(double value) {
  std::string const text = fmt::format("{:.16e}", std::abs(value)), shortest = fmt::format("{}", std::abs(value));
  Decimal out;
  out.exponent = std::stoi(text.substr(text.find('e') + 1));
  std::string figures;
  for (char const c : shortest.substr(0, shortest.find('e')))
    if (c != '.') figures += c;
  figures.erase(0, figures.find_first_not_of('0'));
  figures.erase(figures.find_last_not_of('0') + 1);
  out.digits = static_cast<int>(figures.size());
  return out;
}

double likelihood(std::span<double const> residual, std::span<double const> relative) {
  double squares = 0, logs = 0;
  auto const n = static_cast<double>(residual.size());
  for (std::size_t i = 0; i < residual.size(); ++i) {
    squares += residual[i] * residual[i] / (relative[i] * relative[i]);
    logs += elementary::log(relative[i]);
  }
  return -n / 2 * elementary::log(squares / n) - logs;
}

}  // namespace

std::vector<double> rounding_sds(std::span<double const> samples) {
  int digits = 0, decimals = -400;
  std::vector<double> sds(samples.size(), 0);
  std::vector<Decimal> all(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i]) || samples[i] == 0) continue;
    all[i] = decimal_of(samples[i]);
    digits = std::max(digits, all[i].digits);
    decimals = std::max(decimals, all[i].digits - 1 - all[i].exponent);
  }
  if (digits == 0 || digits >= all_digits) return sds;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (all[i].digits > 0) sds[i] = std::pow(10.0, std::max(-decimals, all[i].exponent + 1 - digits)) / std::sqrt(12.0);
  return sds;
}

double rounding_sd(std::span<double const> samples) {
  double squares = 0, count = 0;
  for (double const sd : rounding_sds(samples)) squares += sd * sd, count += sd > 0 ? 1 : 0;
  return count > 0 ? std::sqrt(squares / count) : 0;
}

bool are_levels(std::span<double const> samples) {
  constexpr std::size_t switched = 4, few = 32;
  std::set<double> values;
  for (double const each : samples)
    if (std::isfinite(each) && values.size() <= few) values.insert(each);
  if (values.size() <= switched) return true;
  double const unit = std::sqrt(12.0) * rounding_sd(samples);
  int neighbours = 0;
  for (auto each = values.begin(); std::next(each) != values.end(); ++each) neighbours += *std::next(each) - *each < 1.5 * unit;
  if (values.size() <= few && 4 * neighbours <= static_cast<int>(values.size())) return true;
  int stays = 0, moves = 0, jumps = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    double const change = std::fabs(samples[i] - samples[i - 1]);
    if (change == 0) ++stays;
    if (change > 0) ++moves;
    if (change > 1.5 * unit) ++jumps;
  }
  return stays >= moves && 4 * jumps >= 3 * moves;
}

std::optional<GrowingNoise> growing_noise(std::span<double const> signal, std::span<double const> residual) {
  auto const n = static_cast<double>(signal.size());
  double squares = 0, left = 0;
  for (std::size_t i = 0; i < signal.size(); ++i) squares += signal[i] * signal[i], left += residual[i] * residual[i];
  if (!(squares > 0) || !(left > 0)) return std::nullopt;
  std::vector<double> const constant(signal.size(), 1.0);
  double const alike = likelihood(residual, constant);
  std::optional<GrowingNoise> best;
  double part = 1;
  for (int step = 0; step <= steps_of_offset; ++step, part /= 2) {
    GrowingNoise trial;
    trial.offset = part * std::sqrt(squares / n);
    double const mean = squares / n + trial.offset * trial.offset;
    for (double const m : signal) trial.relative.push_back(std::sqrt((m * m + trial.offset * trial.offset) / mean));
    trial.gain = likelihood(residual, trial.relative) - alike;
    if (!best || trial.gain > best->gain) best = std::move(trial);
  }
  if (!(best->gain > elementary::log(n))) return std::nullopt;
  return best;
}

}  // namespace sysid

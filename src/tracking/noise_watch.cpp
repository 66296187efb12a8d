// Sums over the samples since each row that is kept.
#include "tracking/noise_watch.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/change_detector.hpp"

namespace sysid {
namespace {

constexpr double most_counted = 4;  // that an innovation counts as
constexpr double fewest_samples = 8, fewest_correlated = 64;
constexpr double related = 2.5;           // sds of the correlation of white innovations
constexpr double smallest_change = 1.44;  // of the variance
constexpr double least_factor = 0.05;     // at a time: where little of the variance is noise, it is hardly known

constexpr std::size_t longest_run = 16, decided_at = 12;
constexpr int fewest_far_off = 4;
constexpr double smooth = 0.6, most_of_one = 20;

}  // namespace

void FarOffRun::add(double innovation) {
  values_.push_back(innovation);
  if (values_.size() > longest_run) values_.erase(values_.begin());
  auto const first = std::ranges::find_if(values_, [](double each) { return std::fabs(each) > far_off; });
  values_.erase(values_.begin(), first);
}

bool FarOffRun::is_open() const { return !values_.empty() && values_.size() < decided_at; }

bool FarOffRun::is_smooth() const {
  if (values_.size() < decided_at) return false;
  if (std::ranges::count_if(values_, [](double each) { return std::fabs(each) > far_off; }) < fewest_far_off) return false;
  double squares = 0, products = 0, second = 0;
  auto const at = [&](std::size_t i) { return std::clamp(values_[i], -most_of_one, most_of_one); };
  for (std::size_t i = 0; i < values_.size(); ++i) {
    squares += at(i) * at(i);
    if (i > 0) products += at(i) * at(i - 1);
    if (i > 1) second += at(i) * at(i - 2);
  }
  return std::max(std::fabs(products), std::fabs(second)) > smooth * squares;
}

NoiseWatch::NoiseWatch(int channels, double rate, int window)
    : window_(window),
      threshold_(2 * std::log(2.0 * std::max(1, most_candidates(window) * channels) / rate)),
      last_(static_cast<std::size_t>(channels)) {}

void NoiseWatch::observe(int channel, double innovation, double explained) {
  auto const c = static_cast<std::size_t>(channel);
  double const counted = std::clamp(innovation, -most_counted, most_counted);
  for (Candidate& each : candidates_) {
    Sums& sums = each.channels[c];
    sums.samples += 1;
    sums.squares += counted * counted;
    sums.whole_squares += innovation * innovation;
    sums.explained += explained;
    sums.large += std::fabs(innovation) > most_counted ? 1 : 0;
    sums.products += counted * last_[c].one;
    sums.second_products += counted * last_[c].two;
  }
  last_[c] = {counted, last_[c].one};
}

double NoiseWatch::statistic_of(Sums const& sums) {
  if (sums.samples < fewest_samples || !(sums.squares > 0)) return 0;
  double const mean = sums.squares / sums.samples;
  return sums.samples * (mean - 1 - std::log(mean));
}

/// Nothing of correlated samples that are few, and of too small a change.
std::optional<NoiseChange> NoiseWatch::change_of(Sums const& sums) {
  NoiseChange change;
  change.statistic = statistic_of(sums);
  double const product = std::max(std::fabs(sums.products), std::fabs(sums.second_products));
  change.correlated = product * std::sqrt(sums.samples) > related * sums.squares;
  if (change.correlated && sums.samples < fewest_correlated) return std::nullopt;
  // Where many are large they are no outliers, and count in full.
  double const squares = 8 * sums.large >= sums.samples ? sums.whole_squares : sums.squares;
  change.factor = std::max(least_factor, (squares - sums.explained) / (sums.samples - sums.explained));
  if (change.factor < smallest_change && change.factor > 1 / smallest_change) return std::nullopt;
  return change;
}

/// Of each channel its likeliest row is judged: another row of one whose samples are correlated may look white by chance, but what
/// is said of one channel hides no change of another.
std::optional<NoiseChange> NoiseWatch::detect(double explained) const {
  std::optional<NoiseChange> best;
  double const least = std::max(threshold_, explained);
  for (std::size_t c = 0; c < last_.size(); ++c) {
    Candidate const* likeliest = nullptr;
    double largest = least;
    for (Candidate const& each : candidates_)
      if (double const statistic = statistic_of(each.channels[c]); statistic > largest) {
        likeliest = &each;
        largest = statistic;
      }
    if (likeliest == nullptr || (best && largest <= best->statistic)) continue;
    std::optional<NoiseChange> const change = change_of(likeliest->channels[c]);
    if (!change) continue;
    best = change;
    best->channel = static_cast<int>(c);
    best->row = likeliest->row;
  }
  return best;
}

void NoiseWatch::keep(std::int64_t row) {
  std::erase_if(candidates_, [&](Candidate const& each) { return !is_kept(each.row, row - each.row, window_); });
  if (is_kept(row, 0, window_)) candidates_.push_back({row, std::vector<Sums>(last_.size())});
}

void NoiseWatch::forget() {
  candidates_.clear();
  std::ranges::fill(last_, Last{});
}

}  // namespace sysid

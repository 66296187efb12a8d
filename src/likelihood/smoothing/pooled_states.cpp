// Sample by sample, all draws together.
#include "likelihood/smoothing/pooled_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normal_quantile.hpp"

namespace sysid {
namespace {

constexpr double bytes_of_paths = 256e6;
constexpr int fewest = 8;  // draws, whatever memory they take

/// Every so many of the columns that the paths of all fit in memory.
LaneArray some_of(ConstLanes parameters, double bytes_each) {
  int const fit = std::max(fewest, static_cast<int>(std::min(bytes_of_paths / bytes_each, 1e6)));
  int const width = std::min(parameters.width(), fit);
  LaneArray chosen(parameters.rows(), width);
  for (int w = 0; w < width; ++w) {
    int const from = static_cast<int>(static_cast<long>(w) * parameters.width() / width);
    for (int r = 0; r < parameters.rows(); ++r) chosen(r, w) = parameters(r, from);
  }
  return chosen;
}

struct Share {
  double below = 0, density = 0;
};

Share share_below(std::vector<double> const& means, std::vector<double> const& sds, double x) {
  Share sum;
  for (std::size_t d = 0; d < means.size(); ++d) {
    if (sds[d] <= 0) {
      sum.below += means[d] <= x ? 1 : 0;
      continue;
    }
    double const z = (x - means[d]) / sds[d];
    sum.below += 0.5 * elementary::erfc(-z / std::numbers::sqrt2);
    sum.density += elementary::exp(-0.5 * z * z) / (sds[d] * std::sqrt(2 * std::numbers::pi));
  }
  auto const count = static_cast<double>(means.size());
  return {sum.below / count, sum.density / count};
}

class Pooled {
 public:
  Pooled(std::vector<Smoother::Path> const& paths, std::size_t first, std::size_t samples) : paths_(paths) {
    band_.draws = static_cast<int>(paths.size());
    for (auto const& path : paths) band_.excluded += path.solved ? 0 : 1;
    for (std::size_t i = first; i < first + samples; ++i) add(i);
  }
  Band take() { return std::move(band_); }

 private:
  void add(std::size_t place) {
    means_.clear();
    sds_.clear();
    for (auto const& path : paths_) {
      if (!path.solved || !std::isfinite(path.mean[place]) || !std::isfinite(path.sd[place])) continue;
      means_.push_back(path.mean[place]);
      sds_.push_back(path.sd[place]);
    }
    double const nan = std::numeric_limits<double>::quiet_NaN();
    if (means_.empty()) return append(nan, nan, nan, nan);
    NormalMixture const mixture = normal_mixture(means_, sds_);
    append(mixture.mean, mixture.sd, mixture.lower, mixture.upper);
  }

  void append(double mean, double sd, double lower, double upper) {
    band_.mean.push_back(mean);
    band_.sd.push_back(sd);
    band_.lower.push_back(lower);
    band_.upper.push_back(upper);
  }

  std::vector<Smoother::Path> const& paths_;
  std::vector<double> means_, sds_;
  Band band_;
};

}  // namespace

NormalMixture normal_mixture(std::vector<double> const& means, std::vector<double> const& sds) {
  auto const count = static_cast<double>(means.size());
  double mean = 0, variance = 0;
  for (double const each : means) mean += each / count;
  for (std::size_t d = 0; d < means.size(); ++d) variance += ((means[d] - mean) * (means[d] - mean) + sds[d] * sds[d]) / count;
  return {mean, std::sqrt(variance), normal_mixture_quantile(means, sds, 0.025), normal_mixture_quantile(means, sds, 0.975)};
}

double normal_mixture_quantile(std::vector<double> const& means, std::vector<double> const& sds, double probability) {
  double const z = standard_normal_quantile(probability);
  double const infinity = std::numeric_limits<double>::infinity();
  double low = infinity, high = -infinity, middle = 0, narrowest = infinity;
  for (std::size_t d = 0; d < means.size(); ++d) {
    double const each = means[d] + z * sds[d];
    low = std::min(low, each);
    high = std::max(high, each);
    middle += each / static_cast<double>(means.size());
    if (sds[d] > 0) narrowest = std::min(narrowest, sds[d]);
  }
  // Newton's steps within what is known to hold the quantile, halves of it where they leave it.
  double const least = narrowest < infinity ? 1e-10 * narrowest : 1e-12 * (high - low);
  double x = std::clamp(middle, low, high);
  while (high - low > least) {
    Share const at = share_below(means, sds, x);
    (at.below < probability ? low : high) = x;
    double const step = (probability - at.below) / at.density;
    double const next = x + step;
    if (std::abs(step) <= least) return std::clamp(next, low, high);
    x = next > low && next < high ? next : low + 0.5 * (high - low);
    if (x <= low || x >= high) break;  // nothing lies between
  }
  return x;
}

std::vector<Band> pooled_states(Smoother const& smoother, ConstLanes parameters) {
  auto const count = static_cast<std::size_t>(smoother.samples());
  double const bytes_each = 2 * sizeof(double) * static_cast<double>(smoother.quantities().size() * count);
  std::vector<Smoother::Path> const paths = smoother.run(some_of(parameters, bytes_each));
  std::vector<Band> bands;
  for (std::size_t q = 0; q < smoother.quantities().size(); ++q) bands.push_back(Pooled(paths, q * count, count).take());
  return bands;
}

}  // namespace sysid

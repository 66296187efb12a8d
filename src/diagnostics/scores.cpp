// Pointwise bands and scores.
#include "diagnostics/scores.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/numeric/tails.hpp"
#include "diagnostics/residuals/residual_tests.hpp"

namespace sysid {
namespace {

/// Samples whose draws are taken out of the trajectories together: each trajectory is read in runs, and sums of several samples do
/// not wait for one another.
constexpr std::size_t at_once = sequences_at_once;

/// Mean and variance over trajectories, as `mean` and `sample_variance` have them, of samples from `from` on.
struct Moments {
  double mean[at_once] = {}, variance[at_once] = {};

  Moments(std::vector<std::vector<double> const*> const& trajectories, std::size_t from, std::size_t count) {
    auto const n = static_cast<double>(trajectories.size());
    double next[at_once] = {};  // those beyond `count` stay 0
    auto const take = [&](std::vector<double> const& trajectory) {
      std::copy_n(trajectory.begin() + static_cast<std::ptrdiff_t>(from), count, next);
    };
    for (std::vector<double> const* each : trajectories) {
      take(*each);
      for (std::size_t k = 0; k < at_once; ++k) mean[k] += next[k];
    }
    for (double& each : mean) each /= n;
    for (std::vector<double> const* each : trajectories) {
      take(*each);
      for (std::size_t k = 0; k < at_once; ++k) variance[k] += (next[k] - mean[k]) * (next[k] - mean[k]);
    }
    for (double& each : variance) each /= n - 1;
  }
};

/// The smallest and the largest draws of each sample in order, kept by comparisons without branches, of several samples at once.
class Tails {
 public:
  static constexpr std::size_t most = 8;  // draws of a tail, up to which this is quicker than sorting

  Tails(std::vector<std::vector<double> const*> const& trajectories, std::size_t depth, std::size_t from, std::size_t count) {
    for (std::size_t r = 0; r < depth; ++r)
      for (std::size_t k = 0; k < at_once; ++k) smallest_[r][k] = infinity, largest_[r][k] = -infinity;
    double next[at_once] = {};
    for (std::vector<double> const* each : trajectories) {
      std::copy_n(each->begin() + static_cast<std::ptrdiff_t>(from), count, next);
      add_to_tails(smallest_[0], largest_[0], static_cast<int>(depth), next);
    }
  }

  double lower(PredictivePlace place, std::size_t sample) const {
    double const low = smallest_[place.below][sample], high = smallest_[place.above][sample];
    return low + place.share * (high - low);
  }
  /// draws: all.
  double upper(PredictivePlace place, std::size_t draws, std::size_t sample) const {
    double const low = largest_[draws - 1 - place.below][sample], high = largest_[draws - 1 - place.above][sample];
    return low + place.share * (high - low);
  }

 private:
  double smallest_[most][at_once], largest_[most][at_once];
};

}  // namespace

Band band(std::vector<std::vector<double>> const& trajectories) {
  auto const [usable, predictable] = usable_trajectories(trajectories);
  Band out;
  out.draws = static_cast<int>(trajectories.size());
  out.excluded = static_cast<int>(trajectories.size() - usable.size());
  if (usable.empty()) return out;
  std::size_t const samples = usable[0]->size();
  std::vector<double> values(usable.size());
  PredictivePlace const low = predictive_place(usable.size(), 0.025), high = predictive_place(usable.size(), 0.975);
  std::size_t const depth = std::max(low.above + 1, usable.size() - high.below);
  bool const few = depth <= Tails::most;
  for (std::size_t from = 0; from < samples; from += at_once) {
    std::size_t const count = std::min(at_once, samples - from);
    Moments const moments(usable, from, count);
    Tails const tails(usable, few ? depth : 0, from, count);
    for (std::size_t k = 0; k < count; ++k) {
      if (predictable[from + k] == 0) {
        for (auto* column : {&out.mean, &out.sd, &out.lower, &out.upper}) column->push_back(std::nan(""));
        continue;
      }
      out.mean.push_back(moments.mean[k]);
      out.sd.push_back(usable.size() > 1 ? std::sqrt(moments.variance[k]) : 0);
      if (few) {
        out.lower.push_back(tails.lower(low, k));
        out.upper.push_back(tails.upper(high, usable.size(), k));
        continue;
      }
      for (std::size_t d = 0; d < usable.size(); ++d) values[d] = (*usable[d])[from + k];
      out.lower.push_back(predictive_quantile(values, 0.025));
      out.upper.push_back(predictive_quantile(values, 0.975));
    }
  }
  return out;
}

std::vector<Score> scores(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored) {
  std::vector<std::size_t> rows;
  std::vector<double> observed, predicted;
  for (std::size_t i = 0; i < quantity.measured.size() && i < quantity.response.mean.size(); ++i) {
    if (scored[i] == 0 || !std::isfinite(quantity.measured[i]) || !std::isfinite(quantity.response.mean[i])) continue;
    rows.push_back(i);
    observed.push_back(quantity.measured[i]);
    predicted.push_back(quantity.response.mean[i]);
  }
  if (rows.empty()) return {};
  double const error = quantity.logarithmic ? nmse_of_logarithms(observed, predicted) : nmse(observed, predicted);
  std::vector<Score> out = {{{ScoreKind::nmse}, error}, {{ScoreKind::rmse}, rmse(observed, predicted)}};
  if (quantity.noisy.mean.empty()) return out;
  double inside = 0, within = 0;
  auto const n = static_cast<double>(rows.size());
  for (std::size_t const i : rows) {
    double const y = quantity.measured[i];
    if (y >= quantity.noisy.lower[i] && y <= quantity.noisy.upper[i]) ++inside;
    if (std::fabs(y - quantity.noisy.mean[i]) <= 3 * quantity.noisy.sd[i]) ++within;
  }
  out.push_back({{ScoreKind::coverage_95}, inside / n});
  out.push_back({{ScoreKind::coverage_3sd}, within / n});
  return out;
}

std::vector<FitLine> fit_lines(Report const& report) {
  std::vector<FitLine> lines = report.fit;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities) {
      std::vector<Score> const found = scores(quantity, prediction.scored);
      if (found.empty()) continue;
      auto line = std::find_if(lines.begin(), lines.end(), [&](FitLine const& each) {
        return each.experiment == prediction.experiment && each.channel == quantity.name && each.optimum_of.empty();
      });
      if (line == lines.end()) line = lines.insert(line, {prediction.experiment, quantity.name, "", {}, {}});
      line->unit = quantity.unit;
      for (Score const& score : found)
        if (!find_score(line->scores, score.name)) line->scores.push_back(score);
    }
  return lines;
}

}  // namespace sysid

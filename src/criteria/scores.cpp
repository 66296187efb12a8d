#include "criteria/scores.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

void add_rows(ConstLanes log_density, std::vector<double>& sum) {
  for (int i = 0; i < log_density.rows(); ++i)
    for (int s = 0; s < log_density.width(); ++s) sum[static_cast<std::size_t>(s)] += log_density(i, s);
}

}  // namespace

SampleScore score_sample(std::span<double const> log_density, int chains, DrawInfluence& influence) {
  std::vector<double> const equal(log_density.size(), -elementary::log(static_cast<double>(log_density.size())));
  LeftOut const weights = leave_out(log_density, chains);
  SampleScore const out{log_mean(equal, log_density), sample_variance(log_density), log_mean(weights.log_weights, log_density),
                        weights.pareto_k};
  influence.add(weights, log_density, out.elpd_loo);
  return out;
}

BlockScore score_block(LeftOut const& weights, ConstLanes log_density, DrawInfluence& influence) {
  BlockScore out{weights.pareto_k, {}};
  for (int i = 0; i < log_density.rows(); ++i) {
    out.elpd.push_back(log_mean(weights.log_weights, log_density.row(i)));
    influence.add(weights, log_density.row(i), out.elpd.back());
  }
  return out;
}

BlockScore leave_block_out(ConstLanes log_density, int chains, DrawInfluence& influence) {
  std::vector<double> sum(static_cast<std::size_t>(log_density.width()), 0);
  add_rows(log_density, sum);
  return score_block(leave_out(sum, chains), log_density, influence);
}

void FutureOut::leave(ConstLanes log_density) { add_rows(log_density, log_likelihood_); }

BlockScore FutureOut::score(ConstLanes log_density, double most_k, DrawInfluence& influence) const {
  LeftOut const weights = leave_out(log_likelihood_, chains_);
  if (weights.pareto_k > most_k) return {weights.pareto_k, {}};
  return score_block(weights, log_density, influence);
}

bool FutureOut::tells_nothing() const {
  double const k = leave_out(log_likelihood_, chains_).pareto_k;
  return std::isinf(k) && k < 0;
}

LogScore sum_of(std::span<double const> values) {
  std::vector<double> known;
  for (double const each : values)
    if (!std::isnan(each)) known.push_back(each);
  auto const n = static_cast<double>(known.size());
  if (std::ranges::any_of(known, [](double each) { return std::isinf(each); }))
    return {std::accumulate(known.begin(), known.end(), 0.0), std::nan(""), static_cast<int>(known.size()), 0};
  return {n * (known.empty() ? 0 : mean(known)), std::sqrt(n * sample_variance(known)), static_cast<int>(known.size()), 0};
}

std::vector<int> block_ends(int rows, int blocks) {
  std::vector<int> ends = {0};
  for (int b = 1; b <= blocks; ++b)
    if (int const end = static_cast<int>(static_cast<long long>(rows) * b / blocks); end > ends.back()) ends.push_back(end);
  return ends;
}

}  // namespace sysid

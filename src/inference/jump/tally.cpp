// Stationary distributions, and errors by leaving out parts.
#include "inference/jump/tally.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "search/stored_values.hpp"

namespace sysid::jump {
namespace {

using json = nlohmann::json;

void add_to(Part& sum, Part const& part) {
  for (std::size_t i = 0; i < sum.chance.size(); ++i) {
    sum.chance[i] += part.chance[i];
    sum.proposed[i] += part.proposed[i];
  }
}

Part empty_part(int models) {
  auto const size = static_cast<std::size_t>(models * models);
  return {std::vector<double>(size, 0.0), std::vector<double>(size, 0.0)};
}

/// Sets of models between which jumps go both ways are one; only that in which chains have been most has a distribution.
/// visits: [M].
std::vector<int> connected(Eigen::MatrixXd const& rate, std::vector<double> const& visits) {
  auto const models = static_cast<int>(rate.rows());
  std::vector<int> best;
  double most = -1;
  for (int first = 0; first < models; ++first) {
    std::vector<int> set = {first};
    for (std::size_t next = 0; next < set.size(); ++next)
      for (int other = 0; other < models; ++other)
        if (rate(set[next], other) > 0 && rate(other, set[next]) > 0 && std::find(set.begin(), set.end(), other) == set.end())
          set.push_back(other);
    double sum = 0;
    for (int const each : set) sum += visits[static_cast<std::size_t>(each)];
    if (sum > most) best = set, most = sum;
  }
  std::sort(best.begin(), best.end());
  return best;
}

std::vector<double> log_shares_of(Part const& sum, int models) {
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(models, models);
  for (int from = 0; from < models; ++from)
    for (int to = 0; to < models; ++to) {
      auto const there = static_cast<std::size_t>(from * models + to), back = static_cast<std::size_t>(to * models + from);
      // A pair of models tells nothing until both ways have been tried.
      if (from != to && sum.proposed[there] > 0 && sum.proposed[back] > 0) rate(from, to) = sum.chance[there] / sum.proposed[there];
    }
  std::vector<double> visits(static_cast<std::size_t>(models), 0.0);
  for (std::size_t i = 0; i < sum.proposed.size(); ++i) visits[i / visits.size()] += sum.proposed[i];
  std::vector<int> const set = connected(rate, visits);
  auto const size = static_cast<Eigen::Index>(set.size());
  std::vector<double> logs(static_cast<std::size_t>(models), -infinity);
  // pi (R - diag(row sums)) = 0 by elimination that subtracts nothing (Grassmann, Taksar and Heyman 1985): small shares keep their
  // digits.
  Eigen::MatrixXd r(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j)
      r(i, j) = i == j ? 0 : rate(set[static_cast<std::size_t>(i)], set[static_cast<std::size_t>(j)]);
  for (Eigen::Index n = size - 1; n > 0; --n) {
    double const out = r.row(n).head(n).sum();
    for (Eigen::Index i = 0; i < n; ++i) r(i, n) /= out;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        if (i != j) r(i, j) += r(i, n) * r(n, j);
  }
  std::vector<double> share = {1.0};
  double total = 1;
  for (Eigen::Index n = 1; n < size; ++n) {
    double sum_in = 0;
    for (Eigen::Index i = 0; i < n; ++i) sum_in += share[static_cast<std::size_t>(i)] * r(i, n);
    share.push_back(sum_in);
    total += sum_in;
  }
  for (std::size_t k = 0; k < set.size(); ++k) logs[static_cast<std::size_t>(set[k])] = elementary::log(share[k] / total);
  return logs;
}

/// Of all parts, or of all but one.
Part sum_of(Tally const& tally, Part const* without = nullptr) {
  Part sum = empty_part(tally.models);
  for (Part const& part : tally.all)
    if (&part != without) add_to(sum, part);
  return sum;
}

/// log odds against the first model that has a share, and probabilities.
struct Derived {
  std::vector<double> log_odds, probability;
};

Derived derived(std::vector<double> const& log_share, std::vector<double> const& bias, std::size_t reference) {
  Derived result;
  double highest = -infinity, total = 0;
  for (std::size_t m = 0; m < bias.size(); ++m) {
    result.log_odds.push_back(log_share[m] + bias[m]);
    highest = std::max(highest, result.log_odds.back());
  }
  for (double const each : result.log_odds) {
    result.probability.push_back(each == -infinity ? 0 : elementary::exp(each - highest));
    total += result.probability.back();
  }
  for (double& each : result.probability) each /= total;
  double const of_reference = result.log_odds[reference];
  for (double& each : result.log_odds) each -= of_reference;
  return result;
}

/// Variance of a mean whose influences in the parts are known, and the ratio of variances between chains and within them.
struct Scatter {
  double variance = 0, spread = 1;
};

Scatter scatter_of(std::vector<double> const& pseudo, int parts) {
  auto const per = static_cast<std::size_t>(parts), chains = pseudo.size() / per;
  double mean = 0, within = 0, between = 0, all = 0;
  for (double const each : pseudo) mean += each / static_cast<double>(pseudo.size());
  for (std::size_t c = 0; c < chains; ++c) {
    double of_chain = 0;
    for (std::size_t s = 0; s < per; ++s) of_chain += pseudo[c * per + s] / static_cast<double>(per);
    for (std::size_t s = 0; s < per; ++s) within += (pseudo[c * per + s] - of_chain) * (pseudo[c * per + s] - of_chain);
    between += (of_chain - mean) * (of_chain - mean);
  }
  for (double const each : pseudo) all += (each - mean) * (each - mean);
  auto const n = static_cast<double>(pseudo.size()), of_chains = static_cast<double>(chains);
  Scatter scatter;
  scatter.variance = n > 1 ? all / (n * (n - 1)) : infinity;
  if (chains < 2 || per < 2) return scatter;
  within /= n - of_chains;
  between /= of_chains - 1;
  if (within > 0) scatter.spread = static_cast<double>(per) * between / within;
  if (scatter.spread > disagreement) scatter.variance = std::max(scatter.variance, between / of_chains);
  return scatter;
}

}  // namespace

Tally::Tally(int model_count, int chains, int part_count) : models(model_count), parts(part_count) {
  all.assign(static_cast<std::size_t>(chains * part_count), empty_part(model_count));
}

void Tally::add(int chain, int part, int from, int to, double chance) {
  Part& place = all[static_cast<std::size_t>(chain * parts + part)];
  auto const i = static_cast<std::size_t>(from * models + to);
  place.chance[i] += chance;
  ++place.proposed[i];
}

std::vector<double> log_shares(Tally const& tally) { return log_shares_of(sum_of(tally), tally.models); }

Estimate estimate(Tally const& tally, std::vector<double> const& bias, std::vector<double> const& prior) {
  auto const models = static_cast<std::size_t>(tally.models);
  Part const sum = sum_of(tally);
  Estimate result;
  result.log_share = log_shares_of(sum, tally.models);
  Derived const whole = derived(result.log_share, bias, 0);
  auto const leader =
      static_cast<std::size_t>(std::max_element(whole.probability.begin(), whole.probability.end()) - whole.probability.begin());
  Derived const of_all = derived(result.log_share, bias, leader);
  result.probability = of_all.probability;
  std::vector<Derived> without;
  for (Part const& part : tally.all) without.push_back(derived(log_shares_of(sum_of(tally, &part), tally.models), bias, leader));
  auto const n = static_cast<double>(without.size());
  // Pseudo-values: their mean is the estimate, their scatter its error.
  auto const scatter = [&](auto const& value) {
    std::vector<double> pseudo;
    for (Derived const& each : without) pseudo.push_back(n * value(of_all) - (n - 1) * value(each));
    return scatter_of(pseudo, tally.parts);
  };
  for (std::size_t m = 0; m < models; ++m) {
    Scatter const of_probability = scatter([m](Derived const& each) { return each.probability[m]; });
    result.error.push_back(std::isfinite(of_probability.variance) ? std::sqrt(of_probability.variance) : 1);
    double const odds = of_all.log_odds[m];
    bool const known = std::isfinite(odds);
    Scatter const of_odds = known ? scatter([m](Derived const& each) { return each.log_odds[m]; }) : Scatter{infinity, 1};
    result.factor.push_back(known ? odds - elementary::log(prior[m] / prior[leader]) : -infinity);
    result.factor_error.push_back(std::isfinite(of_odds.variance) ? std::sqrt(of_odds.variance) : infinity);
    result.spread.push_back(std::max(of_odds.spread, of_probability.spread));
  }
  return result;
}

json store(Tally const& tally) {
  json parts = json::array();
  for (Part const& part : tally.all) parts.push_back({checkpoint::encode(part.chance), checkpoint::encode(part.proposed)});
  return parts;
}

Tally restore_tally(json const& stored, int models, int chains, int parts) {
  Tally tally(models, chains, parts);
  if (stored.size() != tally.all.size()) throw checkpoint::Mismatch("its chains differ in number or parts");
  auto const size = static_cast<std::size_t>(models * models);
  for (std::size_t i = 0; i < tally.all.size(); ++i)
    tally.all[i] = {checkpoint::decode(stored.at(i).at(0), size), checkpoint::decode(stored.at(i).at(1), size)};
  return tally;
}

}  // namespace sysid::jump

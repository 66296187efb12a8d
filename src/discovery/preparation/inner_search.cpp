// A grid over probabilities of the priors, then from each local maximum a pattern search (Hooke and Jeeves 1961).
#include "discovery/preparation/inner_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

constexpr int prior_draws = 1023;
constexpr double finest = 1.0 / 512;                         // of a prior's probability: a fit by simulation goes on from there
constexpr double fine_step = 0x1p-20, final_step = 0x1p-44;  // of the best few, of the best
constexpr double flat = 1e-4;                                // log evidence: smaller steps gain less
constexpr std::size_t most_refined = 3;
constexpr double far_behind = 20;
constexpr std::size_t most_climbs = 16;

/// Points along each parameter.
int points_of(std::size_t parameters) { return parameters == 1 ? 41 : parameters == 2 ? 13 : parameters == 3 ? 6 : 4; }

using Place = std::vector<double>;  // probabilities of the priors

class InnerSearcher {
 public:
  InnerSearcher(CheckedDictionary const& dictionary, std::span<Experiment const> experiments, regression::Method const& method)
      : dictionary_(dictionary), experiments_(experiments), method_(method), points_(points_of(dictionary.inner.size())) {
    for (InnerParameter const& each : dictionary.inner) draws_.push_back(sorted_draws(each, prior_draws));
  }

  InnerSearch run(int most, bool final_values) {
    std::vector<double> const grid = evaluate_grid();
    std::vector<std::size_t> tops;
    for (std::size_t i = 0; i < grid.size(); ++i)
      if (is_top(grid, i)) tops.push_back(i);
    std::stable_sort(tops.begin(), tops.end(), [&](std::size_t a, std::size_t b) { return grid[a] > grid[b]; });
    if (tops.size() > most_climbs) tops.resize(most_climbs);
    for (std::size_t const top : tops) climbed_.push_back(climb({place(top), grid[top]}, 0.5 / points_, finest));
    std::ranges::stable_sort(climbed_, [](Climb const& a, Climb const& b) { return a.log_evidence > b.log_evidence; });
    for (std::size_t k = 0; final_values && k < std::min(climbed_.size(), most_refined); ++k)
      if (climbed_[k].log_evidence > climbed_.front().log_evidence - far_behind)
        climbed_[k] = climb(climbed_[k], finest / 2, fine_step);
    auto const best = std::ranges::max_element(climbed_, {}, &Climb::log_evidence);
    if (final_values && best != climbed_.end()) *best = climb(*best, fine_step / 2, final_step);
    for (Climb const& each : climbed_) add_mode(each);
    if (out_.modes.empty()) out_.modes.push_back({values(Place(size(), 0.5)), -std::numeric_limits<double>::infinity()});
    std::stable_sort(out_.modes.begin(), out_.modes.end(),
                     [](auto const& a, auto const& b) { return a.log_evidence > b.log_evidence; });
    std::erase_if(out_.modes, [&](auto const& each) { return each.log_evidence < out_.modes.front().log_evidence - far_behind; });
    if (out_.modes.size() > static_cast<std::size_t>(most)) out_.modes.resize(static_cast<std::size_t>(most));
    return std::move(out_);
  }

 private:
  std::size_t size() const { return draws_.size(); }

  Place place(std::size_t index) const {
    Place at;
    for (std::size_t p = 0; p < size(); ++p, index /= static_cast<std::size_t>(points_))
      at.push_back((static_cast<double>(index % static_cast<std::size_t>(points_)) + 0.5) / points_);
    return at;
  }

  std::vector<double> evaluate_grid() {
    auto const count = static_cast<std::size_t>(std::pow(points_, size()));
    std::vector<double> grid;
    for (std::size_t i = 0; i < count && !out_.interrupted; ++i) grid.push_back(evidence(place(i)));
    return grid;
  }

  /// Not below any neighbour along a parameter, and finite.
  bool is_top(std::vector<double> const& grid, std::size_t index) const {
    if (!std::isfinite(grid[index])) return false;
    std::size_t stride = 1;
    for (std::size_t p = 0; p < size(); ++p, stride *= static_cast<std::size_t>(points_)) {
      std::size_t const along = index / stride % static_cast<std::size_t>(points_);
      if (along > 0 && grid[index - stride] >= grid[index]) return false;
      if (along + 1 < static_cast<std::size_t>(points_) && index + stride < grid.size() && grid[index + stride] > grid[index])
        return false;
    }
    return true;
  }

  struct Climb {
    Place at;
    double log_evidence;
  };

  Climb climb(Climb from, double step, double last) {
    auto& [at, best] = from;
    while (step >= last && !out_.interrupted) {
      Place const before = at;
      double least = best;
      if (!explore(at, best, step, &least)) {
        if (best - least < flat) break;
        step /= 2;
        continue;
      }
      // On in the direction of all steps together, as long as that is better: ridges are seldom along one parameter.
      for (bool better = size() > 1; better && !out_.interrupted;) {
        Place ahead = at;
        for (std::size_t p = 0; p < size(); ++p) ahead[p] = std::clamp(2 * at[p] - before[p], 0.0, 1.0);
        double found = evidence(ahead);
        explore(ahead, found, step);
        better = found > best;
        if (better) at = ahead, best = found;
      }
    }
    return from;
  }

  void add_mode(Climb const& found) {
    std::vector<double> const at = values(found.at);
    if (std::none_of(out_.modes.begin(), out_.modes.end(), [&](auto const& each) { return each.values == at; }))
      out_.modes.push_back({at, found.log_evidence});
  }

  /// A step along each parameter to where it is better. Whether there was one. least: the lowest evidence that was met.
  bool explore(Place& at, double& best, double step, double* least = nullptr) {
    bool any = false;
    for (std::size_t p = 0; p < size(); ++p)
      for (double const side : {-step, step}) {
        Place next = at;
        next[p] = std::clamp(at[p] + side, 0.0, 1.0);
        if (next[p] == at[p] || out_.interrupted) continue;
        double const found = evidence(next);
        if (least != nullptr) *least = std::min(*least, found);
        if (!(found > best)) continue;
        at = next;
        best = found;
        any = true;
        break;
      }
    return any;
  }

  std::vector<double> values(Place const& at) const {
    std::vector<double> out;
    for (std::size_t p = 0; p < at.size(); ++p) {
      double const rank = at[p] * (prior_draws - 1);
      auto const below = std::min(static_cast<std::size_t>(rank), static_cast<std::size_t>(prior_draws - 2));
      double const share = rank - static_cast<double>(below);
      out.push_back((1 - share) * draws_[p][below] + share * draws_[p][below + 1]);
    }
    return out;
  }

  double evidence(Place const& at) {
    ++out_.evaluations;
    regression::Discovery const found = regression::discover(
        with_inner(dictionary_.numbers, dictionary_.open, dictionary_.inner, values(at)), experiments_, method_);
    out_.interrupted = out_.interrupted || found.interrupted;
    double sum = 0;
    for (regression::FoundEquation const& equation : found.equations) {
      double best = -std::numeric_limits<double>::infinity();
      for (regression::Support const& support : equation.supports) best = std::max(best, support.log_evidence);
      sum += equation.found ? best : -std::numeric_limits<double>::infinity();
    }
    return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum;
  }

  CheckedDictionary const& dictionary_;
  std::span<Experiment const> experiments_;
  regression::Method const& method_;
  int points_;
  std::vector<std::vector<double>> draws_;  // [inner], sorted
  std::vector<Climb> climbed_;
  InnerSearch out_;
};

}  // namespace

InnerSearch search_inner(CheckedDictionary const& dictionary, std::span<Experiment const> experiments,
                         regression::Method const& method, int most, bool final_values) {
  return InnerSearcher(dictionary, experiments, method).run(most, final_values);
}

}  // namespace sysid

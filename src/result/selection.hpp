// What a selection among models found.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/setting/settings.hpp"
#include "result/draws.hpp"
#include "result/facts.hpp"
#include "result/finding.hpp"
#include "result/parameter_info.hpp"
#include "result/summary.hpp"

namespace sysid {

struct Report;

/// What a population has come to.
struct PopulationRecord {
  double threshold = 0;
  std::uint64_t proposed = 0, simulated = 0, failed = 0;  // up to the last accepted proposal
  int accepted = 0;
  double ess = 0;  // 1 / sum w^2
  struct OfModel {
    std::uint64_t proposed = 0, failed = 0;
    int particles = 0;
    double probability = 0;  // sum of weights
    double nearest = 0;      // smallest distance; infinite without particles
  };
  std::vector<OfModel> models;

  /// Worden et al. (8.21): the share of the particles, a probability in population 1 alone.
  double share(int model) const;
  /// Accepted part of the proposals; 1 before the first.
  double acceptance() const;
};

/// A weighted parameter of one model, declared unit.
struct WeightedSummary {
  std::string name, unit;
  double mean = 0, sd = 0, median = 0, q5 = 0, q95 = 0;
};

/// What chains that jump between models have come to. A model's number is its place among the candidates.
struct JumpRecord {
  int chains = 0;
  std::uint64_t samples = 0, burn_in = 0;  // of each chain
  struct OfModel {
    double error = 0;                               // one standard error of its probability
    double log_bayes_factor = 0, factor_error = 0;  // against the most probable model; -infinity: never visited
    double log_evidence = 0, evidence_error = 0;    // by importance sampling from the proposals of the jumps
    double visits = 0;                              // part of the iterations, under `bias`
    double bias = 0;                                // log of the factor by which its visits were made rarer
    double accepted_in = 0, accepted_out = 0;       // of the jumps to it from others, and from it to others
    double accepted_within = 0;                     // of the walks
    double worth = 0;                               // part of their number that its proposals are worth
    double spread = 0;                              // variance between chains over that within them; 1 is chance
    std::uint64_t simulations = 0;
    std::string solver;  // empty where nothing is solved
    friend bool operator==(OfModel const&, OfModel const&) = default;
  };
  std::vector<OfModel> models;
};

struct SelectedModel {
  std::string name;
  double prior = 0, probability = 0, share = 0;
  int died_in = 0;         // the first population without it; 0: it lives
  bool by_chance = false;  // when it died, that need not have been its distance
  std::vector<ParameterInfo> parameters;
  LaneArray theta, declared;             // [D x particles]; of a dead model: its last ones
  std::vector<double> weight, distance;  // weights sum to 1 within the model; of jumping chains no distance
  std::vector<double> log_density;       // of jumping chains alone: of prior times likelihood, on the sampler's coordinates
  std::vector<WeightedSummary> summaries;
  /// Parameters that its statements name and its arguments take out: `k2` of duffing(quadratic = 0). They stay at their priors.
  std::vector<std::string> absent = {};
  Facts simulated_with = {};  // the solver of its particles and its settings; empty where nothing is solved

  bool is_absent(std::string const& parameter) const { return std::find(absent.begin(), absent.end(), parameter) != absent.end(); }
};

struct SelectionResult {
  std::vector<SelectedModel> models;  // in the user's order
  std::vector<PopulationRecord> populations;
  std::optional<JumpRecord> jumps;  // in place of populations
  double threshold = 0;             // that all particles satisfy
  double next_threshold = 0;        // that another population would have had
  std::string stopped_by;           // in words
  bool ran_out = false;             // a budget ended it, not its own rule
  Settings settings;
  Findings findings;
  bool interrupted = false;
  std::optional<Finding> failure;
};

/// A model's posterior by its likelihood, for comparison.
struct LikelihoodCheck {
  double log_evidence = 0;  // Laplace's, all constants kept; -infinity: no finite optimum was found
  double probability = 0;   // among the models
  std::string solver;       // "rk4(substeps = 2)": under which both are; empty where nothing is solved
  bool given_up =
      false;  // the climb to its mode, 30 nats and more below the most probable model: the evidence is where that was seen
};

struct SelectionReport {
  SelectionResult result;
  std::string distance;                                     // "nmse"
  std::vector<std::optional<LikelihoodCheck>> likelihoods;  // per model; empty: not asked for
  std::vector<std::vector<Summary>> refined;                // per model: from chains on the likelihood; may be empty
  std::vector<Draws> refined_draws;                         // per model
  std::optional<double> floor;                              // what noise alone leaves of the distance
  std::string floor_words;                                  // of which noise
  std::vector<WeightedSummary> shared;                      // over all models that have them
  struct Unmoved {
    std::string name, unit, prior, why;  // "log_uniform(1e-7, 1e-3)"
  };
  std::vector<Unmoved> shared_unmoved;  // shared names that no particle has: their prior stands
  std::uint64_t resampling_seed = 0;

  /// The most probable model.
  int leader() const;
  /// Whether chains on the likelihood have sampled a model's posterior.
  bool has_chains(std::size_t model) const;
};

/// Particles resampled to equal weights as draws of one chain; declared units.
Draws resampled_draws(SelectedModel const& model, std::uint64_t seed);

/// The most probable model's draws as a report of their own, which figures read: those of chains on its likelihood where there are
/// any, else its particles, resampled. Without what is absent from it.
Report leading_model(Report const& report);

/// Mean, sd, median and quantiles under weights that sum to 1; values and weights of one length. The sd is that of the weighted
/// particles, without a correction for their number; a quantile is the smallest value with at least that weight up to it.
WeightedSummary summarise_weighted(std::string name, std::string unit, std::span<double const> values,
                                   std::span<double const> weights);

/// Indices of `count` of the weighted items, each drawn in proportion to its weight by systematic resampling with one uniform
/// number.
std::vector<int> resample(std::span<double const> weights, int count, double uniform);

/// As the summary of draws, without diagnostics; ess: how many independent particles it is worth, for the digits of a table.
Summary as_summary(WeightedSummary const& summary, double ess);
/// 1 / sum w^2 of weights that sum to 1: how many particles of equal weight they are worth.
double effective_particles(std::vector<double> const& weights);

}  // namespace sysid

// Information criteria and predictive scores of a fit, as plain data. Log scores are sums over the scored samples of log densities
// in the declared units of their channels, in nats: larger is better.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sysid {

/// An estimate of the expected log predictive density.
struct LogScore {
  double sum = 0;
  double error = 0;  // one standard error, by the spread of samples as if independent; NaN for one sample
  int samples = 0;
  double monte_carlo_error = 0;  // by the number of draws; NaN where weights are not to be trusted
};

/// What the parameters of highest density, or likelihood, have explained.
struct ScoreAtMode {
  double log_likelihood = 0;
  int parameters = 0;  // sampled ones, each member of a hierarchy among them
  int samples = 0;
  bool of_likelihood = false;  // its maximum; else that of the posterior density

  double aic() const { return -2 * log_likelihood + 2 * parameters; }
  double bic() const;
};

/// The deviance, -2 log likelihood, of the draws and of their mean.
struct Deviance {
  double mean = 0, variance = 0;
  std::optional<double> at_mean;  // none where the mean of the draws has no solution

  /// Spiegelhalter, Best, Carlin and van der Linde 2002
  /// Nothing where it is not positive: the mean of the draws is then no estimate, as between two modes.
  std::optional<double> p_d() const { return at_mean && mean > *at_mean ? std::optional(mean - *at_mean) : std::nullopt; }
  /// Gelman, Carlin, Stern and Rubin 2004, sec. 6.7
  double p_v() const { return variance / 2; }
};

/// Pareto's k above which importance weights of so many draws are not to be trusted: min(0.7, 1 - 1/log10 draws).
///                                                                                      Vehtari et al. 2024
double largest_k(int draws);
constexpr double largest_k_of_many = 0.7;
/// Variance of a sample's log density above which WAIC is not.                        Vehtari, Gelman and Gabry 2017
constexpr double largest_p_waic = 0.4;

/// Shapes of the tails of importance weights: up to 0.5, to 0.7, to 1, and above.
using ParetoCounts = std::array<int, 4>;

/// Blocks of consecutive rows of a record that were left out one by one, or with all later ones.
struct LeftOutBlocks {
  std::string experiment;
  std::vector<double> pareto_k;  // of each block that has a score, in the order of time
  int asked = 0;                 // the earliest of these blocks may have no score; 0: the record is too short
  int first_row = 0;             // from which row of the file on there is a score; 0: nowhere
  int last_row = 0;
  int own_draws = 0;  // so many of these blocks are predicted by draws of their own, not by weighted draws of the fit
};

/// Whether weights reach all blocks that were left out.
bool all_reached(std::vector<LeftOutBlocks> const& blocks, int draws);

/// One series for each experiment and channel: what each sample contributes. NaN where a sample has no such score.
struct PointwiseScores {
  std::string experiment, channel;
  std::vector<int> rows;  // of the file, counted from 1
  std::vector<double> log_density, p_waic, elpd_loo, pareto_k, elpd_block, elpd_future;
};

struct Criteria {
  std::optional<ScoreAtMode> at_mode;
  std::optional<Deviance> deviance;
  std::string reason;  // why there are no scores of draws; empty: there are
  int draws = 0;       // that the scores below are of
  std::optional<LogScore> waic, loo, block, future;
  double p_waic = 0, p_loo = 0;  // effective numbers of parameters
  int unstable_waic = 0;         // samples whose log density varies by more than 0.4
  int doubtful = 0;              // samples with a k above largest_k(draws)
  ParetoCounts pareto_counts = {};
  double worst_k = 0;
  bool in_time = false;  // rows follow one another, so that those beside a row that is left out say much about it
  std::vector<LeftOutBlocks> blocks, futures;  // of each experiment, of records in time
  std::vector<PointwiseScores> pointwise;      // in pointwise.csv, not in report.cbor
};

}  // namespace sysid

// Fits and predictions side by side, as plain data.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace sysid {

/// What a fit says of its model.
struct ComparedFit {
  std::string name;  // of the task; of its folder where two tasks have one name
  std::string model;
  int parameters = 0;                  // sampled or integrated out
  std::string noise;                   // "sigma 0.0881 N/m": what only the noise reads
  std::optional<double> log_evidence;  // nats
  std::optional<double> error;         // of it, one standard error; Laplace's approximation has none
  std::string not_confirmed;           // why the evidence may be off by more than its error
  std::optional<double> rough;         // by so much its axes, or weighted draws, would have it larger, where that is not little
  bool rough_by_draws = false;
  std::optional<double> probability;        // under equal odds of the models before the data
  std::optional<double> probability_error;  // the errors of the evidences carried through; nothing where one is not known
  std::optional<double> log_bayes_factor;   // against the model of the highest evidence
  std::optional<double> bayes_factor_error;
  std::string strength;  // of the evidence against it, in words; empty for that model
  std::string without;   // why it has no evidence
  bool pass = true;      // its checks
  int warnings = 0;      // among their findings
  std::string counted;   // another fit of the same model, whose evidence stands for both; empty: its own does
};

/// The errors of a prediction on one channel of a record.
struct ComparedPrediction {
  std::string name, model;
  std::string kind;  // "one step", "free run"; empty: a model without a past
  std::string on;    // "force on flume.test"
  std::string rows;  // "601..1400"
  double nmse = 0;   // [%]
  std::optional<double> coverage;
  bool pass = true;
  int warnings = 0;
  std::string samples;  // digest of what is predicted
};

/// What a fit predicts of samples that its draws are made not to have seen.
struct ComparedScore {
  std::string name, model;
  double elpd = 0, error = 0;                   // nats, and one standard error
  double difference = 0, difference_error = 0;  // from the best
  double stacking = 0, pseudo_bma = 0;          // weights
  int doubtful = 0;                             // samples with a Pareto k that is too large for the draws, by leave-one-out
  int impossible = 0;                           // samples that it gives no density: elpd is -infinity, weights are 0
  bool one_step = false;                        // each sample from measured ones before it
  std::string counted = {};                     // another fit of the same model, whose scores are weighed; empty: its own are
};

/// Of fits that have draws, by the same samples.
struct ComparedScores {
  bool future = false;  // by leave-future-out; else by leave-one-out
  bool in_time = false;
  int samples = 0;
  std::vector<ComparedScore> fits;    // none, or two at least
  std::vector<std::string> left_out;  // fits whose scored samples are not those of the first
};

struct Comparison {
  std::string data;  // of the fits: "flume.train, rows 101..500 (400)"
  std::vector<ComparedFit> fits;
  ComparedScores scores;
  std::vector<ComparedPrediction> predictions;  // of the same samples one after another
  std::vector<std::string> notes;               // lines below the tables
};

}  // namespace sysid

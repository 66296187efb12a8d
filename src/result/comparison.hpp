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
  std::optional<double> rough;         // by so much its axes, or weighted draws, would have it larger, where that is not little
  bool rough_by_draws = false;
  std::optional<double> probability;  // under equal odds of the models before the data
  std::string without;                // why it has no evidence
  bool pass = true;                   // its checks
  int warnings = 0;                   // among their findings
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

struct Comparison {
  std::string data;  // of the fits: "flume.train, rows 101..500 (400)"
  std::vector<ComparedFit> fits;
  std::vector<ComparedPrediction> predictions;  // of the same samples one after another
  std::vector<std::string> notes;               // lines below the tables
};

}  // namespace sysid

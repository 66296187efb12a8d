// What a task found, as plain data: tasks fill it, the writers of report/ turn it into files and text.
// Nothing in it depends on the host or the hour but `timing`.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/setting/settings.hpp"
#include "core/system/ledger.hpp"
#include "result/average.hpp"
#include "result/calibration.hpp"
#include "result/criteria.hpp"
#include "result/discovery.hpp"
#include "result/draws.hpp"
#include "result/evidence.hpp"
#include "result/facts.hpp"
#include "result/finding.hpp"
#include "result/fixed_value.hpp"
#include "result/function.hpp"
#include "result/mode.hpp"
#include "result/prediction.hpp"
#include "result/prior_width.hpp"
#include "result/restoring_force.hpp"
#include "result/score.hpp"
#include "result/selection.hpp"
#include "result/summary.hpp"

namespace sysid {

/// A prior whose arguments are numbers, as its density can be computed again from: SI values.
struct PriorNumbers {
  std::string distribution;            // "log_uniform"
  std::vector<double> arguments;       // canonical, in the order of the distribution's row
  std::optional<double> lower, upper;  // the user's truncation
  double scale = 1;                    // SI value of one declared unit
};

struct PriorInfo {
  std::string name, unit;
  std::string text;                                 // "log_uniform(0.1, 10)"
  std::function<double(double)> density;            // of the declared value; empty when it depends on other parameters
  std::optional<PriorNumbers> numbers = {};         // the same, stored; empty when it depends on other parameters
  std::optional<double> q5 = {}, q95 = {};          // declared unit; empty where they are not known
  std::optional<double> lowest = {}, highest = {};  // one part in 2000 of it lies below, and above
};

/// A value that a record was made with, as its head states it; in the declared unit of the parameter.
struct TrueValue {
  std::string name, unit;
  double value = 0;
};

struct DataInfo {
  std::string name;  // "bench.train"
  std::string file, sha256;
  std::int64_t rows = 0;           // of the file
  std::int64_t scored = 0;         // of the split
  std::string scored_rows;         // which: "101..500", counted from 1
  std::string samples_sha256;      // of the measured samples that the likelihood reads, with their rows and in their declared units
  std::string inputs_sha256;       // of what the model is given beside them: columns, units and rules of its inputs, constants
  std::vector<std::string> notes;  // "input x = force [N], held (zero_order)"
  std::vector<TrueValue> true_parameters = {};
};

/// The scores of a channel on an experiment.
struct FitLine {
  std::string experiment, channel;  // "bench.train", "displacement"; empty: over all channels of all experiments
  std::string unit;                 // of its rmse
  std::vector<Score> scores;
  std::string optimum_of = {};  // the model whose maximum-likelihood fit they are of; empty: of what the task found

  std::string what() const {
    std::string const where = channel.empty() ? "all channels" : channel + " on " + experiment;
    return optimum_of.empty() ? where : where + ", maximum-likelihood fit of `" + optimum_of + "`";
  }
};

/// A table of what this kind of task adds: candidate models, inclusion probabilities, populations.
struct ReportTable {
  std::string title, caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// A check of a finished fit: it ran, or did not apply.
struct CheckRecord {
  std::string name;     // "input_timing"
  std::string skipped;  // why it does not apply; empty: it ran
};

struct Report {
  std::string version;          // of sysid
  std::string task;             // "posterior"
  std::string what;             // "fit duffing to bench.train with mh": for people; programs decide by the next four
  std::string verb;             // that the task is written with: "fit"
  std::string prediction_rule;  // as the language has it: "as_written", "one_step", "free_run", or "10 steps"; empty where time is
                                // not discrete
  bool measured_past = false;   // whether the model under that rule predicts from measured past samples
  int lags = 0;                 // how many samples it looks back; 0: it reads none of the past
  std::string model_name, model_title;
  std::vector<std::string> equations;  // statements of the model in the language, one each; of a discovery, what it found
  std::vector<std::string> formulas;   // the equations as MathML, one each; empty where one is shown as its text
  std::string model_text;              // the user's text
  std::string resolved_text;           // the file that reproduces this run, every setting spelt out
  /// The same to be run where it lies in the folder of the results: resolved.sysid, and the modules it uses. By name, with their
  /// text; not in report.cbor.
  std::vector<std::pair<std::string, std::string>> resolved_files = {};
  std::vector<PriorInfo> priors;
  std::vector<FixedValue> fixed;  // of a selection and of a discovery none
  std::vector<DataInfo> data;
  Draws draws;                   // may be empty (simulate, predict)
  std::vector<Summary> summary;  // of the draws, parameters first
  std::string verdict;           // its headline, in plain words; empty: as `verdict_of` words the findings
  Findings findings;
  std::vector<CheckRecord> checks;      // of a fit
  std::vector<FitLine> fit;             // what the task itself has scored
  std::vector<Prediction> predictions;  // of each experiment: over the fitted rows, or of the predicted ones
  std::vector<Prediction> states;       // of each experiment: random states and disturbances as the fitted record shows them
  std::vector<Mode> modes;              // by falling share
  /// What the search moved and the back end sampled: names of the values of modes, and of failures that have none. Parameters that
  /// are integrated out have draws and are not among them.
  std::vector<std::string> sampled_names = {};
  std::optional<Evidence> evidence;       // of a fit that has come to its end
  std::optional<Criteria> criteria;       // the same
  std::vector<PriorWidth> prior_widths;   // of a fit with draws and an evidence
  std::vector<std::string> noise;         // of a fit: its parameters that only the noise reads
  std::vector<FunctionReport> functions;  // unknown ones of the equations
  std::vector<RestoringForce> forces;     // of each experiment and oscillator that has one
  std::vector<ReportTable> tables;
  std::optional<SelectionReport> selection;
  std::optional<DiscoveryReport> discovery;
  std::optional<CalibrationReport> calibration;
  std::optional<AverageReport> average;  // for summary.json alone: the page has its tables
  Ledger ledger;
  std::uint64_t seed = 0;
  int place = 0;                      // of the task in its file
  std::string command;                // that makes this result again, ready for a shell
  std::vector<std::string> unseeded;  // tasks whose seeds the command does not carry: they were drawn
  Facts settings, versions;
  Facts timing;  // seconds, threads, host: for timing.json alone
};

}  // namespace sysid

// What a discovery of equations found.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "result/prediction.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// What became of a term.
struct TermFate {
  enum class Kind {
    known,     // in the target, and so in the equation
    kept,      // chosen
    dropped,   // not chosen
    left_out,  // never offered to the choice
  };
  Kind kind = Kind::dropped;
  int round = 0;  // in which it was dropped; 0: the selector has no rounds

  bool operator==(TermFate const&) const = default;
};

/// "known", "kept", "dropped", "dropped in round 2", "left out": as results have it.
std::string word(TermFate fate);
/// What is stored under such a word; nothing for any other.
std::optional<TermFate> term_fate(std::string_view word);

/// A term of the dictionary in one equation. Coefficients are in `unit`.
struct DiscoveredTerm {
  std::string text, unit;
  std::string name;  // of its coefficient in the source of what was found
  TermFate fate;
  bool kept = false;
  double coefficient = 0, sd = 0;  // on the chosen support
  double measure = 0;              // DiscoveryReport::measure
  double measure_error = 0;        // one standard error, where it is sampled; else 0
  double mean = 0, mean_sd = 0;    // as the selector has it, averaged over supports
  double contribution = 0;         // root mean square of coefficient * term over that of what is explained
  double inflation = 0;            // of the variance by the other terms; 0: not kept
};

/// Terms that could stand together, the best first.
struct DiscoveredSupport {
  std::vector<std::string> terms;
  double probability = 0;        // 0 where the selector knows none
  double probability_error = 0;  // one standard error, where it is sampled; else 0
  double log_evidence = 0;
};

struct DiscoveredEquation {
  std::string target;    // "m*y'' - x"
  std::string equation;  // "m*y'' - x = -20 y' - 1e4 y"; empty: none was found
  std::vector<DiscoveredTerm> terms;
  std::vector<DiscoveredSupport> supports;
  double explained = 0;                // share of the projections, not of the motion
  double noise_ratio = 0;              // residual over measurement noise; 0: not known
  double own_noise = 0;                // sd, at a sample, of what the equation is off by itself; 0: none was found
  std::string unit;                    // of the target, in which own_noise is
  std::vector<double> moving_average;  // of that error in discrete time; empty: white
  int rows = 0;
  bool exact = true, converged = true;
};

/// How well the difference equation of a target predicts rows that its choice did not use, in `unit`.
struct DifferenceForecast {
  std::string target, unit;
  double sd = 0;                             // of what is measured
  std::optional<double> one_step, free_run;  // root mean square errors; a run that does not stay finite: infinite
  std::optional<double> expected;            // of the free run, if the equation is right
};

struct DiscoveryReport {
  std::string selector, derivatives;
  std::string measure;   // "inclusion probability"
  bool windows = false;  // rows are windows, of this half-width
  int half_width = 0;
  struct Noise {
    std::string channel, unit;
    double sd = 0;       // in `unit`
    bool given = false;  // else estimated from the record
  };
  std::vector<Noise> noise;
  struct Inner {
    std::string name, unit, prior;  // "log_uniform(0.05, 20)"
    double value = 0;               // of the regression, in `unit`
    std::optional<double> sd = {};  // the same; that of the coefficients contains it then
  };
  std::vector<Inner> inner;  // parameters inside terms
  std::vector<DiscoveredEquation> equations;
  struct Excluded {
    std::string term, reason;
  };
  std::vector<Excluded> excluded;              // of the dictionary, before the record was looked at
  std::optional<ValidationReport> validation;  // by simulation; absent: it was left out, or there is nothing to simulate
  std::string forecast_rows;                   // "bench.test"; empty: no row was held out, or the equations are differential ones
  std::vector<DifferenceForecast> forecasts;
  std::vector<Prediction> free_runs;  // of the equations found along rows that are held out, scored behind those that set the start
  std::string answer;  // on form, coefficients and other rows: "the form is decided ..."; empty: nothing was validated
  std::string source;  // of the model that was found; empty: none
};

}  // namespace sysid

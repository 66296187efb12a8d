// Equations from records: projection, whitening, checks of the columns, choice of terms; the one entry for tasks.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/setting/settings.hpp"
#include "data/experiment.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "regression/column/concern.hpp"
#include "regression/column/dictionary.hpp"

namespace sysid::regression {

struct Method {
  Form const* form = nullptr;
  Settings form_settings;
  SelectorRow const* selector = nullptr;
  Settings selector_settings;
  std::uint64_t seed = 1;
  std::function<bool()> interrupted = {};
};

/// A term of the dictionary after the choice, coefficients in coherent SI.
struct FoundTerm {
  std::string name;
  bool kept = false;
  bool excluded = false;           // not offered to the selector: a concern says why
  double measure = 0;              // SelectorRow::measure
  double measure_error = 0;        // one standard error, where it is sampled
  double precision = 0;            // ard
  int dropped_in = 0;              // threshold
  double coefficient = 0, sd = 0;  // on the chosen support; 0 when not kept
  double mean = 0, mean_sd = 0;    // as the method has it (averaged over supports)
  double contribution = 0;         // root mean square of coefficient * term over that of the known side, as projected
  double inflation = 0;            // variance inflation factor among the kept terms; 0 when not kept
};

struct FoundEquation {
  std::string name;
  bool found = false;             // false: a fatal concern, nothing else is set
  std::vector<FoundTerm> terms;   // as in the dictionary
  Support chosen;                 // terms are indices of the dictionary's; coherent SI
  std::vector<Support> supports;  // the candidates, best first
  Eigen::MatrixXd joint;          // as Choice::joint over the dictionary's terms
  double explained = 0;    // 1 - |residual|^2 / |known|^2 on the chosen support, as projected; of projections, not of the motion
  double noise_ratio = 0;  // whitened residual sd; 1: as the measurement noise has it; 0: the form cannot say
  double own_noise = 0;    // sd, at a sample, of what the known side is off by itself (Projection::own_noise); its unit
  std::vector<double> moving_average;  // of that noise, its coefficients; empty: white, or the form has none
  int rows = 0;                        // windows or samples used
  int iterations = 0;
  bool converged = true, exact = true;
  Concerns concerns;
};

struct Discovery {
  std::vector<FoundEquation> equations;
  std::vector<double> noise_sd;  // per channel, as taken
  int half_width = 0;            // of windows, samples
  bool interrupted = false;
};

/// The same bytes for the same arguments on the same machine.
Discovery discover(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method);

}  // namespace sysid::regression

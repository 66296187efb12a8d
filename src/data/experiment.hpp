// One recorded experiment as simulation sees it: times, inputs as piecewise polynomials, measured channels, which rows are scored.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace sysid {

enum class InputRule { zero_order, linear, cubic, band_limited };

/// An input between its samples: on interval i, [t_i, t_(i+1)], a polynomial in s = (t - t_i)/(t_(i+1) - t_i), coefficients c_0 ... c_degree.
/// Every rule has this form, so any solver may read it at any time.
class InputSignal {
 public:
  /// samples: [N], finite; time: [N], strictly increasing, N >= 2. band_limited needs equal steps (to 1e-6 relative): UserError otherwise.
  InputSignal(InputRule rule, std::vector<double> time, std::vector<double> samples);

  InputRule rule() const { return rule_; }
  /// The sample itself.
  double sample(int row) const { return samples_[static_cast<std::size_t>(row)]; }
  /// Value at s in [0, 1] of interval i in [0, N - 2]; at s = 1 the limit from the left.
  double value(int interval, double s) const;
  /// Time derivative there; under zero_order it does not exist (the checker refuses its use).
  double rate(int interval, double s) const;

 private:
  InputRule rule_;
  int degree_ = 0;
  std::vector<double> time_, samples_, coefficients_;
};

/// Numbers are coherent SI (temperatures in degrees above 0 of their declared unit), columns in the order of the model's inputs and channels.
struct Experiment {
  std::string name;                               // "bench", as declared
  std::vector<double> time;                       // [N] s, strictly increasing
  std::vector<InputSignal> inputs;                // one per model input
  std::vector<std::vector<double>> measured;      // one per model channel, each [N]; NaN: missing; empty: channel not in this data
  std::vector<std::uint8_t> scored;               // [N], 1: in the split; simulation runs over all rows from the first one needed
  int first_row = 1;                              // row of the file that is index 0 (rows count from 1)
};

}  // namespace sysid

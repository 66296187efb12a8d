// One recorded experiment as simulation sees it: times, inputs as piecewise polynomials, measured channels, which rows are scored.
#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/unit.hpp"
#include "data/cell/rounded_times.hpp"
#include "data/input_rule.hpp"

namespace sysid {

/// An input between its samples: on interval i, [t_i, t_(i+1)], a polynomial in s = (t - t_i)/(t_(i+1) - t_i), coefficients
/// c_0 ... c_degree. Every rule has this form, so any solver may read it at any time.
///
///   zero_order    the sample holds until the next one                                        degree 0
///   linear        straight lines through the samples                                         degree 1
///   cubic         the C2 interpolating spline with not-a-knot ends, O(h^4) up to the ends;   degree 3
///                 2 samples: the line, 3: the parabola
///   band_limited  the record taken as samples of a signal without content above Nyquist:     degree 7
///                 a sinc interpolator with a Kaiser window (40 samples to either side, beta 12: content up to 0.45 of the sampling
///                 rate to 1e-5), on each interval interpolated at 8 Chebyshev-Lobatto points, both samples among them. Beyond its
///                 ends the record continues by reflection in its end points, x(-t) = 2 x(0) - x(t): value and slope are
///                 continuous there, but within 40 samples of an end the result is a guess to that extent.
///
/// Copies share the record: a copy or a view is cheap.
class InputSignal {
 public:
  /// samples: [N], finite; time: [N], strictly increasing, N >= 2. band_limited needs equal steps (to 1e-6 relative): UserError
  /// otherwise.
  InputSignal(InputRule rule, std::vector<double> time, std::vector<double> samples);

  /// Straight lines on each interval, one on each of its `pieces` equal parts, from begin[i pieces + k] to end[i pieces + k],
  /// [N x pieces] each; what the samples are is the first begin. Its rule is zero_order, whose curves jump at samples as this one
  /// does. With several pieces there are no `coefficients`.
  static InputSignal lines(std::vector<double> time, std::vector<double> const& begin, std::vector<double> const& end,
                           int pieces = 1);

  InputRule rule() const { return record_->rule; }
  /// Degree of the polynomials.
  int degree() const { return record_->degree; }
  /// Number of samples seen.
  int rows() const { return rows_; }
  /// Number of rows of the record before the first one seen.
  int earlier() const { return first_; }
  /// The sample itself; row -1 is the one before the first, down to -earlier().
  double sample(int row) const { return record_->samples[static_cast<std::size_t>(first_ + row)]; }
  /// c_0 ... c_degree of interval i in [0, rows() - 2].
  std::span<double const> coefficients(int interval) const;
  /// Value at s in [0, 1] of interval i in [0, rows() - 2]; at s = 1 the limit from the left, and so where the curve jumps within
  /// the interval, if `from_left`.
  double value(int interval, double s, bool from_left = false) const;
  /// Time derivative there; under zero_order it does not exist (the checker refuses its use) and reads 0.
  double rate(int interval, double s) const;

  /// Rows [first, first + count), counted from 0, of the same curve: the rest of the record still shapes it near their ends.
  InputSignal view(int first, int count) const;
  /// The same samples under another rule; nothing where that needs equal steps and these are not.
  std::optional<InputSignal> under(InputRule rule) const;
  /// The signal `samples` rows later (negative: earlier), as samples under the same rule: what the input would be had its column
  /// been recorded that much out of step. New sample i is the old curve at row i - samples, a part of a row being that part of the
  /// interval there, however long it is. A zero_order curve is replaced by its average over the shifted step, read as the line
  /// between neighbours: half a sample gives the mean of two.
  /// Beyond its ends the record holds its end samples.
  InputSignal shifted(double samples) const;
  /// The same with the other sign.
  InputSignal reversed() const;

 private:
  struct Record {
    InputRule rule;
    int degree;
    int pieces = 1;                                   // polynomials in an interval, each over its own [0, 1]
    bool ends_at_samples = true;                      // an interval ends in the next sample
    std::vector<double> time, samples, coefficients;  // [N], [N], [N - 1 x pieces x degree + 1]
  };
  std::span<double const> piece(int interval, int piece) const;

  std::shared_ptr<Record const> record_;
  int first_ = 0;
  int rows_ = 0;
};

/// Numbers are coherent SI (temperatures in degrees above 0 of their declared unit), columns in the order of the model's inputs and
/// channels.
struct Experiment {
  std::string name;                           // "bench", as declared
  std::vector<double> time;                   // [N] s, strictly increasing (of models without dynamics: any order)
  std::optional<Unit> time_unit;              // in which people read them; absent: seconds
  std::vector<InputSignal> inputs;            // one per model input
  std::vector<std::vector<double>> measured;  // one per model channel, each [N]; NaN: missing; empty: channel not in this data
  std::vector<std::uint8_t> scored;           // [N], 1: in the split; simulation runs over all rows from the first one needed
  /// [N], 1: rows from which predictions learn of states that are random given the parameters; empty: from those that are scored.
  std::vector<std::uint8_t> corrects;
  int first_row = 1;  // row of the file that is index 0 (rows count from 1)
  /// What discrete-time models read before index 0, each channel latest first; inputs are views that begin later in their record.
  std::vector<std::vector<double>> history;
  /// Per channel [N]: 0 where a past measured sample that its density reads is missing, so that it cannot be scored. Empty:
  /// nowhere.
  std::vector<std::vector<std::uint8_t>> has_lags;

  /// The same of which predictions of random states learn nothing.
  Experiment unread() const {
    Experiment result = *this;
    result.corrects.assign(time.size(), 0);
    return result;
  }
  /// Whether a likelihood reads the sample of a channel at an index: in the split, measured, and so is what its density looks back
  /// to.
  bool is_scored(std::size_t channel, std::size_t index) const {
    if (measured[channel].empty() || scored[index] == 0 || std::isnan(measured[channel][index])) return false;
    return has_lags.empty() || has_lags[channel].empty() || has_lags[channel][index] != 0;
  }
};

/// Rows [begin, end), with the samples of `lags` rows before them as their history; 0: with that of the whole, if they begin there.
/// The whole record shapes its inputs as before.
Experiment slice(Experiment const& experiment, int begin, int end, int lags = 0);

/// The sample of a channel at `row`, which may lie before the first; NaN where it is missing or was not recorded.
double measured_sample(Experiment const& experiment, int channel, int row);

}  // namespace sysid

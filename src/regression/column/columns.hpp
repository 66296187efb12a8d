// From sampled records to the columns of a linear regression: one row of a table per way to treat derivatives.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/setting/settings.hpp"
#include "data/experiment.hpp"
#include "regression/column/concern.hpp"
#include "regression/column/dictionary.hpp"

namespace sysid::regression {

/// known [K] against terms [K x J]; row k is a window or a sample.
struct Columns {
  Eigen::VectorXd known;
  Eigen::MatrixXd terms;
};

/// How large the residual of a right equation is.
enum class ResidualSize {
  one,         // of `whitened`: its sd is 1
  propagated,  // as noise of the channels passes through the form: by drawing it
  unknown,     // the noise is that of the equation, and estimated with it: noise_of_equation
};

/// The errors of an equation in discrete time, whose noise is a moving average of them.
struct EquationErrors {
  Eigen::VectorXd errors;       // row by row
  double squares = 0;           // their sum of squares, with those before the first rows
  double log_determinant = 0;   // of their covariance: twice the log likelihood is -n log(squares/n) - this
  int runs = 0;                 // of rows that follow one another
  std::vector<double> average;  // coefficients of the moving average
  std::vector<double> average_sd;
};

/// An input that an equation's errors are correlated with.
struct InputTrace {
  int input = 0, lag = 0;
  bool square = false;     // it is its square
  double correlation = 0;  // of n samples, more than the limit over sqrt(n)
};

/// What forms have whose noise is that of the equation.
class NoiseOfEquation {
 public:
  virtual ~NoiseOfEquation() = default;
  /// Orders of the moving average to choose from, rising.
  virtual std::vector<int> orders() const = 0;
  /// Rows whose errors are independent and of one sd, as far as the moving average of this order at these coefficients [J] goes,
  /// with what its own coefficients and unknown errors before the first rows do to them taken out: fewer rows than the columns
  /// have.
  virtual Columns whitened(int equation, Eigen::VectorXd const& coefficients, int order) const = 0;
  virtual EquationErrors errors(int equation, Eigen::VectorXd const& coefficients, int order) const = 0;
  /// The largest correlation of the errors with samples of inputs up to 25 rows before, and with their squares; nothing where none
  /// is larger than 5.5/sqrt(n), which chance exceeds once in 10^5 records.
  virtual std::optional<InputTrace> input_in(int equation, Eigen::VectorXd const& errors) const = 0;
};

/// The columns of every equation on all experiments, stacked.
class Projection {
 public:
  virtual ~Projection() = default;
  /// As projected, in units of known side and terms; rows that the equation cannot use are left out.
  virtual Columns const& columns(int equation) const = 0;
  /// Rows multiplied so that their errors, at these coefficients [J], are independent and of sd 1 if the noise of the channels is
  /// what it is taken to be and the equation itself is off by white noise of sd `own` at a sample (in units of the known side);
  /// where a form knows no covariance, the columns themselves.
  virtual Columns whitened(int equation, Eigen::VectorXd const& coefficients, double own) const = 0;
  /// By how much the equation itself is off beside the noise of the channels, as `own` above, by what is left at these
  /// coefficients; 0 where the data do not ask for it or the form cannot say.
  virtual double own_noise(int equation, Eigen::VectorXd const& coefficients) const = 0;
  /// How often whitening depends on coefficients and is worth repeating; 0: never.
  virtual int reweightings() const = 0;
  virtual ResidualSize residual_size() const = 0;
  /// Of ResidualSize::unknown; else null.
  virtual NoiseOfEquation const* noise_of_equation() const { return nullptr; }
  /// Noise sd taken per channel, as given or estimated; empty: the form takes none.
  virtual std::vector<double> const& noise_sd() const = 0;
  /// Half-width of windows in samples; 0 for forms on samples.
  virtual int half_width() const = 0;
  /// Of the equation; term indices are those of Equation::terms.
  virtual Concerns const& concerns(int equation) const = 0;
};

struct Form {
  std::string_view name;
  std::string_view summary;
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together, or not with a dictionary that needs so many derivatives of a sample
  /// (`derivatives_needed`); empty when they do.
  std::string (*refuse)(Settings const&, int derivatives);
  /// Experiments have at least two rows each; their inputs and channels are those of the dictionary. A fatal concern of any
  /// equation means that its columns are empty.
  std::unique_ptr<Projection> (*project)(Dictionary const&, std::span<Experiment const>, Settings const&);
};

/// The ways to have derivatives, in the order in which they are listed; `weak` first, the default.
std::span<Form const> forms();
/// The way of dictionaries in discrete time, which have no derivatives.
Form const& form_of_samples();
/// One of them by its name; null: none.
Form const* find_form(std::string_view name);

}  // namespace sysid::regression

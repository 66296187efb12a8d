// What an inference back end sees of a model: a prior and a likelihood over R^P, for a batch of parameter vectors. Nothing of the
// language passes.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "core/system/lazily.hpp"
#include "core/system/ledger.hpp"
#include "result/parameter_info.hpp"

namespace sysid {

/// How derivatives of a density come about.
enum class DerivativeSource {
  exact,        // of the numbers that are computed, to rounding: by tangents of the program
  mixed,        // exact where a value costs most, by differences of the rest; or exact in the gradient alone
  differences,  // central, in lanes of the same batch
};

class Target {
 public:
  virtual ~Target() = default;
  /// P, the number of unconstrained coordinates, one per sampled parameter.
  virtual int dimension() const = 0;
  /// The sampled parameters, in the order of the rows of theta.
  virtual std::span<ParameterInfo const> parameters() const = 0;
  /// Draws theta [P x W], unconstrained, from the declared prior; lane w uses stream key.with_index(key.index + w) alone.
  virtual void sample_prior(StreamKey key, Lanes theta) const = 0;
  /// log density of theta [P x W] under the prior, all constants kept. With `jacobian` it is the density on R^P (what samplers
  /// need); without, the density of the declared parameters (what `map` maximises). out: [W].
  virtual void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const = 0;
  /// log likelihood of theta [P x W]. out: [W], -infinity where a solve failed, never NaN, never an exception; the class and place
  /// of each failure is added to `ledger`. Lane w depends on column w alone, whatever the width, threads or instruction set.
  virtual void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const = 0;
  /// log density of theta [P x W] of what `sample_prior` draws: the prior, with its Jacobian, where it is proper. out: [W].
  virtual void log_reference(ConstLanes theta, std::span<double> out) const { log_prior(theta, out); }
  /// Says that about so many values of the log likelihood will be wanted: what makes many of them cheaper may be done early.
  virtual void expect_values(double) const {}
  /// Number R of residual rows.
  virtual int residual_count() const = 0;
  /// Deviance residuals r [R x W] with  -log likelihood = 1/2 sum r^2 + constant  for the log likelihood of theta [P x W]: per
  /// scored sample sign(y - centre) sqrt(2 (s - log p(y))), s the largest log density any location gives y, and per channel one row
  /// sqrt(2 (C - sum s)) that carries the scale. A failed lane is +infinity in every row.
  virtual void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const = 0;
  /// Whether one value costs so much that a search begins at few places and climbs by the gradient (Gaussian processes), instead of
  /// by Levenberg-Marquardt from many.
  virtual bool is_expensive() const { return false; }
  /// As `is_expensive`, for searches alone: also where residuals cost far more than the density (filters whose covariance settles).
  virtual bool climbs_by_gradient() const { return is_expensive(); }
  /// Whether the log likelihood is that of an estimate, which varies from place to place for no reason but its random numbers.
  virtual bool is_estimated() const { return false; }
  /// Where `log_likelihood_gradient` and `gauss_newton` take derivatives from. Differences cost 2 P + 1 values and are known to
  /// about half the digits.
  virtual DerivativeSource derivatives() const { return DerivativeSource::differences; }
  /// log likelihood [W] of theta [P x W] as above, and its gradient [P x W]. Where a solve failed the value is -infinity and the
  /// gradient 0; derivatives that are not finite are 0. Lane w depends on column w alone.
  virtual void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const;
  /// log prior [W] of theta [P x W] as above, and its gradient [P x W]; 0 where the density is.
  virtual void log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, bool jacobian = true) const;
  /// Residuals [R x W] as above, and their derivatives by differences: row r P + p of jacobian [R P x W] is d r_r / d theta_p; 0 in
  /// failed lanes.
  virtual void residuals_with_jacobian(ConstLanes theta, Lanes out, Lanes jacobian, Ledger& ledger) const;
  /// What a Gauss-Newton step needs at each theta [P x W]: gradient -J'r [P x W] of the log likelihood, and curvature J'J [P P x
  /// W], element (p, q) in row p P + q. r and J as above, but differences are over `steps` [P], where there are any. Both are 0
  /// where a solve failed or a derivative is not finite. Lane w depends on column w alone.
  virtual void gauss_newton(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature, Ledger& ledger) const;
  /// What residuals and their derivatives cost together, in residuals: 2 P + 1 by differences.
  virtual double derivative_cost() const { return 2.0 * dimension() + 1; }
  /// How rough the log likelihood is as a function of theta: what a simulation leaves to chance, as a part of its size. 0 where it
  /// is smooth but for rounding; the tolerance where steps are chosen by the error.
  virtual double roughness() const { return 0; }
  /// Declared values [P x W] (declared units) of theta [P x W], and back.
  virtual void constrain(ConstLanes theta, Lanes declared) const = 0;
  virtual void unconstrain(ConstLanes declared, Lanes theta) const = 0;

 protected:
  /// [P] what values are moved by for a difference: `difference_width` of the widths of the prior.
  std::vector<double> difference_steps() const;

 private:
  /// [P] half the central 68 % of prior draws, > 0; 1 where they have no width. Differences are taken over parts of it.
  std::vector<double> const& prior_widths() const;
  Lazily<std::vector<double>> prior_widths_;
};

/// theta [P x 1] of declared values, of which those beyond the first P are not read.
LaneArray coordinates_of(Target const& target, std::span<double const> declared);

/// Of a prior width: values bend over widths, rounding sits at 1e-11 of them. Steps that are chosen by their error leave a
/// roughness of the size of the tolerance, so wider for loose ones, up to where long records bend.
double difference_width(Target const& target);

/// Per lane of theta [P x W] its own column, then a step ahead and one behind along each of the coordinates; steps: [P].
LaneArray moved_lanes(ConstLanes theta, std::span<int const> coordinates, std::span<double const> steps);
/// Along all of them.
LaneArray moved_lanes(ConstLanes theta, std::span<double const> steps);

/// The residual sqrt(2 (C - l)) that carries a log density l of so many samples. C keeps the radicand positive for any sensible
/// noise level; its value does not matter, only that it is fixed.
double scale_residual(int samples, double log_density);

/// The slope from the values of one function ahead, at and behind a place: of those that are finite, 0 where there are too few.
double central_slope(double ahead, double at, double behind, double step);

}  // namespace sysid

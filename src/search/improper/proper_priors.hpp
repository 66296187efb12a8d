// A target without its improper priors: what the data and the proper priors say of a place.
#pragma once
#include <span>
#include <vector>

#include "likelihood/improper_reference.hpp"
#include "likelihood/target.hpp"

namespace sysid::unbounded {

/// Its log prior is that of the proper parameters alone, on R^P. An improper density has no maximum that a search could look for:
/// 1/x has a pole at zero, which a coefficient that may be zero runs into. Not for hierarchies, whose proper priors read the
/// improper parameters.
class ProperPriors : public Target {
 public:
  ProperPriors(Target const& target, std::vector<ImproperReference> const& references)
      : target_(target), references_(references) {}

  int dimension() const override { return target_.dimension(); }
  std::span<ParameterInfo const> parameters() const override { return target_.parameters(); }
  void sample_prior(StreamKey key, Lanes theta) const override { target_.sample_prior(key, theta); }
  /// The density of the references at their centres is known, and is taken off.
  void log_prior(ConstLanes theta, std::span<double> out, bool) const override {
    LaneArray at_centres(theta.rows(), theta.width());
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) at_centres(p, w) = theta(p, w);
    double known = 0;
    for (ImproperReference const& each : references_) {
      for (int w = 0; w < theta.width(); ++w) at_centres(each.coordinate, w) = each.centre;
      known += each.log_density(each.centre);
    }
    target_.log_reference(at_centres, out);
    for (double& each : out) each -= known;
  }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
    target_.log_likelihood(theta, out, ledger);
  }
  void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const override {
    target_.log_likelihood_gradient(theta, out, gradient, ledger);
  }
  void expect_values(double count) const override { target_.expect_values(count); }
  int residual_count() const override { return target_.residual_count(); }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override { target_.residuals(theta, out, ledger); }
  void residuals_with_jacobian(ConstLanes theta, Lanes out, Lanes jacobian, Ledger& ledger) const override {
    target_.residuals_with_jacobian(theta, out, jacobian, ledger);
  }
  void gauss_newton(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature,
                    Ledger& ledger) const override {
    target_.gauss_newton(theta, steps, gradient, curvature, ledger);
  }
  bool is_expensive() const override { return target_.is_expensive(); }
  bool climbs_by_gradient() const override { return target_.climbs_by_gradient(); }
  DerivativeSource derivatives() const override { return target_.derivatives(); }
  double derivative_cost() const override { return target_.derivative_cost(); }
  double roughness() const override { return target_.roughness(); }
  void constrain(ConstLanes theta, Lanes declared) const override { target_.constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { target_.unconstrain(declared, theta); }

 private:
  Target const& target_;
  std::vector<ImproperReference> references_;
};

}  // namespace sysid::unbounded

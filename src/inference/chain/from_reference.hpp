// A target whose prior is the reference that stands for improper priors: power posteriors need a proper one to begin with.
#pragma once
#include <vector>

#include "likelihood/target.hpp"

namespace sysid::tempering {

/// log_prior is the density of what is drawn, log_likelihood the rest of the same posterior:
///
///   log q(theta),   log L(theta) + log p(theta) - log q(theta)
///
/// Where all priors are proper, q is p, and nothing is changed.
class FromReference : public Target {
 public:
  explicit FromReference(Target const& target) : target_(target), changed_(!improper_coordinates(target.parameters()).empty()) {}

  bool changed() const { return changed_; }
  int dimension() const override { return target_.dimension(); }
  std::span<ParameterInfo const> parameters() const override { return target_.parameters(); }
  void sample_prior(StreamKey key, Lanes theta) const override { target_.sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const override {
    if (changed_ && jacobian)
      target_.log_reference(theta, out);
    else
      target_.log_prior(theta, out, jacobian);
  }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
    target_.log_likelihood(theta, out, ledger);
    if (!changed_) return;
    std::vector<double> const rest = surplus(theta);
    for (std::size_t w = 0; w < out.size(); ++w) out[w] += rest[w];
  }
  /// log p - log q of theta [P x W]: [W].
  std::vector<double> surplus(ConstLanes theta) const {
    std::vector<double> prior(static_cast<std::size_t>(theta.width())), reference(prior.size());
    target_.log_prior(theta, prior);
    target_.log_reference(theta, reference);
    for (std::size_t w = 0; w < prior.size(); ++w) prior[w] -= reference[w];
    return prior;
  }
  void expect_values(double count) const override { target_.expect_values(count); }
  int residual_count() const override { return target_.residual_count(); }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override { target_.residuals(theta, out, ledger); }
  bool is_expensive() const override { return target_.is_expensive(); }
  bool climbs_by_gradient() const override { return target_.climbs_by_gradient(); }
  double roughness() const override { return target_.roughness(); }
  void constrain(ConstLanes theta, Lanes declared) const override { target_.constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { target_.unconstrain(declared, theta); }

 private:
  Target const& target_;
  bool changed_;
};

}  // namespace sysid::tempering

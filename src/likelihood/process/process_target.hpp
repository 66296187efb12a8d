// The Target of a model with Gaussian processes: their values and linear coefficients are integrated out.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "gaussian_process/observations.hpp"
#include "likelihood/model_target.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/process/process_rows.hpp"
#include "likelihood/target.hpp"

namespace sysid {

/// With y the fitted samples of a channel in all experiments, one after another, F the parametric part and K the covariance of its
/// processes at their inputs,
///
///   log p(y | theta) = log N(y | F, K + H S^2 H^T + sd^2 I)                      Rasmussen & Williams 2006, eq. 2.30 and 2.41
///
/// H the slopes of the coefficients that are integrated out, S the sds of their priors. Channels are independent given theta. One
/// function for all experiments: their samples are rows of one regression. N^3/3 flops a vector, or proportional to N where the
/// covariance has a state-space form and N is large.
class ProcessTarget : public Target {
 public:
  /// space: of model->reduced(), over the experiments in their order.
  ProcessTarget(std::shared_ptr<ProcessModel const> model, std::shared_ptr<ParameterSpace const> space,
                std::vector<Experiment> experiments, TargetOptions options);
  ~ProcessTarget() override;

  int dimension() const override { return space_->dimension(); }
  std::span<ParameterInfo const> parameters() const override { return space_->infos(); }
  void sample_prior(StreamKey key, Lanes theta) const override { space_->sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const override {
    space_->log_prior(theta, out, jacobian);
  }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override;
  /// By the chain rule: what the covariance reads by its analytic gradient, what the parametric part reads by differences of
  /// that part alone; only parameters that inputs of a process read need the likelihood itself at two more points each.
  bool is_expensive() const override { return true; }
  DerivativeSource derivatives() const override { return DerivativeSource::mixed; }
  void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const override;
  /// One row, sqrt(2 (C - log likelihood)): what is fitted here is no sum of squares.
  int residual_count() const override;
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override;
  double roughness() const override;
  void constrain(ConstLanes theta, Lanes declared) const override { space_->constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { space_->unconstrain(declared, theta); }

  ProcessModel const& model() const { return *model_; }
  std::shared_ptr<ParameterSpace const> const& space() const { return space_; }

  /// What a channel's regression is given at parameters of the model, one column per experiment [parameters x experiments], SI;
  /// nothing where a simulation fails or a hyper-parameter is not positive. coefficients: as a prior; else the parameters hold
  /// their values and there are none.
  struct Regression {
    gaussian_process::Observations observations;
    std::vector<double> parameters;  // hyper-parameters, then the noise's sd
  };
  std::optional<Regression> regression(ConstLanes parameters, int channel, bool coefficients) const;
  /// Fitted samples of a channel, of all experiments.
  int count(int channel) const;
  /// Variance of the fitted samples of a channel, SI, mean removed.
  double measured_variance(int channel) const;

 private:
  struct Batch;
  Batch evaluate(ConstLanes theta) const;
  std::optional<Regression> regression(Batch const& batch, int channel, int lane, bool coefficients) const;
  gaussian_process::Marginal marginal(Regression const& regression, int channel, bool with_gradient) const;
  /// log likelihood of one vector theta [P x 1], and its gradient [P x 1].
  double gradient_at(ConstLanes theta, Lanes gradient, Ledger& ledger) const;
  void record(Batch const& batch, ConstLanes theta, std::span<double const> values, Ledger& ledger) const;
  bool stopped() const;
  /// As ExecutionOptions::throws says.
  void leave_if_stopped() const;

  std::shared_ptr<ProcessModel const> model_;
  std::shared_ptr<ParameterSpace const> space_;
  TargetOptions options_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<ProcessRecord> records_;
  std::vector<Eigen::VectorXd> measured_;  // by channel, of all experiments
};

}  // namespace sysid

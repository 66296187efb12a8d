// A model with Gaussian processes, taken apart: what is computed along a record, and the covariances of what is left.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gaussian_process/covariance.hpp"
#include "likelihood/compiled_model.hpp"

namespace sysid {

/// The covariance of a process, whose inputs are columns from `first_column` on; hyper-parameters in the order of its kernels.
gaussian_process::Covariance covariance_of(Process const& process, int first_column);

/// A parameter with a normal prior that one channel's centre is linear in and nothing else reads: it is integrated out,
/// unless nothing would be left to sample.
struct MarginalCoefficient {
  int parameter = 0;        // of the model
  double mean = 0, sd = 0;  // of its prior, SI
};

/// y = F + sum of processes + noise, F a function of the parameters and the record.
struct ProcessChannel {
  int channel = 0;
  gaussian_process::Covariance covariance;  // of all its processes; its columns are those of `arguments`, in their order
  std::vector<int> hyper_parameters;        // outputs of ProcessModel::parameters_of_covariance, in the covariance's order
  int noise_sd = 0;                         // one more
  std::vector<MarginalCoefficient> coefficients;
  // Rows among the records of the parametric model's trajectory program.
  int centre = 0;
  std::vector<int> arguments;  // of the processes
  std::vector<int> slopes;     // dF/d(coefficient)
};

/// Immutable.
class ProcessModel {
 public:
  /// model: with processes, under its prediction rule; every channel has one. method: of the solver.
  ProcessModel(Model model, bool free_start, std::string const& method);

  Model const& model() const { return model_; }
  /// The model as the likelihood has it: coefficients that are integrated out are fixed at the mean of their prior.
  Model const& reduced() const { return reduced_; }
  /// The parametric part: the model with every process at zero.
  std::shared_ptr<CompiledModel const> const& parametric() const { return parametric_; }
  std::vector<ProcessChannel> const& channels() const { return channels_; }
  /// Names of what is integrated out, in the order of the model.
  std::vector<std::string> marginalised() const;

  /// Hyper-parameters and noise of all channels [outputs x W], SI, from parameters of the model [parameters x W].
  LaneArray parameters_of_covariance(ConstLanes parameters) const;

 private:
  struct Writing;
  void find_coefficients(std::vector<std::vector<int>>& of_channel) const;
  void add_channel(int channel, std::vector<int> const& coefficients, Writing& writing);
  void compile_covariance_parameters(Writing& writing);
  void find_records(Writing const& writing);

  Model model_, reduced_;
  std::shared_ptr<CompiledModel const> parametric_;
  std::vector<ProcessChannel> channels_;
  Kernel covariance_parameters_;
};

}  // namespace sysid

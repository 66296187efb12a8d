// Draws of functions along a simulated run, round by round, and draws of the coefficients of finite sums.
#include "app/process/drawn_functions.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "gaussian_process/dense.hpp"
#include "model/process_inputs.hpp"

namespace sysid {
namespace {

[[noreturn]] void fail(Process const& process, std::string const& message) {
  throw UserError({Severity::error,
                   "E5001",
                   "the Gaussian process `" + process.name + "` " + message,
                   Label{process.span, {}},
                   {},
                   "check the values of its hyper-parameters"});
}

}  // namespace

DrawnFunctions::DrawnFunctions(Model const& model, std::string const& method, ConstLanes parameters, StreamKey key)
    : model_(model, false, method), covariance_(model_.parameters_of_covariance(parameters)), key_(key) {
  Model with_inputs = model;
  processes_as_inputs(with_inputs);
  compiled_ = compile(std::move(with_inputs), false, method);
  arguments_.resize(compiled_->model.derived.size());
  std::size_t quantity = 0;
  using Kind = CompiledModel::Record::Kind;
  for (CompiledModel::Record const& record : compiled_->records) {
    if (record.kind == Kind::derived) arguments_[static_cast<std::size_t>(record.index)] = quantity;
    if (record.kind == Kind::derived || record.kind == Kind::state || record.kind == Kind::centre) ++quantity;
  }
}

std::vector<std::vector<double>> DrawnFunctions::along(Trajectory::Result const& run) const {
  std::vector<Process> const& processes = model_.model().processes;
  std::size_t const samples = run.values.front().front().size();
  std::vector<std::vector<double>> values(processes.size(), std::vector<double>(samples, 0.0));
  for (std::size_t c = 0; c < model_.channels().size(); ++c) {
    ProcessChannel const& layout = model_.channels()[c];
    Eigen::MatrixXd inputs(static_cast<Eigen::Index>(samples), static_cast<Eigen::Index>(layout.arguments.size()));
    std::size_t argument = 0, first = processes.size();
    Eigen::Index column = 0;
    for (std::size_t p = 0; p < processes.size(); ++p)
      for (std::size_t a = 0; a < processes[p].arguments.size(); ++a, ++argument) {
        if (processes[p].channel != static_cast<int>(c)) continue;
        first = std::min(first, p);
        inputs.col(column++) =
            Eigen::Map<Eigen::VectorXd const>(run.values[arguments_[argument]].front().data(), static_cast<Eigen::Index>(samples));
      }
    std::vector<double> hyper_parameters;
    for (int const output : layout.hyper_parameters) hyper_parameters.push_back(covariance_(output, 0));
    for (double const value : hyper_parameters)
      if (!(value > 0) || !std::isfinite(value)) fail(processes[first], "has a hyper-parameter that is not positive");
    auto const factor = gaussian_process::prior_factor(layout.covariance, inputs, hyper_parameters);
    if (!factor.fine) fail(processes[first], "has a covariance that cannot be decomposed");
    Stream stream(key_.at(key_.index, c));
    Eigen::VectorXd normal(inputs.rows());
    for (double& one : normal) one = stream.normal();
    Eigen::Map<Eigen::VectorXd>(values[first].data(), inputs.rows()) = factor.lower.triangularView<Eigen::Lower>() * normal;
  }
  return values;
}

std::vector<std::string> draw_coefficients(Model const& model, StreamKey key, Lanes parameters) {
  std::vector<std::string> said;
  for (std::size_t e = 0; e < model.expansions.size(); ++e) {
    Expansion const& expansion = model.expansions[e];
    Stream stream(key.at(key.index, e));
    std::vector<std::string> values;
    for (int const coefficient : expansion.coefficients) {
      double const drawn = stream.normal();
      if (std::isnan(parameters(coefficient, 0))) parameters(coefficient, 0) = drawn;
      values.push_back(shortest(parameters(coefficient, 0)));
    }
    said.push_back(
        fmt::format("function {} drawn from its prior, coefficients of its terms: {}", expansion.name, fmt::join(values, ", ")));
  }
  return said;
}

}  // namespace sysid

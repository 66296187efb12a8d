// Functions on a grid of their inputs from the draws' coefficients; a finite sum's covariance against that of its process.
#include "app/process/unknown_functions.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/numeric/statistics.hpp"
#include "gaussian_process/covariance.hpp"
#include "likelihood/compiled_model.hpp"
#include "likelihood/process/process_model.hpp"
#include "program/kernel.hpp"
#include "result/visits.hpp"

namespace sysid {
namespace {

constexpr int most_shown_draws = 200, along_shown_cut = 101;
constexpr double much = 0.1;  // of the process's variance

/// An expansion as a program of the model's parameters and its inputs.
class UnknownFunction {
 public:
  UnknownFunction(Model const& model, Expansion const& expansion) : expansion_(expansion), graph_(model.graph) {
    for (std::size_t p = 0; p < model.parameters.size(); ++p)
      leaves_.push_back(graph_.leaf(LeafKind::parameter, static_cast<int>(p)));
    for (std::size_t d = 0; d < expansion.inputs.size(); ++d) leaves_.push_back(Expansion::argument(graph_, static_cast<int>(d)));
    kernel_ = compile_kernel(graph_, leaves_, {&expansion.value, 1});
  }

  /// At one place, SI, for every column of parameters.
  std::vector<double> values(ConstLanes parameters, std::vector<double> const& place) const {
    int const width = parameters.width(), count = parameters.rows();
    LaneArray in(static_cast<int>(leaves_.size()), width), out(1, width);
    for (int w = 0; w < width; ++w) {
      for (int p = 0; p < count; ++p) in(p, w) = parameters(p, w);
      for (std::size_t d = 0; d < place.size(); ++d) in(count + static_cast<int>(d), w) = place[d];
    }
    sysid::run(kernel_, in, out);
    std::vector<double> result;
    for (int w = 0; w < width; ++w) result.push_back(out(0, w));
    return result;
  }

  FunctionPoint point(FunctionParameters const& parameters, std::vector<double> const& place) const {
    std::vector<double> found = values(parameters.values, place);
    for (double& value : found) value = expansion_.from_si(value);
    FunctionPoint result;
    for (std::size_t d = 0; d < place.size(); ++d) result.inputs.push_back(expansion_.inputs[d].from_si(place[d]));
    if (Eigen::Index const dimension = parameters.covariance.rows(); dimension > 0) {
      Eigen::VectorXd slope(dimension);
      for (Eigen::Index p = 0; p < dimension; ++p)
        slope[p] = 0.5 * (found[static_cast<std::size_t>(1 + 2 * p)] - found[static_cast<std::size_t>(2 + 2 * p)]);
      double const variance = slope.dot(parameters.covariance * slope);
      result.set_normal(found.front(), variance < 0 ? 0 : std::sqrt(variance));
      return result;
    }
    Eigen::Map<Eigen::ArrayXd const> const all(found.data(), static_cast<Eigen::Index>(found.size()));
    result.mean = all.mean();
    result.sd = found.size() < 2 ? 0 : std::sqrt((all - result.mean).square().sum() / static_cast<double>(found.size() - 1));
    result.q5 = quantile(found, 0.05);
    result.q95 = quantile(found, 0.95);
    return result;
  }

 private:
  Expansion const& expansion_;
  Graph graph_;
  std::vector<NodeId> leaves_;
  Kernel kernel_;
};

double between(Expansion::Input const& input, int i, int count) { return input.low + (input.high - input.low) * i / (count - 1); }

std::vector<double> middle(Expansion const& expansion) {
  std::vector<double> place;
  for (Expansion::Input const& input : expansion.inputs) place.push_back(0.5 * (input.low + input.high));
  return place;
}

/// All places of a grid with `count` along each input, the last one's fastest.
std::vector<std::vector<double>> grid(Expansion const& expansion, int count) {
  std::vector<std::vector<double>> places{{}};
  for (Expansion::Input const& input : expansion.inputs) {
    std::vector<std::vector<double>> longer;
    for (std::vector<double> const& place : places)
      for (int i = 0; i < count; ++i) {
        longer.push_back(place);
        longer.back().push_back(between(input, i, count));
      }
    places = std::move(longer);
  }
  return places;
}

/// The largest difference between the covariance of a sum and that of its process, over the largest variance of the process.
double error(Model const& model, Expansion const& expansion, ConstLanes parameters) {
  std::size_t const inputs = expansion.inputs.size();
  std::vector<std::vector<double>> const places = grid(expansion, inputs == 1 ? 9 : inputs == 2 ? 5 : 3);
  // One column for each coefficient, which is 1 there and the others 0.
  auto const count = static_cast<int>(expansion.coefficients.size());
  LaneArray units(parameters.rows(), count);
  for (int p = 0; p < parameters.rows(); ++p) {
    double mean = 0;
    for (int w = 0; w < parameters.width(); ++w)
      mean += parameters(p, w) / parameters.width();  // of moves to both sides, the optimum
    for (int j = 0; j < count; ++j) units(p, j) = mean;
  }
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) units(expansion.coefficients[static_cast<std::size_t>(i)], j) = i == j ? 1 : 0;
  UnknownFunction const function(model, expansion);
  auto const rows = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd features(rows, count), points(rows, static_cast<Eigen::Index>(inputs));
  for (Eigen::Index i = 0; i < rows; ++i) {
    std::vector<double> const& place = places[static_cast<std::size_t>(i)];
    std::vector<double> const one = function.values(units, place);
    features.row(i) = Eigen::Map<Eigen::RowVectorXd const>(one.data(), count);
    points.row(i) = Eigen::Map<Eigen::RowVectorXd const>(place.data(), static_cast<Eigen::Index>(inputs));
  }
  Graph const& graph = model.graph;
  std::vector<double> hyper_parameters;
  for (KernelUse const& kernel : expansion.process.kernels)
    for (NodeId const node : kernel.hyper_parameters)
      hyper_parameters.push_back(graph.evaluate(node, [&](NodeId leaf) { return units(graph[leaf].index, 0); }));
  Eigen::MatrixXd const exact = covariance_of(expansion.process, 0).between(points, points, hyper_parameters);
  return (features * features.transpose() - exact).cwiseAbs().maxCoeff() / exact.diagonal().maxCoeff();
}

}  // namespace

FunctionParameters function_parameters(ParameterSpace const& space, FitResult const& result) {
  FunctionParameters parameters;
  auto const first_experiment = [&](LaneArray const& rows) {
    parameters.values = LaneArray(static_cast<int>(space.model().parameters.size()), rows.width());
    space.select(rows, 0, parameters.values);
  };
  if (result.draws.total() != 1 || result.modes.empty() || result.modes.front().covariance.empty()) {
    first_experiment(space.values_of_declared(spread(result.draws, most_shown_draws)));
    return parameters;
  }
  Mode const& mode = result.modes.front();
  int const dimension = static_cast<int>(mode.theta.size());
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::VectorXd move(dimension);
  parameters.covariance = Eigen::Map<ByRows const>(mode.covariance.data(), dimension, dimension);
  for (int p = 0; p < dimension; ++p) {
    double const width = std::sqrt(parameters.covariance(p, p));
    move[p] = width > 0 && std::isfinite(width) ? 1e-3 * width : 1e-6;
  }
  parameters.covariance = move.cwiseInverse().asDiagonal() * parameters.covariance * move.cwiseInverse().asDiagonal();
  LaneArray theta(dimension, 1 + 2 * dimension);
  for (int p = 0; p < dimension; ++p) {
    for (int w = 0; w < theta.width(); ++w) theta(p, w) = mode.theta[static_cast<std::size_t>(p)];
    theta(p, 1 + 2 * p) += move[p];
    theta(p, 2 + 2 * p) -= move[p];
  }
  first_experiment(space.values(theta));
  return parameters;
}

std::vector<FunctionReport> unknown_functions(Model const& model, FunctionParameters const& parameters) {
  std::vector<FunctionReport> reports;
  for (Expansion const& expansion : model.expansions) {
    UnknownFunction const function(model, expansion);
    FunctionReport report{expansion.name, expansion.unit_text(), {}, {}, {}, {}};
    std::size_t const inputs = expansion.inputs.size();
    report.visits.assign(inputs, no_visits());
    for (Expansion::Input const& input : expansion.inputs) report.inputs.emplace_back(input.name, input.unit_text());
    for (std::vector<double> const& place : grid(expansion, inputs == 1 ? along_shown_cut : inputs == 2 ? 21 : 7))
      report.grid.push_back(function.point(parameters, place));
    for (std::size_t d = 0; d < inputs; ++d) {
      report.cuts.emplace_back();
      for (int i = 0; i < along_shown_cut; ++i) {
        std::vector<double> place = middle(expansion);
        place[d] = between(expansion.inputs[d], i, along_shown_cut);
        report.cuts.back().push_back(function.point(parameters, place));
      }
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

Findings check_expansions(Model const& model, ConstLanes parameters) {
  Findings findings;
  for (Expansion const& expansion : model.expansions)
    if (double const part = error(model, expansion, parameters); !(part <= much))
      findings.push_back(
          {FindingCode::basis_inaccurate,
           Severity::warning,
           {expansion.name},
           fmt::format("the finite sum of `{}` differs from its process by {:.0f} % of the process's variance", expansion.name,
                       100 * part),
           "use more `terms` if the length-scale is short compared with the range, or a wider `within` if it is long"});
  return findings;
}

}  // namespace sysid

// Evaluates conditional processes along each input, for one draw of the hyper-parameters after the other.
#include "app/process/process_functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/process/process_draws.hpp"
#include "core/numeric/statistics.hpp"
#include "gaussian_process/regression.hpp"
#include "result/visits.hpp"

namespace sysid {

namespace {

constexpr int most_draws = 20, along_a_cut = 61;

std::vector<double> column_of(Eigen::MatrixXd const& inputs, Eigen::Index column) {
  return {inputs.col(column).begin(), inputs.col(column).end()};
}

/// All cuts, one after the other: along input d with the others at their medians.
Eigen::MatrixXd places_of_cuts(Eigen::MatrixXd const& inputs) {
  Eigen::Index const count = inputs.cols();
  Eigen::RowVectorXd middle(count);
  for (Eigen::Index d = 0; d < count; ++d) middle[d] = quantile(column_of(inputs, d), 0.5);
  Eigen::MatrixXd places = middle.replicate(count * along_a_cut, 1);
  for (Eigen::Index d = 0; d < count; ++d)
    places.block(d * along_a_cut, d, along_a_cut, 1) =
        Eigen::VectorXd::LinSpaced(along_a_cut, inputs.col(d).minCoeff(), inputs.col(d).maxCoeff());
  return places;
}

std::vector<double> visits_of(Eigen::MatrixXd const& inputs, Eigen::Index d) {
  std::vector<double> visits = no_visits();
  double const low = inputs.col(d).minCoeff(), high = inputs.col(d).maxCoeff();
  for (double const value : inputs.col(d)) count_visit(visits, (value - low) / (high - low));
  return visits;
}

/// Mean and variance of the process at the places of its cuts, over draws of the hyper-parameters.
struct Cuts {
  Eigen::MatrixXd inputs, places;  // of the fitted samples; of the cuts
  Eigen::VectorXd mean, variance;
};

std::optional<Cuts> cuts_over_draws(ProcessTarget const& target, ParameterSpace const& all, Draws const& draws, int channel) {
  auto const& covariance = target.model().channels()[static_cast<std::size_t>(channel)].covariance;
  LaneArray const columns = spread(draws, most_draws);
  Cuts cuts;
  double count = 0;
  Eigen::VectorXd squares;
  for (int draw = 0; draw < columns.width(); ++draw) {
    std::vector<double> declared;
    for (int p = 0; p < columns.rows(); ++p) declared.push_back(columns(p, draw));
    auto const regression = target.regression(fitted_parameters(all, declared), channel, false);
    if (!regression) continue;
    if (count == 0) {
      cuts.inputs = regression->observations.inputs;
      cuts.places = places_of_cuts(cuts.inputs);
      cuts.mean = cuts.variance = squares = Eigen::VectorXd::Zero(cuts.places.rows());
    }
    auto const given = gaussian_process::conditional(covariance, regression->observations, regression->parameters,
                                                     {cuts.places, Eigen::MatrixXd(cuts.places.rows(), 0)});
    if (given.outcome != gaussian_process::Outcome::fine) continue;
    cuts.mean += given.prediction.mean;
    squares += given.prediction.mean.cwiseAbs2();
    cuts.variance += given.prediction.variance;
    count += 1;
  }
  if (count == 0) return std::nullopt;
  cuts.mean /= count;
  cuts.variance = (cuts.variance / count + squares / count - cuts.mean.cwiseAbs2()).cwiseMax(0.0);
  return cuts;
}

/// Inputs of a list of lags share a name: "u lag 2" is the one two samples back.
std::string label_of(Process const& process, std::size_t input) {
  std::string const& name = process.inputs[input].name;
  return process.lags[input] < 0 ? name : fmt::format("{} lag {}", name, process.lags[input]);
}

FunctionReport report_of(Process const& process, Cuts const& cuts) {
  FunctionReport report{process.name, process.unit_text(), {}, {}, {}, {}};
  for (std::size_t d = 0; d < process.inputs.size(); ++d) {
    report.inputs.emplace_back(label_of(process, d), process.inputs[d].unit_text());
    report.visits.push_back(visits_of(cuts.inputs, static_cast<Eigen::Index>(d)));
    report.cuts.emplace_back();
    for (int i = 0; i < along_a_cut; ++i) {
      Eigen::Index const row = static_cast<Eigen::Index>(d) * along_a_cut + i;
      FunctionPoint point;
      for (std::size_t k = 0; k < process.inputs.size(); ++k)
        point.inputs.push_back(process.inputs[k].from_si(cuts.places(row, static_cast<Eigen::Index>(k))));
      point.set_normal(process.from_si(cuts.mean[row]), process.from_si(std::sqrt(cuts.variance[row])));
      report.cuts.back().push_back(point);
      report.grid.push_back(std::move(point));
    }
  }
  return report;
}

}  // namespace

std::vector<FunctionReport> process_functions(ProcessTarget const& target, ParameterSpace const& all, Draws const& draws) {
  std::vector<FunctionReport> reports;
  std::vector<Process> const& processes = target.model().model().processes;
  for (Process const& process : processes) {
    auto const sharing =
        std::count_if(processes.begin(), processes.end(), [&](Process const& other) { return other.channel == process.channel; });
    if (sharing != 1) continue;
    for (std::size_t c = 0; c < target.model().channels().size(); ++c)
      if (target.model().channels()[c].channel == process.channel)
        if (auto const cuts = cuts_over_draws(target, all, draws, static_cast<int>(c)))
          reports.push_back(report_of(process, *cuts));
  }
  return reports;
}

}  // namespace sysid

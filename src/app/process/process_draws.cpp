// Conditional draws and forecasts, one draw of the sampled parameters after the other.
#include "app/process/process_draws.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "gaussian_process/regression.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

LaneArray one_column(std::vector<double> const& values, int rows) {
  LaneArray column(rows, 1);
  for (int r = 0; r < rows; ++r) column(r, 0) = values[static_cast<std::size_t>(r)];
  return column;
}

LaneArray of_experiments(ParameterSpace const& space, std::vector<double> const& declared, std::size_t parameters) {
  LaneArray const values = space.values_of_declared(one_column(declared, space.dimension()));
  LaneArray result(static_cast<int>(parameters), static_cast<int>(space.experiments().size()));
  for (int e = 0; e < result.width(); ++e) space.select(values, e, result.view().columns(e, 1));
  return result;
}

/// Coefficients of a channel given the rest, SI; nothing where the regression fails.
std::optional<gaussian_process::Coefficients> coefficients_of(ProcessTarget const& target, ConstLanes parameters, int channel) {
  auto const regression = target.regression(parameters, channel, true);
  if (!regression) return std::nullopt;
  auto const& covariance = target.model().channels()[static_cast<std::size_t>(channel)].covariance;
  gaussian_process::Places const none{Eigen::MatrixXd(0, regression->observations.inputs.cols()),
                                      Eigen::MatrixXd(0, regression->observations.columns.cols())};
  auto conditional = gaussian_process::conditional(covariance, regression->observations, regression->parameters, none);
  if (conditional.outcome != gaussian_process::Outcome::fine) return std::nullopt;
  return std::move(conditional.coefficients);
}

std::size_t place_of(ParameterSpace const& all, std::string const& name) {
  auto const infos = all.infos();
  auto const found = std::find_if(infos.begin(), infos.end(), [&](ParameterInfo const& each) { return each.name == name; });
  if (found == infos.end()) throw InternalError("a parameter that is none");
  return static_cast<std::size_t>(found - infos.begin());
}

}  // namespace

LaneArray fitted_parameters(ParameterSpace const& all, std::vector<double> const& declared) {
  return of_experiments(all, declared, all.model().parameters.size());
}

Draws with_coefficients(ProcessTarget const& target, ParameterSpace const& all, Draws const& sampled, std::uint64_t seed) {
  ProcessModel const& model = target.model();
  std::vector<std::size_t> places;  // of the sampled parameters
  for (ParameterInfo const& each : target.parameters()) places.push_back(place_of(all, each.name));
  Draws result;
  for (ParameterInfo const& each : all.infos()) {
    result.names.push_back(each.name);
    result.units.push_back(each.unit);
  }
  result.parameter_count = all.dimension();
  bool const optimum = sampled.is_optimum();
  std::uint64_t number = 0;
  for (Chain const& chain : sampled.chains) {
    Chain whole = chain;
    for (std::size_t d = 0; d < chain.values.size(); ++d, ++number) {
      std::vector<double> values(static_cast<std::size_t>(all.dimension()), std::nan(""));
      for (std::size_t p = 0; p < places.size(); ++p) values[places[p]] = chain.values[d][p];
      LaneArray const parameters = of_experiments(*target.space(), chain.values[d], model.model().parameters.size());
      for (std::size_t c = 0; c < model.channels().size(); ++c) {
        auto const& coefficients = model.channels()[c].coefficients;
        if (coefficients.empty()) continue;
        auto const given = coefficients_of(target, parameters, static_cast<int>(c));
        if (!given) continue;
        Eigen::VectorXd drawn = given->mean;
        if (auto const factor = optimum ? std::nullopt : cholesky(given->covariance)) {
          Stream stream({seed, Purpose::coefficient, number, c});
          Eigen::VectorXd normal(drawn.size());
          for (double& one : normal) one = stream.normal();
          drawn += *factor * normal;
        }
        for (std::size_t k = 0; k < coefficients.size(); ++k) {
          Parameter const& parameter = model.model().parameters[static_cast<std::size_t>(coefficients[k].parameter)];
          values[place_of(all, parameter.name)] = parameter.from_si(drawn[static_cast<Eigen::Index>(k)]);
        }
      }
      whole.values[d] = std::move(values);
    }
    result.chains.push_back(std::move(whole));
  }
  return result;
}

std::vector<std::pair<std::string, double>> coefficient_sds(ProcessTarget const& target, ParameterSpace const& all,
                                                            std::vector<double> const& declared) {
  std::vector<std::pair<std::string, double>> result;
  ProcessModel const& model = target.model();
  // Their own values stand in the way of the rest: at the mean of their prior the regression has them as columns.
  std::vector<double> sampled;
  for (ParameterInfo const& each : target.parameters()) sampled.push_back(declared[place_of(all, each.name)]);
  LaneArray const parameters = of_experiments(*target.space(), sampled, model.model().parameters.size());
  for (std::size_t c = 0; c < model.channels().size(); ++c) {
    auto const& coefficients = model.channels()[c].coefficients;
    if (coefficients.empty()) continue;
    auto const given = coefficients_of(target, parameters, static_cast<int>(c));
    if (!given) continue;
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      Parameter const& parameter = model.model().parameters[static_cast<std::size_t>(coefficients[k].parameter)];
      auto const i = static_cast<Eigen::Index>(k);
      result.emplace_back(parameter.name, parameter.from_si(std::sqrt(given->covariance(i, i))));
    }
  }
  return result;
}

Trajectory::Result forecast_draws(ProcessForecast const& forecast, ParameterSpace const& all, LaneArray const& spread,
                                  ConstLanes own, int wanted, StreamKey key) {
  Trajectory::Result result;
  int const each = std::max(1, wanted / std::max(1, spread.width()));
  for (int d = 0; d < spread.width(); ++d) {
    std::vector<double> declared;
    for (int p = 0; p < spread.rows(); ++p) declared.push_back(spread(p, d));
    forecast.run(fitted_parameters(all, declared), own.columns(d, 1), each, key, static_cast<std::uint64_t>(d * each), result);
  }
  return result;
}

}  // namespace sysid

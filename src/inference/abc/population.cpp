// Counting, weighing, storing.
#include "inference/abc/population.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "inference/checkpoint.hpp"

namespace sysid::abc {
namespace {

nlohmann::json block(std::vector<double> const& values) { return checkpoint::encode(std::span<double const>(values)); }

std::vector<double> numbers(Eigen::MatrixXd const& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

}  // namespace

void Particles::add(ConstLanes x, int lane, double log_prior_there, double distance_there) {
  for (int d = 0; d < x.rows(); ++d) at.push_back(x(d, lane));
  log_prior.push_back(log_prior_there);
  distance.push_back(distance_there);
  weight.push_back(0);
}

LaneArray Particles::lanes(int dimension) const {
  LaneArray result(dimension, count());
  for (int j = 0; j < count(); ++j)
    for (int d = 0; d < dimension; ++d) result(d, j) = at[static_cast<std::size_t>(j * dimension + d)];
  return result;
}

double Particles::weight_sum() const { return std::accumulate(weight.begin(), weight.end(), 0.0); }

int Population::accepted() const {
  int total = 0;
  for (Particles const& each : models) total += each.count();
  return total;
}

double Population::ess() const {
  double squares = 0;
  for (Particles const& each : models)
    for (double const w : each.weight) squares += w * w;
  return 1 / squares;
}

double Population::quantile(double part) const {
  std::vector<double> all;
  for (Particles const& each : models) all.insert(all.end(), each.distance.begin(), each.distance.end());
  std::sort(all.begin(), all.end());
  auto const rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(all.size()) * (1 - 1e-12)));  // 0.07 x 100 is 7
  return all[std::clamp<std::size_t>(rank, 1, all.size()) - 1];
}

nlohmann::json store(Population const& population) {
  nlohmann::json models = nlohmann::json::array(), widths = nlohmann::json::array();
  for (Particles const& each : population.models)
    models.push_back({block(each.at), block(each.log_prior), block(each.distance), block(each.weight)});
  for (Width const& each : population.widths) widths.push_back({block(numbers(each.covariance)), block(numbers(each.range))});
  return {{"number", population.number},
          {"threshold", block({population.threshold})},
          {"models", std::move(models)},
          {"widths", std::move(widths)}};
}

Population restore_population(nlohmann::json const& stored, std::vector<int> const& dimensions) {
  Population population;
  population.number = stored.at("number").get<int>();
  population.threshold = checkpoint::decode(stored.at("threshold")).at(0);
  for (std::size_t m = 0; m < dimensions.size(); ++m) {
    auto const& model = stored.at("models").at(m);
    Particles particles{checkpoint::decode(model.at(0)), checkpoint::decode(model.at(1)), checkpoint::decode(model.at(2)),
                        checkpoint::decode(model.at(3))};
    auto const count = particles.distance.size(), dimension = static_cast<std::size_t>(dimensions[m]);
    if (particles.at.size() != count * dimension || particles.log_prior.size() != count || particles.weight.size() != count)
      throw checkpoint::Mismatch("its particles have another number or dimension");
    population.models.push_back(std::move(particles));
    std::vector<double> const covariance = checkpoint::decode(stored.at("widths").at(m).at(0)),
                              range = checkpoint::decode(stored.at("widths").at(m).at(1));
    if (covariance.size() != dimension * dimension || range.size() != dimension)
      throw checkpoint::Mismatch("its kernels have another dimension");
    population.widths.push_back({Eigen::Map<Eigen::MatrixXd const>(covariance.data(), dimensions[m], dimensions[m]),
                                 Eigen::Map<Eigen::VectorXd const>(range.data(), dimensions[m])});
  }
  return population;
}

nlohmann::json store(PopulationRecord const& record) {
  nlohmann::json models = nlohmann::json::array();
  for (auto const& each : record.models)
    models.push_back({each.proposed, each.failed, each.particles, block({each.probability, each.nearest})});
  return {{"numbers", block({record.threshold, record.ess})},
          {"counts", {record.proposed, record.simulated, record.failed, record.accepted}},
          {"models", std::move(models)}};
}

PopulationRecord restore_record(nlohmann::json const& stored) {
  PopulationRecord record;
  std::vector<double> const pair = checkpoint::decode(stored.at("numbers"));
  record.threshold = pair.at(0);
  record.ess = pair.at(1);
  auto const& counts = stored.at("counts");
  record.proposed = counts.at(0).get<std::uint64_t>();
  record.simulated = counts.at(1).get<std::uint64_t>();
  record.failed = counts.at(2).get<std::uint64_t>();
  record.accepted = counts.at(3).get<int>();
  for (auto const& model : stored.at("models")) {
    std::vector<double> const two = checkpoint::decode(model.at(3));
    record.models.push_back(
        {model.at(0).get<std::uint64_t>(), model.at(1).get<std::uint64_t>(), model.at(2).get<int>(), two.at(0), two.at(1)});
  }
  return record;
}

}  // namespace sysid::abc

// Which of a disturbance and the noise of the measurement a record can tell apart, before there is any fit: the information about
// the sizes of both that records contain which the model itself makes along the actual input.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/preflight/preflight.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "likelihood/first_rows.hpp"
#include "likelihood/particle/drawn_disturbances.hpp"
#include "likelihood/trajectory.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr int rows_looked_at = 1000, draws_looked_at = 3, sizes_tried = 9;
constexpr std::size_t most_noises = 3;
constexpr int many_moments = 150;   // with their covariances: a likelihood that takes long
constexpr double step = 0.2;        // of logarithms, under differences
constexpr double told = 0.7;        // sd of a logarithm below which a size is known: a factor of two
constexpr double unknown_sd = 1e6;  // of a direction without information

// The intensity of one or several disturbances, and the noise of channels, each by the coordinate that sets it.
struct Sizes {
  std::vector<std::string> disturbances;
  int intensity;
  std::vector<int> noise;
};

bool reads(Model const& model, NodeId root, int parameter) {
  return model.graph.depends(root, [&](Node const& leaf) {
    return leaf.operation == Operation::leaf && leaf.leaf_kind == LeafKind::parameter && leaf.index == parameter;
  });
}

class SizesApart {
 public:
  SizesApart(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws)
      : preflight_(preflight), model_(preflight.model()), space_(*preflight.space), prior_(prior), draws_(draws) {
    int const scored = most_scored_rows(preflight.experiments);
    FirstRows part =
        first_rows(preflight.experiments, scored > rows_looked_at ? static_cast<double>(rows_looked_at) / scored : 1, 1);
    along_ = std::move(part.experiments);
    information_ = scored > rows_looked_at ? static_cast<double>(scored) / rows_looked_at : 1;
    declared_ = LaneArray(space_.dimension(), prior.theta.width());
    space_.constrain(prior.theta, declared_);
    if (static_cast<int>(draws_.size()) > draws_looked_at) draws_.resize(draws_looked_at);
  }

  void describe() const {
    for (Sizes const& sizes : all_sizes()) describe(sizes);
  }

 private:
  std::string const& name(int coordinate) const { return space_.infos()[static_cast<std::size_t>(coordinate)].name; }

  // Intensities of a single parameter that is nothing else, by that parameter.
  std::vector<Sizes> all_sizes() const {
    std::vector<Sizes> all;
    std::vector<int> intensities, noise;
    for (int k = 0; k < space_.dimension(); ++k) {
      AssessedParameter const& coordinate = prior_.coordinates[static_cast<std::size_t>(k)];
      if (coordinate.role != ParameterRole::noise || !coordinate.relative) continue;
      int const p = space_.rows()[static_cast<std::size_t>(space_.sampled()[static_cast<std::size_t>(k)])].parameter;
      bool const moves = std::any_of(model_.disturbances.begin(), model_.disturbances.end(),
                                     [&](Disturbance const& each) { return reads(model_, each.intensity, p); });
      bool const measures = std::any_of(model_.channels.begin(), model_.channels.end(), [&](Channel const& channel) {
        return std::any_of(channel.noise.arguments.begin() + 1, channel.noise.arguments.end(),
                           [&](NodeId argument) { return reads(model_, argument, p); });
      });
      if (moves && !measures) intensities.push_back(k);
      if (measures && !moves) noise.push_back(k);
    }
    if (noise.size() > most_noises) noise.resize(most_noises);
    for (int const k : intensities) {
      Sizes sizes{{}, k, noise};
      int const p = space_.rows()[static_cast<std::size_t>(space_.sampled()[static_cast<std::size_t>(k)])].parameter;
      for (Disturbance const& each : model_.disturbances)
        if (reads(model_, each.intensity, p)) sizes.disturbances.push_back(each.name);
      if (!sizes.disturbances.empty()) all.push_back(std::move(sizes));
    }
    return all;
  }

  // Over nearly all of its prior, a factor apart.
  std::vector<double> tried(int coordinate) const {
    auto const row = declared_.row(coordinate);
    std::vector<double> const all(row.begin(), row.end());
    double const least = quantile(all, 0.02), most = quantile(all, 0.98);
    std::vector<double> values;
    for (int i = 0; i < sizes_tried; ++i)
      values.push_back(least * elementary::pow(most / least, static_cast<double>(i) / (sizes_tried - 1)));
    return values;
  }

  double middle(int coordinate) const {
    auto const row = declared_.row(coordinate);
    return quantile(std::vector<double>(row.begin(), row.end()), 0.5);
  }

  void describe(Sizes const& sizes) const {
    std::vector<double> const values = tried(sizes.intensity);
    // Where each is known: of the intensity the first of these values from which it is, of all noise the last up to which.
    int from = sizes_tried, to = -1, judged = 0;
    bool both = false;
    for (int i = 0; i < sizes_tried; ++i) {
      auto const sds = expected(sizes, values[static_cast<std::size_t>(i)]);
      if (!sds) continue;
      ++judged;
      bool const intensity = sds->front() < told, noise = std::all_of(
                                                      sds->begin() + 1, sds->end(), [](double sd) { return sd < told; });
      if (intensity) from = std::min(from, i);
      if (noise) to = i;
      both = both || (intensity && noise);
    }
    if (2 * judged <= sizes_tried) return;
    say(sizes, values, from, to, both);
  }

  void say(Sizes const& sizes, std::vector<double> const& values, int from, int to, bool both) const {
    ParameterInfo const& info = space_.infos()[static_cast<std::size_t>(sizes.intensity)];
    auto const about = [&](int i) {
      return fmt::format("about {}{}", significant(values[static_cast<std::size_t>(i)], 1), unit_after_number(info.unit));
    };
    std::string const whose = listed(sizes.disturbances);
    std::string text =
        from == sizes_tried
            ? fmt::format("the record is not expected to determine {} for any value that the prior allows", info.name)
        : from == 0 ? fmt::format("the record is expected to determine {} for any value that the prior allows", info.name)
                    : fmt::format("the record is expected to determine {} only if its value is above {}", info.name, about(from));
    if (!sizes.noise.empty()) {
      std::vector<std::string> names;
      for (int const k : sizes.noise) names.push_back(name(k));
      text += to < 0 ? fmt::format("; it is not expected to determine {} for any value of {}", listed(names), info.name)
              : to == sizes_tried - 1
                  ? fmt::format("; it is expected to determine {} for any size of the disturbance", listed(names))
                  : fmt::format("; it is expected to determine {} only if {} is below {}", listed(names), info.name, about(to));
    }
    std::string const sentence = fmt::format("{} and measurement noise: {}", whose, text);
    preflight_.page.disturbances.push_back(sentence);
    if (both) return;
    std::vector<std::string> named = sizes.disturbances;
    named.push_back(info.name);
    for (int const k : sizes.noise) named.push_back(name(k));
    preflight_.add(FindingCode::disturbance_and_noise, preflight_.candidate() ? Severity::note : Severity::warning,
                   std::move(named), "the record is not expected to distinguish the disturbance from the noise: " + sentence,
                   "state the noise of the sensor in place of its prior, sample faster, or measure another quantity");
  }

  // Expected sds of the logarithms of the intensity and of each noise, the middle ones over the draws; nothing where none can be
  // judged.
  std::optional<std::vector<double>> expected(Sizes const& sizes, double intensity) const {
    std::vector<std::vector<double>> all;
    for (int const draw : draws_)
      if (auto sds = expected_at(sizes, intensity, draw)) all.push_back(std::move(*sds));
    if (all.empty()) return std::nullopt;
    std::vector<double> middle;
    for (std::size_t i = 0; i < all.front().size(); ++i) {
      std::vector<double> each;
      for (std::vector<double> const& sds : all) each.push_back(sds[i]);
      std::sort(each.begin(), each.end());
      middle.push_back(each[each.size() / 2]);
    }
    return middle;
  }

  std::optional<std::vector<double>> expected_at(Sizes const& sizes, double intensity, int draw) const {
    std::vector<int> coordinates = {sizes.intensity};
    coordinates.insert(coordinates.end(), sizes.noise.begin(), sizes.noise.end());
    LaneArray truth(space_.dimension(), 1);
    for (int k = 0; k < truth.rows(); ++k) {
      bool const noise = prior_.coordinates[static_cast<std::size_t>(k)].role == ParameterRole::noise;
      truth(k, 0) = noise ? middle(k) : declared_(k, draw);
    }
    truth(sizes.intensity, 0) = intensity;
    // The coarsest solver that follows the draw: those of a prior move faster than the record.
    for (SolverSettings const& solver : preflight_.solvers)
      if (auto sds = expected_with(solver, truth, coordinates)) return sds;
    return std::nullopt;
  }

  std::optional<std::vector<double>> expected_with(SolverSettings const& solver, LaneArray const& truth,
                                                   std::vector<int> const& coordinates) const {
    auto const made = made_records(truth, solver);
    if (!made) return std::nullopt;
    // In the middle, up and down along each.
    auto const n = static_cast<int>(coordinates.size());
    LaneArray points(truth.rows(), 1 + 2 * n);
    for (int w = 0; w < points.width(); ++w)
      for (int k = 0; k < points.rows(); ++k) points(k, w) = truth(k, 0);
    for (int i = 0; i < n; ++i) {
      points(coordinates[static_cast<std::size_t>(i)], 1 + 2 * i) *= elementary::exp(step);
      points(coordinates[static_cast<std::size_t>(i)], 2 + 2 * i) *= elementary::exp(-step);
    }
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    LaneArray const values = space_.values_of_declared(points);
    for (std::size_t e = 0; e < made->size(); ++e)
      if (!add_information(values, static_cast<int>(e), (*made)[e], solver, information)) return std::nullopt;
    return sds_of(information * information_);
  }

  // Of innovations v ~ normal(0, S) about predictions m, by theta: the sum over the samples of
  //   1/2 d log S/d theta_j d log S/d theta_k + dm/d theta_j dm/d theta_k/S.
  // values [rows x 1 + 2 n]: of the space, at the truth, then up and down along each.
  bool add_information(ConstLanes values, int experiment, Experiment const& made, SolverSettings const& solver,
                       Eigen::MatrixXd& information) const {
    LaneArray parameters(static_cast<int>(model_.parameters.size()), values.width());
    space_.select(values, experiment, parameters);
    Trajectory const trajectory(preflight_.compiled, made, solver, start_rows(preflight_.what.start),
                                preflight_.session.abandonable());
    Trajectory::Result const result = trajectory.run(parameters, {1, Purpose::prediction});
    if (result.failed() > 0) return false;
    for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
      int const channel = trajectory.quantities()[q].channel;
      if (channel < 0) continue;
      auto const& means = result.values[q];
      auto const& sds = result.noisy_spread[static_cast<std::size_t>(channel)];
      Eigen::VectorXd mean(information.rows()), size(information.rows());
      for (std::size_t i = 0; i < made.time.size(); ++i) {
        if (!made.is_scored(static_cast<std::size_t>(channel), i)) continue;
        for (Eigen::Index k = 0; k < information.rows(); ++k) {
          auto const up = 1 + 2 * static_cast<std::size_t>(k), down = up + 1;
          mean(k) = (means[up][i] - means[down][i]) / (2 * step * sds[0][i]);
          size(k) = elementary::log(sds[up][i] / sds[down][i]) / step;  // of S, which is the square
        }
        if (!mean.allFinite() || !size.allFinite()) return false;
        information += mean * mean.transpose() + size * size.transpose() / 2;
      }
    }
    return true;
  }

  static std::vector<double> sds_of(Eigen::MatrixXd const& information) {
    auto const [values, vectors] = symmetric_eigen(information);
    std::vector<double> sds;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      double variance = 0;
      for (Eigen::Index k = 0; k < values.size(); ++k)
        variance += vectors(i, k) * vectors(i, k) / std::max(values(k), 1 / (unknown_sd * unknown_sd));
      sds.push_back(std::sqrt(variance));
    }
    return sds;
  }

  // What the model measures with these declared values, in the place of what was measured.
  std::optional<std::vector<Experiment>> made_records(LaneArray const& truth, SolverSettings const& solver) const {
    LaneArray const values = space_.values_of_declared(truth);
    std::vector<Experiment> made = along_;
    for (std::size_t e = 0; e < made.size(); ++e) {
      LaneArray parameters(static_cast<int>(model_.parameters.size()), 1);
      space_.select(values, static_cast<int>(e), parameters);
      DrawnDisturbances drawn = draw_disturbances(model_, parameters, along_[e], {1, Purpose::disturbance, e, 0},
                                                  solver.fixed_step() ? solver.substeps : 1);
      auto const compiled = compile(std::move(drawn.model), preflight_.compiled->free_start, preflight_.what.solver.method);
      Trajectory const trajectory(compiled, drawn.experiment, solver, start_rows(preflight_.what.start),
                                  preflight_.session.abandonable());
      Trajectory::Result const result = trajectory.run(parameters, {1, Purpose::noise, e, 0});
      if (result.failed() > 0) return std::nullopt;
      for (std::size_t c = 0; c < made[e].measured.size(); ++c)
        for (std::size_t i = 0; i < made[e].measured[c].size(); ++i) {
          if (std::isnan(made[e].measured[c][i])) continue;
          made[e].measured[c][i] = model_.channels[c].to_si(result.noisy[c][0][i]);
          if (!std::isfinite(made[e].measured[c][i])) return std::nullopt;
        }
    }
    return made;
  }

  Preflight const& preflight_;
  Model const& model_;
  ParameterSpace const& space_;
  PriorDraws const& prior_;
  std::vector<int> draws_;
  std::vector<Experiment> along_;
  double information_ = 1;  // of the whole record, of that of the rows looked at
  LaneArray declared_;      // [P x draws]
};

}  // namespace

void describe_disturbances(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws) {
  Model const& model = preflight.model();
  auto const states = static_cast<int>(model.states.size());
  int const moments = states + states * (states + 1) / 2;
  if (model.disturbances.empty() || draws.empty() || preflight.effort.examined == 0 || moments > many_moments) return;
  SizesApart(preflight, prior, draws).describe();
}

}  // namespace sysid

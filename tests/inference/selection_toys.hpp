// Candidates whose distances are written out, for tests of back ends that select among models.
#pragma once
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "inference/abc/settings.hpp"
#include "inference/targets.hpp"
#include "likelihood/selection/selection_target.hpp"

namespace sysid::testing {

/// Models of one or several parameters whose distance is a function of the declared values; NaN: the simulation failed.
class Toy : public SelectionTarget {
 public:
  using DistanceFunction = std::function<double(std::span<double const>)>;
  struct OfModel {
    std::string name;
    double probability;
    std::vector<Prior> priors;
    DistanceFunction distance;
  };
  explicit Toy(std::vector<OfModel> models) : models_(std::move(models)) {
    for (OfModel const& model : models_) {
      infos_.emplace_back();
      for (std::size_t p = 0; p < model.priors.size(); ++p)
        infos_.back().push_back({"p" + std::to_string(p), "", -infinity, infinity});
    }
  }

  int size() const override { return static_cast<int>(models_.size()); }
  std::string const& name(int m) const override { return at(m).name; }
  double prior_probability(int m) const override { return at(m).probability; }
  std::span<ParameterInfo const> parameters(int m) const override { return infos_[static_cast<std::size_t>(m)]; }
  void sample_prior(int m, StreamKey key, Lanes theta) const override {
    for (int w = 0; w < theta.width(); ++w) {
      Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
      for (int p = 0; p < theta.rows(); ++p) theta(p, w) = prior(m, p).draw(stream);
    }
  }
  void log_prior(int m, ConstLanes theta, std::span<double> out, bool jacobian) const override {
    for (int w = 0; w < theta.width(); ++w) {
      double sum = 0;
      for (int p = 0; p < theta.rows(); ++p) {
        sum += prior(m, p).log_density(prior(m, p).constrain(theta(p, w)));
        if (jacobian) sum += prior(m, p).log_jacobian(theta(p, w));
      }
      out[static_cast<std::size_t>(w)] = sum;
    }
  }
  void constrain(int m, ConstLanes theta, Lanes declared) const override {
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) declared(p, w) = prior(m, p).constrain(theta(p, w));
  }
  void unconstrain(int m, ConstLanes declared, Lanes theta) const override {
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) theta(p, w) = prior(m, p).unconstrain(declared(p, w));
  }
  void distances(std::span<Batch const> batches, double bound) const override {
    for (Batch const& batch : batches) {
      LaneArray declared(batch.theta.rows(), batch.theta.width());
      constrain(batch.model, batch.theta, declared);
      for (int w = 0; w < declared.width(); ++w) {
        std::vector<double> values;
        for (int p = 0; p < declared.rows(); ++p) values.push_back(declared(p, w));
        double const distance = at(batch.model).distance(values);
        auto const i = static_cast<std::size_t>(w);
        batch.ending[i] = std::isnan(distance) ? Simulated::failed : distance <= bound ? Simulated::within : Simulated::beyond;
        batch.distance[i] = batch.ending[i] == Simulated::within ? distance : infinity;
      }
    }
  }
  std::pair<std::string, double> failure(int, ConstLanes) const override { return {"the toy", 0.5}; }
  void parallel(int tasks, std::function<void(int)> const& task) const override {
    for (int t = tasks - 1; t >= 0; --t) task(t);  // their order must not matter
  }

 private:
  OfModel const& at(int m) const { return models_[static_cast<std::size_t>(m)]; }
  Prior const& prior(int m, int p) const { return at(m).priors[static_cast<std::size_t>(p)]; }
  std::vector<OfModel> models_;
  std::vector<std::vector<ParameterInfo>> infos_;
};

inline double size_of_first(std::span<double const> values) { return std::fabs(values[0]); }

/// theta ~ U(-1, 1) against theta ~ U(-10, 10), distance |theta|: below a threshold of 1 the first is ten times as probable, 10/11.
inline Toy two_widths() {
  return Toy(
      {{"narrow", 0.5, {{Prior::uniform, -1, 1}}, size_of_first}, {"wide", 0.5, {{Prior::uniform, -10, 10}}, size_of_first}});
}

inline Settings abc_settings(std::initializer_list<std::pair<char const*, SettingValue>> values) {
  Settings settings(abc::settings());
  for (auto const& [name, value] : values) settings.set(name, value);
  return settings;
}

}  // namespace sysid::testing

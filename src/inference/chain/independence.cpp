// Drawing from mixtures of normal and Student's t distributions, and their density.
#include "inference/chain/independence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::metropolis {
namespace {

constexpr double normal_share = 0.75;
constexpr int degrees = 6;  // of freedom, even: chi-square variates are sums of squares of normals
constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

double log_of_sum(double a, double b) {
  double const high = std::max(a, b), low = std::min(a, b);
  return high == minus_infinity ? high : high + elementary::log1p(elementary::exp(low - high));
}

}  // namespace

Independence::Independence(std::vector<Component> const& components) {
  std::vector<double> weights;
  for (Component const& component : components) {
    Eigen::MatrixXd const factor = cholesky_or_diagonal(component.covariance);
    dimension_ = static_cast<std::size_t>(component.mean.size());
    Part part;
    part.mean.assign(component.mean.begin(), component.mean.end());
    part.factor.assign(dimension_ * dimension_, 0.0);
    for (std::size_t i = 0; i < dimension_; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        part.factor[i * dimension_ + j] = factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    parts_.push_back(std::move(part));
    weights.push_back(component.weight);
  }
  set_constants(weights);
}

void Independence::set_constants(std::vector<double> const& weights) {
  double sum = 0, before = 0;
  for (double const weight : weights) sum += weight;
  auto const p = static_cast<double>(dimension_);
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    Part& part = parts_[k];
    before += weights[k];
    part.cumulative = before / sum;
    double log_volume = 0;
    for (std::size_t i = 0; i < dimension_; ++i) log_volume += elementary::log(part.factor[i * dimension_ + i]);
    double const log_weight = elementary::log(weights[k] / sum) - log_volume;
    part.log_normal = log_weight + elementary::log(normal_share) - p / 2 * elementary::log(2 * std::numbers::pi);
    part.log_student = log_weight + elementary::log(1 - normal_share) + elementary::lgamma((degrees + p) / 2) -
                       elementary::lgamma(degrees / 2.0) - p / 2 * elementary::log(degrees * std::numbers::pi);
  }
}

void Independence::draw(StreamKey key, Lanes to, int lane) const {
  Stream stream(key);
  double const which = stream.uniform();
  Part const* part = &parts_.back();
  for (Part const& candidate : parts_)
    if (which < candidate.cumulative) {
      part = &candidate;
      break;
    }
  double scale = 1;
  if (stream.uniform() >= normal_share) {
    double squares = 0;
    for (int i = 0; i < degrees; ++i) {
      double const z = stream.normal();
      squares += z * z;
    }
    scale = std::sqrt(degrees / squares);
  }
  // Column after column, so that no copy of z is held.
  for (std::size_t i = 0; i < dimension_; ++i) to(static_cast<int>(i), lane) = part->mean[i];
  for (std::size_t j = 0; j < dimension_; ++j) {
    double const z = scale * stream.normal();
    for (std::size_t i = j; i < dimension_; ++i) to(static_cast<int>(i), lane) += part->factor[i * dimension_ + j] * z;
  }
}

double Independence::log_part(Part const& part, ConstLanes theta, int lane) const {
  // z = L^-1 (x - mean) by forward substitution.
  double few[64];
  std::vector<double> many;
  double* z = few;
  if (dimension_ > std::size(few)) {
    many.resize(dimension_);
    z = many.data();
  }
  double squares = 0;
  for (std::size_t i = 0; i < dimension_; ++i) {
    double rest = theta(static_cast<int>(i), lane) - part.mean[i];
    double const* row = part.factor.data() + i * dimension_;
    for (std::size_t j = 0; j < i; ++j) rest -= row[j] * z[j];
    z[i] = rest / row[i];
    squares += z[i] * z[i];
  }
  if (!std::isfinite(squares)) return minus_infinity;
  double const student = part.log_student - (degrees + static_cast<double>(dimension_)) / 2 * elementary::log1p(squares / degrees);
  return log_of_sum(part.log_normal - squares / 2, student);
}

double Independence::log_density(ConstLanes theta, int lane) const {
  double sum = minus_infinity;
  for (Part const& part : parts_) sum = log_of_sum(sum, log_part(part, theta, lane));
  return sum;
}

int Independence::nearest(ConstLanes theta, int lane) const {
  int best = parts_.empty() ? -1 : 0;
  double highest = minus_infinity;
  for (std::size_t k = 0; parts_.size() > 1 && k < parts_.size(); ++k) {
    double const here = log_part(parts_[k], theta, lane);
    if (here <= highest) continue;
    highest = here;
    best = static_cast<int>(k);
  }
  return best;
}

nlohmann::json Independence::store() const {
  nlohmann::json parts = nlohmann::json::array();
  for (Part const& part : parts_)
    parts.push_back({{"constants", checkpoint::encode(std::vector<double>{part.cumulative, part.log_normal, part.log_student})},
                     {"mean", checkpoint::encode(std::span<double const>(part.mean))},
                     {"factor", checkpoint::encode(std::span<double const>(part.factor))}});
  return parts;
}

Independence Independence::restore(nlohmann::json const& stored, int dimension) {
  Independence all;
  all.dimension_ = static_cast<std::size_t>(dimension);
  for (nlohmann::json const& from : stored) {
    std::vector<double> const constants = checkpoint::decode(from.at("constants"), 3);
    all.parts_.push_back({constants.at(0), constants.at(1), constants.at(2), checkpoint::decode(from.at("mean"), all.dimension_),
                          checkpoint::decode(from.at("factor"), all.dimension_ * all.dimension_)});
  }
  return all;
}

}  // namespace sysid::metropolis

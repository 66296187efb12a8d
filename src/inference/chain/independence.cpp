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

constexpr double normal_share = 0.65, axis_share = 0.25, student_share = 1 - normal_share - axis_share;
constexpr int degrees = 6, axis_degrees = 3;  // of freedom
constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

/// A standard normal over the root of chi-square / degrees has Student's t distribution: this is one over that root.
double student_scale(Stream& stream, int degrees_of_freedom) {
  double squares = 0;
  for (int i = 0; i < degrees_of_freedom; ++i) {
    double const z = stream.normal();
    squares += z * z;
  }
  return std::sqrt(degrees_of_freedom / squares);
}

/// log of t_3(z) / N(z), both with their constants.
double log_axis_ratio(double z) {
  constexpr double log_constant = -0.08195031641883688;  // log(2 / (pi sqrt 3)) + 1/2 log(2 pi)
  return log_constant + z * z / 2 - 2 * elementary::log1p(z * z / axis_degrees);
}

}  // namespace

double log_of_sum(double a, double b) {
  double const high = std::max(a, b), low = std::min(a, b);
  return high == minus_infinity ? high : high + elementary::log1p(elementary::exp(low - high));
}

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
    set_sds(part);
    parts_.push_back(std::move(part));
    weights.push_back(component.weight);
  }
  set_constants(weights);
}

void Independence::set_sds(Part& part) {
  std::size_t const n = part.mean.size();
  part.sd.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) part.sd[i] += part.factor[i * n + j] * part.factor[i * n + j];
    part.sd[i] = std::sqrt(part.sd[i]);
  }
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
    part.log_normal = log_weight - p / 2 * elementary::log(2 * std::numbers::pi);
    part.log_student = log_weight + elementary::log(student_share) + elementary::lgamma((degrees + p) / 2) -
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
  double const kind = stream.uniform();
  bool const along_axis = kind >= normal_share && kind < normal_share + axis_share;
  auto const axis = along_axis ? static_cast<std::size_t>(stream.below(dimension_)) : 0;
  double const scale = kind < normal_share ? 1 : along_axis ? student_scale(stream, axis_degrees) : student_scale(stream, degrees);
  // Column after column, so that no copy of z is held.
  for (std::size_t i = 0; i < dimension_; ++i) to(static_cast<int>(i), lane) = part->mean[i];
  for (std::size_t j = 0; j < dimension_; ++j) {
    double const z = (along_axis ? 1 : scale) * stream.normal();
    for (std::size_t i = j; i < dimension_; ++i) to(static_cast<int>(i), lane) += part->factor[i * dimension_ + j] * z;
  }
  if (!along_axis) return;
  double const z = (to(static_cast<int>(axis), lane) - part->mean[axis]) / part->sd[axis];
  shift(*part, axis, (scale - 1) * z, to, lane);
}

void Independence::shift(Part const& part, std::size_t j, double sds, Lanes to, int lane) const {
  double const* row = part.factor.data() + j * dimension_;
  for (std::size_t i = 0; i < dimension_; ++i) {
    double covariance = 0;
    double const* other = part.factor.data() + i * dimension_;
    for (std::size_t k = 0; k <= std::min(i, j); ++k) covariance += other[k] * row[k];
    to(static_cast<int>(i), lane) += covariance / part.sd[j] * sds;
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
  // N (0.65 + 0.25 / P sum of ratios), the ratios after their largest: they overflow far out, where N vanishes.
  double highest = 0, sum = 0;
  for (std::size_t j = 0; j < dimension_; ++j) {
    z[j] = log_axis_ratio((theta(static_cast<int>(j), lane) - part.mean[j]) / part.sd[j]);
    highest = std::max(highest, z[j]);
  }
  for (std::size_t j = 0; j < dimension_; ++j) sum += elementary::exp(z[j] - highest);
  double const inner = normal_share * elementary::exp(-highest) + axis_share * sum / static_cast<double>(dimension_);
  return log_of_sum(part.log_normal - squares / 2 + highest + elementary::log(inner), student);
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
    Part part{constants.at(0),
              constants.at(1),
              constants.at(2),
              checkpoint::decode(from.at("mean"), all.dimension_),
              checkpoint::decode(from.at("factor"), all.dimension_ * all.dimension_),
              {}};
    set_sds(part);
    all.parts_.push_back(std::move(part));
  }
  return all;
}

}  // namespace sysid::metropolis

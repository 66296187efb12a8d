// Drawing from mixtures of normal and Student's t distributions, and their density.
#include "inference/chain/independence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normals.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/substitution.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::metropolis {
namespace {

constexpr double normal_share = 0.65, axis_share = 0.25, student_share = 1 - normal_share - axis_share;
constexpr int degrees = 6, axis_degrees = 3;  // of freedom
constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

/// log of t_3(z) / N(z), both with their constants: this and  z^2 / 2 - 2 log(1 + z^2 / 3).
constexpr double log_axis_constant = -0.08195031641883688;  // log(2 / (pi sqrt 3)) + 1/2 log(2 pi)

/// `log_of_sum` in place of a; both of one length.
void add_logs(std::span<double> a, std::span<double const> b) {
  std::vector<double> rest(a.size());
  for (std::size_t w = 0; w < a.size(); ++w) rest[w] = std::min(a[w], b[w]) - std::max(a[w], b[w]);
  auto const width = static_cast<int>(a.size());
  elementary::exp_lanes(rest.data(), rest.data(), width);
  elementary::log1p_lanes(rest.data(), rest.data(), width);
  for (std::size_t w = 0; w < a.size(); ++w) {
    double const high = std::max(a[w], b[w]);
    a[w] = high == minus_infinity ? high : high + rest[w];
  }
}

/// P numbers, without a visit to the heap while they are few.
class Scratch {
 public:
  explicit Scratch(std::size_t size) : size_(size) {
    if (size > std::size(few_)) many_.resize(size);
  }
  operator std::span<double>() { return {many_.empty() ? few_ : many_.data(), size_}; }
  double& operator[](std::size_t i) { return many_.empty() ? few_[i] : many_[i]; }

 private:
  double few_[64];
  std::vector<double> many_;
  std::size_t size_;
};

}  // namespace

Independence::Independence(std::vector<Component> const& components, bool declared) : declared_(declared) {
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

/// A draw before its normal numbers: what it is of, and where they come from.
struct Independence::Planned {
  Part const* part;
  int before;  // normal numbers that its scale takes: the degrees of freedom, or none
  std::size_t axis;
  int lane;
  Stream stream;
};

Independence::Planned Independence::plan(StreamKey key, int lane) const {
  Stream stream(key);
  double const which = stream.uniform();
  Part const* part = &parts_.back();
  for (Part const& candidate : parts_)
    if (which < candidate.cumulative) {
      part = &candidate;
      break;
    }
  double const kind = stream.uniform();
  if (kind < normal_share) return {part, 0, 0, lane, stream};
  if (kind >= normal_share + axis_share) return {part, degrees, 0, lane, stream};
  auto const axis = static_cast<std::size_t>(stream.below(dimension_));
  return {part, axis_degrees, axis, lane, stream};
}

void Independence::draw(std::span<StreamKey const> keys, Lanes to) const {
  std::vector<Planned> all;
  for (std::size_t w = 0; w < keys.size(); ++w) all.push_back(plan(keys[w], static_cast<int>(w)));
  // Those that take equally many normal numbers draw them together, which is several times cheaper.
  for (int const before : {0, axis_degrees, degrees}) {
    std::vector<Planned const*> draws;
    std::vector<Stream> streams;
    for (Planned const& each : all) {
      if (each.before != before) continue;
      draws.push_back(&each);
      streams.push_back(each.stream);
    }
    LaneArray normals(before + static_cast<int>(dimension_), static_cast<int>(draws.size()));
    draw_normals(streams, normals);
    for (std::size_t d = 0; d < draws.size(); ++d) place(*draws[d], normals.view().columns(static_cast<int>(d), 1), to);
  }
}

void Independence::place(Planned const& draw, ConstLanes normals, Lanes to) const {
  // A standard normal over the root of chi-square / degrees has Student's t distribution: the scale is one over that root.
  double squares = 0;
  for (int i = 0; i < draw.before; ++i) squares += normals(i, 0) * normals(i, 0);
  double const scale = draw.before == 0 ? 1 : std::sqrt(draw.before / squares);
  bool const along_axis = draw.before == axis_degrees;
  Part const& part = *draw.part;
  int const lane = draw.lane;
  // Column after column, so that no copy of z is held.
  for (std::size_t i = 0; i < dimension_; ++i) to(static_cast<int>(i), lane) = part.mean[i];
  for (std::size_t j = 0; j < dimension_; ++j) {
    double const z = (along_axis ? 1 : scale) * normals(draw.before + static_cast<int>(j), 0);
    for (std::size_t i = j; i < dimension_; ++i) to(static_cast<int>(i), lane) += part.factor[i * dimension_ + j] * z;
  }
  if (!along_axis) return;
  double const z = (to(static_cast<int>(draw.axis), lane) - part.mean[draw.axis]) / part.sd[draw.axis];
  shift(part, draw.axis, (scale - 1) * z, to, lane);
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

double Independence::whiten(Part const& part, ConstLanes theta, int lane, std::span<double> z) const {
  double squares = 0;  // forward substitution
  for (std::size_t i = 0; i < dimension_; ++i) {
    double rest = theta(static_cast<int>(i), lane) - part.mean[i];
    double const* row = part.factor.data() + i * dimension_;
    for (std::size_t j = 0; j < i; ++j) rest -= row[j] * z[j];
    z[i] = rest / row[i];
    squares += z[i] * z[i];
  }
  return squares;
}

double Independence::log_normal(Part const& part, ConstLanes theta, int lane, std::span<double> z) const {
  double const log_density = part.log_normal - whiten(part, theta, lane, z) / 2;
  return std::isfinite(log_density) ? log_density : minus_infinity;
}

Independence::Part const& Independence::part_at(double share, ConstLanes theta, int lane) const {
  Scratch z(dimension_);
  double const log_limit = elementary::log(share) + log_normal_density(theta, lane);
  double sum = minus_infinity;
  for (Part const& part : parts_) {
    sum = log_of_sum(sum, log_normal(part, theta, lane, z));
    if (sum >= log_limit) return part;
  }
  return parts_.back();
}

double Independence::move_about(Stream& stream, double step, ConstLanes from, int chain, Lanes to, int lane) const {
  Part const& part = parts_.size() > 1 ? part_at(stream.uniform(), from, chain) : parts_.front();
  Scratch z(dimension_);
  whiten(part, from, chain, z);
  // sqrt(1 - b^2) - 1 without cancellation.
  double const shrink = -step * step / (1 + std::sqrt(std::max(0.0, 1 - step * step)));
  double jump = 0;
  for (std::size_t i = 0; i < dimension_; ++i) {
    to(static_cast<int>(i), lane) = from(static_cast<int>(i), chain);
    z[i] = shrink * z[i] + step * stream.normal();
    jump += z[i] * z[i];
  }
  for (std::size_t j = 0; j < dimension_; ++j)
    for (std::size_t i = j; i < dimension_; ++i) to(static_cast<int>(i), lane) += part.factor[i * dimension_ + j] * z[j];
  return jump;
}

double Independence::log_normal_density(ConstLanes theta, int lane) const {
  Scratch z(dimension_);
  double sum = minus_infinity;
  for (Part const& part : parts_) sum = log_of_sum(sum, log_normal(part, theta, lane, z));
  return sum;
}

void Independence::log_part(Part const& part, ConstLanes theta, std::span<double> out) const {
  int const width = theta.width();
  std::size_t const lanes = out.size();
  // z = L^-1 (x - mean) by forward substitution.
  LaneArray z(static_cast<int>(dimension_), width);
  std::vector<double> squares(lanes, 0.0), work(lanes);
  for (std::size_t i = 0; i < dimension_; ++i) {
    double const* const factor = part.factor.data() + i * dimension_;
    auto const x = theta.row(static_cast<int>(i));
    auto const rest = z.row(static_cast<int>(i));
    for (std::size_t w = 0; w < lanes; ++w) rest[w] = x[w] - part.mean[i];
    subtract_rows(rest.data(), z.view().data(), width, factor, static_cast<long>(i), width);
    for (std::size_t w = 0; w < lanes; ++w) {
      rest[w] /= factor[i];
      squares[w] += rest[w] * rest[w];
    }
  }
  // N (0.65 + 0.25 / P sum of ratios), the ratios after their largest: they overflow far out, where N vanishes.
  std::vector<double> highest(lanes, 0.0), sum(lanes, 0.0);
  for (std::size_t j = 0; j < dimension_; ++j) {
    auto const x = theta.row(static_cast<int>(j));
    auto const ratio = z.row(static_cast<int>(j));
    for (std::size_t w = 0; w < lanes; ++w) {
      ratio[w] = (x[w] - part.mean[j]) / part.sd[j];
      work[w] = ratio[w] * ratio[w] / axis_degrees;
    }
    elementary::log1p_lanes(work.data(), work.data(), width);
    for (std::size_t w = 0; w < lanes; ++w) {
      ratio[w] = log_axis_constant + ratio[w] * ratio[w] / 2 - 2 * work[w];
      highest[w] = std::max(highest[w], ratio[w]);
    }
  }
  for (std::size_t j = 0; j < dimension_; ++j) {
    auto const ratio = z.row(static_cast<int>(j));
    for (std::size_t w = 0; w < lanes; ++w) work[w] = ratio[w] - highest[w];
    elementary::exp_lanes(work.data(), work.data(), width);
    for (std::size_t w = 0; w < lanes; ++w) sum[w] += work[w];
  }
  for (std::size_t w = 0; w < lanes; ++w) work[w] = -highest[w];
  elementary::exp_lanes(work.data(), work.data(), width);
  for (std::size_t w = 0; w < lanes; ++w) work[w] = normal_share * work[w] + axis_share * sum[w] / static_cast<double>(dimension_);
  elementary::log_lanes(work.data(), work.data(), width);
  for (std::size_t w = 0; w < lanes; ++w) out[w] = part.log_normal - squares[w] / 2 + highest[w] + work[w];
  // Student's t in all directions.
  for (std::size_t w = 0; w < lanes; ++w) work[w] = squares[w] / degrees;
  elementary::log1p_lanes(work.data(), work.data(), width);
  for (std::size_t w = 0; w < lanes; ++w) work[w] = part.log_student - (degrees + static_cast<double>(dimension_)) / 2 * work[w];
  add_logs(out, work);
  for (std::size_t w = 0; w < lanes; ++w)
    if (!std::isfinite(squares[w])) out[w] = minus_infinity;
}

void Independence::log_density(ConstLanes theta, std::span<double> out) const {
  std::fill(out.begin(), out.end(), minus_infinity);
  std::vector<double> next(out.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (k == 0) {
      log_part(parts_[k], theta, out);
      continue;
    }
    log_part(parts_[k], theta, next);
    add_logs(out, next);
  }
}

double Independence::log_density(ConstLanes theta, int lane) const {
  double sum = 0;
  log_density(theta.columns(lane, 1), {&sum, 1});
  return sum;
}

int Independence::nearest(ConstLanes theta, int lane) const {
  int best = parts_.empty() ? -1 : 0;
  double highest = minus_infinity;
  for (std::size_t k = 0; parts_.size() > 1 && k < parts_.size(); ++k) {
    double here = 0;
    log_part(parts_[k], theta.columns(lane, 1), {&here, 1});
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
  return {{"declared", declared_}, {"parts", parts}};
}

Independence Independence::restore(nlohmann::json const& stored, int dimension) {
  Independence all;
  all.dimension_ = static_cast<std::size_t>(dimension);
  all.declared_ = stored.at("declared").get<bool>();
  for (nlohmann::json const& from : stored.at("parts")) {
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

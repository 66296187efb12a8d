// Leapfrog steps, and the parts of a trajectory that they are joined to.
#include "inference/nuts/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::nuts {
namespace {

/// A rise of the energy by which a state's share of the trajectory is nothing, whatever follows it.     Betancourt 2017; Stan
constexpr double divergence = 1000;

/// More than any trajectory takes: two for each of its states, of which there are 2^15.
constexpr int most_uniforms = 1 << 16;

double dot(std::vector<double> const& a, std::vector<double> const& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> plus(std::vector<double> a, std::vector<double> const& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

bool straight(std::vector<double> const& sum, std::vector<double> const& first, std::vector<double> const& last) {
  return dot(sum, first) > 0 && dot(sum, last) > 0;
}

/// Whether two neighbouring parts go straight on together: as a whole, and each with the nearest state of the other.
struct Side {
  std::vector<double> const &outer, &inner, &sum;  // momenta: of the end away from the other part, of the end beside it, of all
};
bool straight(Side const& a, Side const& b) {
  return straight(plus(a.sum, b.sum), a.outer, b.outer) && straight(plus(a.sum, b.inner), a.outer, b.inner) &&
         straight(plus(b.sum, a.inner), a.inner, b.outer);
}

std::vector<double> normal_momentum(StreamKey key, std::size_t dimension) {
  Stream stream({key.seed, Purpose::proposal, key.index, key.step});
  std::vector<double> momentum(dimension);
  for (double& r : momentum) r = stream.normal();
  return momentum;
}

StreamKey of_choices(StreamKey key) { return {key.seed, Purpose::accept, key.index, key.step}; }

}  // namespace

double Phase::energy() const { return 0.5 * dot(momentum, momentum) - at.log_density(); }

HalfStep begin_step(Phase const& from, Metric const& metric, double step) {
  std::size_t const n = from.momentum.size();
  HalfStep begun{std::vector<double>(n), std::vector<double>(n)};
  metric.force(from.at.gradient, begun.momentum);
  for (std::size_t i = 0; i < n; ++i) begun.momentum[i] = from.momentum[i] + 0.5 * step * begun.momentum[i];
  metric.velocity(begun.momentum, begun.theta);
  for (std::size_t i = 0; i < n; ++i) begun.theta[i] = from.at.theta[i] + step * begun.theta[i];
  return begun;
}

Phase end_step(HalfStep const& begun, Point at, Metric const& metric, double step) {
  Phase reached{std::move(at), std::vector<double>(begun.momentum.size())};
  metric.force(reached.at.gradient, reached.momentum);
  for (std::size_t i = 0; i < reached.momentum.size(); ++i)
    reached.momentum[i] = begun.momentum[i] + 0.5 * step * reached.momentum[i];
  return reached;
}

Trajectory::Trajectory(StreamKey key, Point start, Metric const& metric, double step, int most_doublings)
    : draw_(std::move(start)), most_doublings_(most_doublings), step_(step), stream_(of_choices(key)) {
  backward_ = {draw_, normal_momentum(key, draw_.theta.size())};
  forward_ = backward_;
  sum_ = forward_.momentum;
  start_energy_ = forward_.energy();
  begin_half(metric);
}

double Trajectory::uniform() {
  ++uniforms_;
  return stream_.uniform();
}

void Trajectory::begin_half(Metric const& metric) {
  is_forward_ = uniform() > 0.5;
  half_.clear();
  front_ = is_forward_ ? forward_ : backward_;
  begun_ = begin_step(front_, metric, directed_step());
}

void Trajectory::take(Point at, Metric const& metric) {
  Phase reached = end_step(begun_, std::move(at), metric, directed_step());
  ++leapfrogs_;
  double const rise = reached.energy() - start_energy_;
  if (!(rise <= divergence)) {  // not a number, too
    diverged_ = done_ = true;
    unsolved_ = !std::isfinite(reached.at.log_density());
    return;  // front_ is where the step began
  }
  acceptance_ += std::min(1.0, elementary::exp(-rise));
  front_ = std::move(reached);
  half_.push_back({0, front_.momentum, front_.momentum, front_.momentum, -rise, front_.at});
  while (half_.size() > 1 && half_[half_.size() - 2].depth == half_.back().depth)
    if (!join_parts()) {
      done_ = true;
      return;
    }
  if (half_.back().depth < depth_) {
    begun_ = begin_step(front_, metric, directed_step());
    return;
  }
  bool const on = join_half();
  cut_ = on && depth_ == most_doublings_;
  done_ = !on || cut_;
  if (!done_) begin_half(metric);
}

/// The last two parts of the half become one, or, where it turns back, the trajectory ends.
bool Trajectory::join_parts() {
  Part const second = std::move(half_.back());
  half_.pop_back();
  Part& first = half_.back();
  double const log_weight = log_of_sum(first.log_weight, second.log_weight);
  if (uniform() < elementary::exp(second.log_weight - log_weight)) first.draw = second.draw;
  bool const on = straight(Side{first.first, first.last, first.sum}, Side{second.last, second.first, second.sum});
  first.sum = plus(std::move(first.sum), second.sum);
  first.last = second.last;
  first.log_weight = log_weight;
  ++first.depth;
  return on;
}

/// The finished half joins the trajectory, which may then be drawn from it; returns whether the whole still goes straight on.
bool Trajectory::join_half() {
  Part& half = half_.back();
  if (uniform() < elementary::exp(std::min(0.0, half.log_weight - log_weight_))) {
    draw_ = std::move(half.draw);
    moved_ = true;
  }
  Phase& end = is_forward_ ? forward_ : backward_;
  Phase const& other = is_forward_ ? backward_ : forward_;
  bool const on = straight(Side{other.momentum, end.momentum, sum_}, Side{half.last, half.first, half.sum});
  end = front_;
  sum_ = plus(std::move(sum_), half.sum);
  log_weight_ = log_of_sum(log_weight_, half.log_weight);
  ++depth_;
  return on;
}

TrajectoryInfo Trajectory::info() const {
  return {leapfrogs_ > 0 ? acceptance_ / leapfrogs_ : 0,      leapfrogs_, moved_, diverged_, unsolved_, cut_,
          diverged_ ? front_.at.theta : std::vector<double>()};
}

void Trajectory::resume(StreamKey key, int dimension) {
  auto const whole = [&](std::vector<double> const& v) { return v.size() == static_cast<std::size_t>(dimension); };
  auto const known = [&](Point const& point) { return whole(point.theta) && whole(point.gradient); };
  auto const phase = [&](Phase const& each) { return known(each.at) && whole(each.momentum); };
  bool sound = phase(backward_) && phase(forward_) && phase(front_) && whole(sum_) && known(draw_) && whole(begun_.theta) &&
               whole(begun_.momentum);
  for (Part const& part : half_)
    sound = sound && whole(part.first) && whole(part.last) && whole(part.sum) && known(part.draw) && part.depth <= depth_;
  if (!sound || uniforms_ < 0 || uniforms_ > most_uniforms) throw checkpoint::Mismatch("its trajectories differ in dimension");
  stream_ = Stream(of_choices(key));
  for (int i = 0; i < uniforms_; ++i) stream_.uniform();
}

}  // namespace sysid::nuts

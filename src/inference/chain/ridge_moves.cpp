// Planes across a ridge, climbed together: every chain's next Newton step is a lane of one batch.
#include "inference/chain/ridge_moves.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/backend/checkpoint.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"

namespace sysid::metropolis {
namespace {

constexpr Eigen::Index most_long = 3;   // directions along
constexpr double shortest_long = 0.02;  // of the longest, for a direction to be one of them
constexpr double longest_along = 1;     // prior widths
constexpr double most_pull = 3;         // lengths, towards the top
constexpr int most_climb_rounds = 10;   // of Newton's method in a plane
constexpr double top_reached = 0.01;    // nats that a Newton step promises at the top
constexpr double length_spread = 1.5;   // of the steps' lengths, a factor to both sides
constexpr double best_ridge_acceptance = 0.35;
constexpr double parts_of_climb[] = {1, 0.5, 0.2, 0.05};

/// The density in prior widths.
class Landscape {
 public:
  Landscape(Target const& target, Eigen::VectorXd const& scale, Ledger& ledger)
      : objective_{target,
                   ObjectiveKind::posterior,
                   scale,
                   Eigen::VectorXd::Zero(scale.size()),
                   Eigen::VectorXd::Constant(scale.size(), -infinity),
                   Eigen::VectorXd::Constant(scale.size(), infinity),
                   Eigen::VectorXd::Constant(scale.size(), -infinity)},
        ledger_(ledger) {}

  std::vector<double> log_densities(std::vector<Eigen::VectorXd> points) const {
    if (points.empty()) return {};
    for (Eigen::VectorXd& point : points) point = point.cwiseProduct(objective_.scale);
    return objective_.log_density(to_lanes(points), ledger_);
  }
  std::vector<Slope> slopes(std::vector<Eigen::VectorXd> points) const {
    if (points.empty()) return {};
    Eigen::VectorXd const& s = objective_.scale;
    for (Eigen::VectorXd& point : points) point = point.cwiseProduct(s);
    std::vector<Slope> slopes;
    for (auto& [gradient, curvature] : slopes_at(objective_, points, ledger_)) {
      slopes.push_back({gradient.cwiseProduct(s), s.asDiagonal() * curvature * s.asDiagonal()});
      slopes.back().curvature.diagonal().array() += 1 / (longest_along * longest_along);
    }
    return slopes;
  }

 private:
  Objective objective_;
  Ledger& ledger_;
};

/// T, N, the lengths along T and the steps along it to where a quadratic density has its top, at a place.
struct Frame {
  Eigen::MatrixXd along, across;
  Eigen::VectorXd lengths, to_top;
  bool usable = false;

  /// The mean of t for moves of this length: of a normal density they keep the distribution, whatever the length up to 1.
  Eigen::VectorXd mean(double length) const {
    double const part = std::min(1.0, length);
    return (1 - std::sqrt(1 - part * part)) * to_top;
  }
};

Frame frame_of(Slope const& slope) {
  if (!slope.gradient.allFinite() || !slope.curvature.allFinite()) return {};
  auto const [values, vectors] = symmetric_eigen(slope.curvature);
  if (!values.allFinite() || !(values(0) > 0)) return {};
  Eigen::VectorXd const lengths = values.cwiseSqrt().cwiseInverse();
  Eigen::Index const dimension = lengths.size();
  Eigen::Index count = 1;
  while (count < std::min(most_long, dimension - 1) && lengths(count) > shortest_long * lengths(0)) ++count;
  Frame frame{vectors.leftCols(count), vectors.rightCols(dimension - count), lengths.head(count), {}, true};
  frame.to_top = (frame.along.transpose() * slope.gradient).cwiseProduct(frame.lengths.cwiseAbs2());
  frame.to_top = frame.to_top.cwiseMin(most_pull * frame.lengths).cwiseMax(-most_pull * frame.lengths);
  return frame;
}

/// Of a step t along a frame: the top of the plane across it, and the factor of the covariance of c there.
struct Plane {
  Eigen::VectorXd at;
  Eigen::MatrixXd const* across = nullptr;
  Eigen::MatrixXd factor;
  double log_density = 0;
  bool usable = true, done = false;
};

/// A Newton step of a plane, and whether there is more to gain.
Eigen::VectorXd newton_step(Slope const& slope, Plane& plane) {
  Eigen::MatrixXd const& across = *plane.across;
  Eigen::VectorXd const gradient = across.transpose() * slope.gradient;
  auto const factor = cholesky(across.transpose() * slope.curvature * across);
  if (!factor || !gradient.allFinite()) {
    plane.usable = false;
    plane.done = true;
    return {};
  }
  Eigen::MatrixXd const inverse = solve_cholesky(*factor, Eigen::MatrixXd::Identity(factor->rows(), factor->rows()));
  auto const spread = cholesky(inverse);
  plane.usable = spread.has_value();
  if (spread) plane.factor = *spread;
  Eigen::VectorXd const step = inverse * gradient;
  plane.done = !plane.usable || step.dot(gradient) < 2 * top_reached;
  return across * step;
}

void find_tops(Landscape const& landscape, std::vector<Plane>& planes) {
  std::vector<Eigen::VectorXd> starts;
  for (Plane const& plane : planes) starts.push_back(plane.at);
  std::vector<double> const at_start = landscape.log_densities(starts);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    planes[k].log_density = at_start[k];
    planes[k].usable = std::isfinite(at_start[k]);
    planes[k].done = !planes[k].usable;
  }
  for (int round = 0; round < most_climb_rounds; ++round) {
    std::vector<Plane*> climbing;
    std::vector<Eigen::VectorXd> places, trials;
    for (Plane& plane : planes)
      if (!plane.done) climbing.push_back(&plane), places.push_back(plane.at);
    if (climbing.empty()) return;
    std::vector<Slope> const slopes = landscape.slopes(places);
    std::vector<Plane*> trying;
    for (std::size_t k = 0; k < climbing.size(); ++k) {
      Eigen::VectorXd const step = newton_step(slopes[k], *climbing[k]);
      if (climbing[k]->done) continue;
      trying.push_back(climbing[k]);
      for (double const part : parts_of_climb) trials.push_back(climbing[k]->at + part * step);
    }
    std::vector<double> const reached = landscape.log_densities(trials);
    constexpr auto count = static_cast<std::ptrdiff_t>(std::size(parts_of_climb));
    for (std::size_t k = 0; k < trying.size(); ++k) {
      auto const first = reached.begin() + static_cast<std::ptrdiff_t>(k) * count, best = std::max_element(first, first + count);
      Plane& plane = *trying[k];
      if (!(*best > plane.log_density)) {
        plane.done = true;
        continue;
      }
      plane.log_density = *best;
      plane.at = trials[static_cast<std::size_t>(best - reached.begin())];
    }
  }
}

/// log of the density of a jump t, c whose lengths are those of a frame times `length`, squares = |z|^2 of c = L z; without the
/// constant that both ways share.
double log_of_jump(Frame const& frame, double length, Eigen::VectorXd const& t, Plane const& plane, double squares) {
  Eigen::VectorXd const mean = frame.mean(length);
  double sum = -squares / 2;
  for (Eigen::Index k = 0; k < t.size(); ++k) {
    double const l = length * frame.lengths(k), x = (t(k) - mean(k)) / l;
    sum -= x * x / 2 + elementary::log(l);
  }
  for (Eigen::Index k = 0; k < plane.factor.rows(); ++k) sum -= elementary::log(plane.factor(k, k));
  return sum;
}

/// What one chain proposes.
struct Jump {
  std::size_t chain = 0;
  Eigen::VectorXd from, to;
  double length = 1, log_forward = 0, log_reverse = -infinity;
};

std::vector<Frame> frames_at(Landscape const& landscape, std::vector<Eigen::VectorXd> const& places) {
  std::vector<Frame> frames;
  for (Slope const& slope : landscape.slopes(places)) frames.push_back(frame_of(slope));
  return frames;
}

/// Of every chain whose density can be followed.
std::vector<Jump> propose(Landscape const& landscape, std::vector<Eigen::VectorXd> const& states, StreamKey key,
                          double log_length) {
  std::vector<Frame> const frames = frames_at(landscape, states);
  std::vector<Jump> jumps;
  std::vector<Plane> planes;
  std::vector<Eigen::VectorXd> steps, normals;
  for (std::size_t w = 0; w < states.size(); ++w) {
    Frame const& frame = frames[w];
    if (!frame.usable) continue;
    Stream stream(key.with_index(key.index + w));
    double const length = elementary::exp(log_length + (2 * stream.uniform() - 1) * elementary::log(length_spread));
    Eigen::VectorXd t = frame.mean(length), z(frame.across.cols());
    for (Eigen::Index k = 0; k < t.size(); ++k) t(k) += length * frame.lengths(k) * stream.normal();
    for (double& each : z) each = stream.normal();
    planes.push_back({states[w] + frame.along * t, &frame.across, {}, 0});
    jumps.push_back({w, states[w], {}, length});
    steps.push_back(std::move(t));
    normals.push_back(std::move(z));
  }
  find_tops(landscape, planes);
  std::vector<Jump> usable;
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    if (!planes[k].usable) continue;
    Jump& jump = jumps[k];
    jump.to = planes[k].at + *planes[k].across * (planes[k].factor * normals[k]);
    jump.log_forward = log_of_jump(frames[jump.chain], jump.length, steps[k], planes[k], normals[k].squaredNorm());
    usable.push_back(std::move(jump));
  }
  return usable;
}

/// Sets the density of the way back, which is 0 where the density cannot be followed from there.
void look_back(Landscape const& landscape, std::vector<Jump>& jumps) {
  std::vector<Eigen::VectorXd> ends;
  for (Jump const& jump : jumps) ends.push_back(jump.to);
  std::vector<Frame> const frames = frames_at(landscape, ends);
  std::vector<Plane> planes;
  std::vector<Eigen::VectorXd> steps;
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    if (!frames[k].usable) continue;
    steps.push_back(frames[k].along.transpose() * (jumps[k].from - jumps[k].to));
    planes.push_back({jumps[k].to + frames[k].along * steps.back(), &frames[k].across, {}, 0});
    of.push_back(k);
  }
  find_tops(landscape, planes);
  for (std::size_t n = 0; n < planes.size(); ++n) {
    Plane const& plane = planes[n];
    Jump& jump = jumps[of[n]];
    if (!plane.usable) continue;
    Eigen::VectorXd const c = plane.across->transpose() * (jump.from - plane.at);
    jump.log_reverse = log_of_jump(frames[of[n]], jump.length, steps[n], plane, c.dot(solve_cholesky(plane.factor, c).col(0)));
  }
}

}  // namespace

Info RidgeMoves::step(Target const& target, StreamKey key, State& state, Ledger& ledger) const {
  Ledger spent;
  Landscape const landscape(target, scale_, spent);
  std::vector<Eigen::VectorXd> states;
  for (int w = 0; w < state.theta.width(); ++w) states.push_back(column(state.theta, w).cwiseQuotient(scale_));
  std::vector<Jump> jumps = propose(landscape, states, key, log_length_);
  look_back(landscape, jumps);
  Info info(states.size());
  for (Move& move : info) move.kind = MoveKind::ridge;
  if (!jumps.empty()) {
    std::vector<Eigen::VectorXd> ends;
    for (Jump const& jump : jumps) ends.push_back(jump.to.cwiseProduct(scale_));
    LaneArray const proposed = to_lanes(ends);
    std::vector<double> log_prior(jumps.size()), log_likelihood(jumps.size());
    target.log_prior(proposed, log_prior);
    target.log_likelihood(proposed, log_likelihood, spent);
    for (std::size_t k = 0; k < jumps.size(); ++k) {
      Jump const& jump = jumps[k];
      StreamKey const accept{key.seed, Purpose::accept, key.index + jump.chain, key.step};
      Move& move = info[jump.chain];
      move = decide(accept, state, jump.chain, proposed, static_cast<int>(k), log_prior[k], log_likelihood[k],
                    {.log_reverse = jump.log_reverse - jump.log_forward});
      move.kind = MoveKind::ridge;
    }
  }
  ledger.merge(spent);
  return info;
}

void RidgeMoves::learn(Info const& info) {
  ++steps_;
  double acceptance = 0;
  for (Move const& move : info) acceptance += move.acceptance_probability;
  log_length_ +=
      learning_gain(best_ridge_acceptance, steps_) * (acceptance / static_cast<double>(info.size()) - best_ridge_acceptance);
}

nlohmann::json RidgeMoves::store() const {
  std::vector<double> numbers{log_length_};
  numbers.insert(numbers.end(), scale_.begin(), scale_.end());
  return {{"numbers", checkpoint::encode(std::span<double const>(numbers))}, {"steps", steps_}};
}

RidgeMoves RidgeMoves::restore(nlohmann::json const& stored, int dimension) {
  std::vector<double> const numbers = checkpoint::decode(stored.at("numbers"));
  if (numbers.size() != 1 && numbers.size() != static_cast<std::size_t>(dimension) + 1)
    throw checkpoint::Mismatch("its moves along ridges differ in dimension");
  RidgeMoves all;
  all.log_length_ = numbers.front();
  all.scale_ = Eigen::Map<Eigen::VectorXd const>(numbers.data() + 1, static_cast<Eigen::Index>(numbers.size()) - 1);
  all.steps_ = stored.at("steps").get<std::uint64_t>();
  return all;
}

}  // namespace sysid::metropolis

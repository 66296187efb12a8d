// Densities and draws of a mixture, and its fit by expectation maximisation.
#include "inference/evidence/mixture.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"

namespace sysid::marginal {
namespace {

constexpr std::uint64_t centre_step = 1'000'000;  // of Purpose::evidence
constexpr int most_free = 16, most_rounds = 60;
constexpr double gained = 0.01;         // nats per draw that one more doubling must gain
constexpr double settled = 1e-4;        // nats per draw of a round of expectation maximisation
constexpr double least_student = 0.1;   // of a component's share
constexpr double least_of_mode = 0.02;  // share of a mode's component
constexpr double of_wide = 0.05;        // share of the component as wide as twice all draws

struct Moments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double weight = 0;
};

/// Weighted by `of_mean` [W]; the covariance is the sum of products over the sum of `counted` [W].
Moments weighted_moments(ConstLanes theta, std::span<double const> of_mean, std::span<double const> counted) {
  int const dimension = theta.rows();
  std::size_t const width = of_mean.size();
  Moments moments{Eigen::VectorXd::Zero(dimension), Eigen::MatrixXd::Zero(dimension, dimension), 0};
  double sum = 0;
  for (std::size_t w = 0; w < width; ++w) sum += of_mean[w], moments.weight += counted[w];
  LaneArray off(dimension, theta.width());
  std::vector<double> scaled(width);
  for (int i = 0; i < dimension; ++i) {
    auto const row = theta.row(i);
    double mean = 0;
    for (std::size_t w = 0; w < width; ++w) mean += of_mean[w] * row[w];
    moments.mean(i) = mean / sum;
    for (std::size_t w = 0; w < width; ++w) off.row(i)[w] = row[w] - moments.mean(i);
  }
  for (int i = 0; i < dimension; ++i) {
    for (std::size_t w = 0; w < width; ++w) scaled[w] = of_mean[w] * off.row(i)[w];
    for (int j = 0; j <= i; ++j) {
      auto const other = off.row(j);
      double product = 0;
      for (std::size_t w = 0; w < width; ++w) product += scaled[w] * other[w];
      moments.covariance(i, j) = moments.covariance(j, i) = product / moments.weight;
    }
  }
  return moments;
}

Moments moments_of(ConstLanes theta) {
  std::vector<double> const ones(static_cast<std::size_t>(theta.width()), 1.0);
  return weighted_moments(theta, ones, ones);
}

/// Expectation maximisation; fixed parts keep places and shapes.
class Maximisation {
 public:
  Maximisation(ConstLanes draws, Moments const& all) : draws_(draws), all_(all.covariance), least_(4.0 * (draws.rows() + 1)) {}

  Mixture run(Mixture mixture, std::function<bool()> const& stop) const {
    double before = -infinity;
    for (int round = 0; round < most_rounds && !(stop && stop()); ++round) {
      double reached = 0;
      Mixture next = step(mixture, reached);
      if (next.empty()) break;
      mixture = std::move(next);
      if (reached - before < settled) break;
      before = reached;
    }
    return mixture;
  }

 private:
  /// reached: mean log density of the draws before the step.
  Mixture step(Mixture const& mixture, double& reached) const {
    auto const count = static_cast<std::size_t>(draws_.width());
    LaneArray const terms = mixture.log_terms(draws_);
    std::vector<double> const density = mixture.log_density(terms), shares = mixture.log_shares();
    reached = 0;
    for (double const each : density) reached += each / static_cast<double>(count);
    std::vector<Mixture::Part> parts;
    double total = 0;
    for (std::size_t k = 0; k < mixture.parts().size(); ++k) {
      Mixture::Part const& part = mixture.parts()[k];
      std::vector<double> const of_normal = share_of(terms.row(static_cast<int>(2 * k)), shares[2 * k], density);
      std::vector<double> const of_student = share_of(terms.row(static_cast<int>(2 * k + 1)), shares[2 * k + 1], density);
      double normal = 0, student = 0;
      for (std::size_t w = 0; w < count; ++w) normal += of_normal[w], student += of_student[w];
      double sum = normal + student;
      if (part.fixed) {  // chains may miss a mode that the search has found
        sum = std::max(sum, least_of_mode * static_cast<double>(count));
        normal = sum - student;
      }
      if (!(part.fixed || sum > least_)) continue;  // what nothing belongs to goes
      student = std::max(student, least_student * sum);
      Component shape = part.fixed ? part.shape : moved(part.shape, of_normal, of_student);
      parts.push_back({std::move(shape), sum - student, student, part.fixed});
      total += sum;
    }
    if (parts.empty()) return {};
    for (Mixture::Part& part : parts) part.normal /= total, part.student /= total;
    return Mixture(std::move(parts));
  }

  static std::vector<double> share_of(std::span<double const> terms, double log_share, std::vector<double> const& density) {
    std::vector<double> out(density.size());
    for (std::size_t w = 0; w < out.size(); ++w) out[w] = log_share + terms[w] - density[w];
    elementary::exp_lanes(out.data(), out.data(), static_cast<int>(out.size()));
    return out;
  }

  /// Draws far out count less for the place and shape of a Student's t.
  Component moved(Component const& shape, std::vector<double> const& of_normal, std::vector<double> const& of_student) const {
    std::vector<double> const square = squared_lengths(shape.whitened(draws_));
    std::vector<double> of_mean(of_normal.size()), counted(of_normal.size());
    for (std::size_t w = 0; w < of_mean.size(); ++w) {
      counted[w] = of_normal[w] + of_student[w];
      of_mean[w] = of_normal[w] +
                   of_student[w] * (Component::freedom + static_cast<double>(draws_.rows())) / (Component::freedom + square[w]);
    }
    Moments const found = weighted_moments(draws_, of_mean, counted);
    constexpr double some = 1e-4;  // of the volume of all: repeated states of a chain span none
    return Component(found.mean, found.covariance + some / found.weight * all_);
  }

  ConstLanes draws_;
  Eigen::MatrixXd const& all_;
  double least_;  // draws that a component needs
};

/// Places among the draws that are far from each other in the widths of all (Arthur and Vassilvitskii 2007), and the draws nearest
/// to each as its first members.
std::vector<Mixture::Part> first_parts(ConstLanes draws, Moments const& all, int count, std::uint64_t seed) {
  auto const width = static_cast<std::size_t>(draws.width());
  if (count == 1) return {{Component(all.mean, all.covariance), 0.7, 0.3}};
  LaneArray const z = Component(all.mean, all.covariance).whitened(draws);
  Stream stream({seed, Purpose::evidence, static_cast<std::uint64_t>(count), centre_step});
  std::vector<double> nearest(width, infinity);
  std::vector<int> belongs(width, 0);
  std::size_t centre = stream.below(width);
  for (int k = 0; k < count; ++k) {
    double sum = 0;
    for (std::size_t w = 0; w < width; ++w) {
      double square = 0;
      for (int p = 0; p < z.rows(); ++p) {
        double const off = z.row(p)[w] - z.row(p)[centre];
        square += off * off;
      }
      if (square < nearest[w]) nearest[w] = square, belongs[w] = k;
      sum += nearest[w];
    }
    double rest = stream.uniform() * sum;
    for (centre = 0; centre + 1 < width && (rest -= nearest[centre]) > 0;) ++centre;
  }
  std::vector<Mixture::Part> parts;
  for (int k = 0; k < count; ++k) {
    std::vector<double> member(width);
    double size = 0;
    for (std::size_t w = 0; w < width; ++w) size += member[w] = belongs[w] == k ? 1 : 0;
    if (size < 2) continue;
    Moments const found = weighted_moments(draws, member, member);
    // A part of the shape of all keeps small clusters from collapsing before the first step.
    double const less = std::pow(count, -2.0 / draws.rows()), share = size / static_cast<double>(width);
    double const few = 1 / (1 + size / (2.0 * draws.rows()));
    parts.push_back({Component(found.mean, (1 - few) * found.covariance + few * less * all.covariance), 0.7 * share, 0.3 * share});
  }
  return parts;
}

std::vector<Mixture::Part> of_modes(std::vector<Component> const& modes, double share) {
  std::vector<Mixture::Part> parts;
  for (Component const& mode : modes) {
    double const each = share / static_cast<double>(modes.size());
    parts.push_back({mode, 0.8 * each, 0.2 * each, true});
  }
  return parts;
}

double mean_log_density(Mixture const& mixture, ConstLanes draws) {
  double sum = 0;
  for (double const each : mixture.log_density(mixture.log_terms(draws))) sum += std::max(each, -1e10);
  return sum / draws.width();
}

Mixture with_wide(Mixture const& mixture, Moments const& all) {
  std::vector<Mixture::Part> parts = mixture.parts();
  for (Mixture::Part& part : parts) part.normal *= 1 - of_wide, part.student *= 1 - of_wide;
  parts.push_back({Component(all.mean, 4 * all.covariance), 0, of_wide});
  return Mixture(std::move(parts));
}

/// Modes, and so many free components, fitted to the draws.
Mixture fitted(std::vector<Component> const& modes, int free, ConstLanes draws, Moments const& all, std::uint64_t seed,
               std::function<bool()> const& stop) {
  std::vector<Mixture::Part> parts = of_modes(modes, free == 0 ? 1 : 0.3);
  double const rest = modes.empty() ? 1 : 0.7;
  if (free > 0)
    for (Mixture::Part part : first_parts(draws, all, free, seed)) {
      part.normal *= rest, part.student *= rest;
      parts.push_back(std::move(part));
    }
  if (parts.empty()) return {};
  return Maximisation(draws, all).run(Mixture(std::move(parts)), stop);
}

}  // namespace

std::vector<double> Mixture::log_shares() const {
  std::vector<double> logs;
  for (Part const& part : parts_)
    for (double const share : {part.normal, part.student}) logs.push_back(share > 0 ? elementary::log(share) : -infinity);
  return logs;
}

LaneArray Mixture::log_terms(ConstLanes theta) const {
  constexpr int block = 512;  // whose whitened coordinates stay in the cache
  LaneArray terms(static_cast<int>(2 * parts_.size()), theta.width());
  for (int first = 0; first < theta.width(); first += block) {
    ConstLanes const columns = theta.columns(first, std::min(block, theta.width() - first));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      Component const& shape = parts_[k].shape;
      std::vector<double> const squares = squared_lengths(shape.whitened(columns));
      auto const here = [&](std::size_t row) {
        return terms.row(static_cast<int>(row)).subspan(static_cast<std::size_t>(first), squares.size());
      };
      shape.log_densities(squares, here(2 * k), here(2 * k + 1));
    }
  }
  return terms;
}

std::vector<double> Mixture::log_density(LaneArray const& log_terms) const {
  std::vector<double> const shares = log_shares();
  auto const width = static_cast<std::size_t>(log_terms.width());
  std::vector<double> highest(width, -infinity), sum(width, 0.0), work(width);
  for (int t = 0; t < log_terms.rows(); ++t)
    for (std::size_t w = 0; w < width; ++w)
      highest[w] = std::max(highest[w], shares[static_cast<std::size_t>(t)] + log_terms.row(t)[w]);
  for (int t = 0; t < log_terms.rows(); ++t) {
    if (shares[static_cast<std::size_t>(t)] == -infinity) continue;
    for (std::size_t w = 0; w < width; ++w) work[w] = shares[static_cast<std::size_t>(t)] + log_terms.row(t)[w] - highest[w];
    elementary::exp_lanes(work.data(), work.data(), log_terms.width());
    for (std::size_t w = 0; w < width; ++w) sum[w] += work[w];
  }
  elementary::log_lanes(sum.data(), work.data(), log_terms.width());
  for (std::size_t w = 0; w < width; ++w) work[w] = std::isfinite(highest[w]) ? highest[w] + work[w] : -infinity;
  return work;
}

void Mixture::draw(StreamKey key, Lanes to, int lane) const {
  Stream stream(key);
  double rest = stream.uniform();
  Part const* from = &parts_.back();
  bool student = from->student > 0;
  for (Part const& part : parts_) {
    if (rest < part.normal + part.student) {
      from = &part;
      student = rest >= part.normal;
      break;
    }
    rest -= part.normal + part.student;
  }
  Eigen::VectorXd const move = from->shape.move(stream, student);
  for (int p = 0; p < to.rows(); ++p) to(p, lane) = from->shape.centre(p) + move(p);
}

Mixture fit_mixture(std::vector<Component> const& modes, ConstLanes draws, std::uint64_t seed, std::function<bool()> const& stop) {
  int const count = draws.width(), fitting = count - count / 3;
  int const numbers = draws.rows() * (draws.rows() + 3) / 2;  // that a component has
  if (count < 8 * (draws.rows() + 1)) {
    if (modes.empty()) return {};
    return Mixture(of_modes(modes, 1));
  }
  ConstLanes const before = draws.columns(0, fitting), after = draws.columns(fitting, count - fitting);
  Moments const of_before = moments_of(before), of_all = moments_of(draws);
  int best = -1;
  double best_density = -infinity;
  for (int free = modes.empty() ? 1 : 0; free <= most_free; free = std::max(1, 2 * free)) {
    // As many draws as numbers leave a component too narrow: those that were not fitted tell.
    if (free > 1 && free * std::min(numbers, 8 * (draws.rows() + 1)) > fitting) break;
    Mixture const mixture = fitted(modes, free, before, of_before, seed, stop);
    if (mixture.empty()) continue;
    double const density = mean_log_density(with_wide(mixture, of_before), after);
    bool const better = density > best_density + gained;
    if (!better && free > 1) break;
    if (better) best = free, best_density = density;
  }
  if (best < 0) return {};
  return with_wide(fitted(modes, best, draws, of_all, seed, stop), of_all);
}

}  // namespace sysid::marginal

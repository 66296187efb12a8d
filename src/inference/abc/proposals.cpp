// Drawing a model, a particle and a move for each number; priors in lanes.
#include "inference/abc/proposals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"

namespace sysid::abc {
namespace {

/// Items of one task for a thread.
constexpr int chunk = 256;

/// Particles that are weighed between two looks at whether to stop.
constexpr int piece = 2048;

int index_of(std::vector<double> const& cumulative, double uniform) {
  auto const found = std::upper_bound(cumulative.begin(), cumulative.end(), uniform * cumulative.back());
  return static_cast<int>(std::min(found, cumulative.end() - 1) - cumulative.begin());
}

}  // namespace

std::vector<double> model_proposal(SelectionTarget const& candidates, Plan const& plan, Population const& last) {
  int const models = candidates.size();
  std::vector<double> q(static_cast<std::size_t>(models));
  auto const alive = [&](int m) { return last.number == 0 || last.models[static_cast<std::size_t>(m)].count() > 0; };
  int living = 0;
  for (int m = 0; m < models; ++m) living += alive(m) ? 1 : 0;
  double total = 0;
  for (int m = 0; m < models; ++m) {
    if (!alive(m)) continue;
    double& here = q[static_cast<std::size_t>(m)];
    if (last.number == 0 || !plan.from_previous || living == 1) {
      here = candidates.prior_probability(m);
    } else {
      double const own = last.models[static_cast<std::size_t>(m)].weight_sum();
      here = plan.stay * own + (1 - plan.stay) * (1 - own) / (living - 1);
    }
    total += here;
  }
  for (double& each : q) each /= total;
  return q;
}

Proposals::Proposals(SelectionTarget const& candidates, Plan const& plan, Walk const& walk, std::uint64_t seed,
                     Population const& last)
    : candidates_(candidates),
      walk_(walk),
      seed_(seed),
      last_(last),
      probability_(model_proposal(candidates, plan, last)),
      centres_(static_cast<std::size_t>(candidates.size())),
      within_(centres_.size()),
      cumulative_(centres_.size()),
      kernels_(centres_.size()) {
  if (last.number == 0) return;
  for (std::size_t m = 0; m < centres_.size(); ++m) {
    Particles const& particles = last.models[m];
    if (particles.count() == 0) continue;
    centres_[m] = particles.lanes(candidates.dimension(static_cast<int>(m)));
    double const sum = particles.weight_sum();
    double below = 0;
    for (double const w : particles.weight) {
      within_[m].push_back(w / sum);
      cumulative_[m].push_back(below += w / sum);
    }
    kernels_[m] = plan.kernel->make(plan, centres_[m], within_[m], last.widths[m]);
  }
}

int Proposals::draw_model(Stream& stream) const {
  double below = 0;
  double const uniform = stream.uniform();
  int chosen = 0;
  for (int m = 0; m < candidates_.size(); ++m) {
    if (probability_[static_cast<std::size_t>(m)] == 0) continue;
    chosen = m;
    if (uniform < (below += probability_[static_cast<std::size_t>(m)])) break;
  }
  return chosen;
}

Proposed Proposals::make(std::uint64_t first, int count) const {
  Proposed proposed;
  proposed.model.resize(static_cast<std::size_t>(count));
  proposed.column.resize(static_cast<std::size_t>(count));
  std::vector<std::vector<Stream>> streams(centres_.size());
  for (int i = 0; i < count; ++i) {
    Stream stream({seed_, Purpose::particle, first + static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(last_.number + 1)});
    int const model = draw_model(stream);
    proposed.model[static_cast<std::size_t>(i)] = model;
    std::vector<Stream>& of_model = streams[static_cast<std::size_t>(model)];
    proposed.column[static_cast<std::size_t>(i)] = static_cast<int>(of_model.size());
    of_model.push_back(stream);
  }
  for (std::size_t m = 0; m < streams.size(); ++m) {
    proposed.x.emplace_back(candidates_.dimension(static_cast<int>(m)), static_cast<int>(streams[m].size()));
    proposed.log_prior.emplace_back(streams[m].size());
  }
  proposed.theta = proposed.x;
  if (last_.number == 0)
    draw_from_prior(first, proposed);
  else
    move_particles(streams, proposed);
  rate(proposed);
  return proposed;
}

void Proposals::draw_from_prior(std::uint64_t first, Proposed& proposed) const {
  int const count = static_cast<int>(proposed.model.size());
  for (int m = 0; m < candidates_.size(); ++m) {
    LaneArray draws(candidates_.dimension(m), count);  // those of other models are left
    candidates_.sample_prior(m, {seed_, Purpose::prior, first, 1}, draws);
    for (int i = 0; i < count; ++i) {
      if (proposed.model[static_cast<std::size_t>(i)] != m) continue;
      for (int d = 0; d < draws.rows(); ++d)
        proposed.theta[static_cast<std::size_t>(m)](d, proposed.column[static_cast<std::size_t>(i)]) = draws(d, i);
    }
    LaneArray const& theta = proposed.theta[static_cast<std::size_t>(m)];
    walk_.from_theta(m, theta, proposed.x[static_cast<std::size_t>(m)]);
  }
}

void Proposals::move_particles(std::vector<std::vector<Stream>>& streams, Proposed& proposed) const {
  struct Piece {
    std::size_t model, first, count;
  };
  std::vector<Piece> pieces;
  for (std::size_t m = 0; m < streams.size(); ++m)
    for (std::size_t first = 0; first < streams[m].size(); first += chunk)
      pieces.push_back({m, first, std::min<std::size_t>(chunk, streams[m].size() - first)});
  candidates_.parallel(static_cast<int>(pieces.size()), [&](int task) {
    auto const [m, first, count] = pieces[static_cast<std::size_t>(task)];
    std::span<Stream> const own = std::span(streams[m]).subspan(first, count);
    std::vector<int> ancestors;
    for (Stream& stream : own) ancestors.push_back(index_of(cumulative_[m], stream.uniform()));
    kernels_[m]->perturb(ancestors, own, proposed.x[m].view().columns(static_cast<int>(first), static_cast<int>(count)));
  });
  for (std::size_t m = 0; m < centres_.size(); ++m) walk_.to_theta(static_cast<int>(m), proposed.x[m], proposed.theta[m]);
}

void Proposals::rate(Proposed& proposed) const {
  for (int m = 0; m < candidates_.size(); ++m) {
    std::vector<double>& log_prior = proposed.log_prior[static_cast<std::size_t>(m)];
    if (log_prior.empty()) continue;
    LaneArray const& theta = proposed.theta[static_cast<std::size_t>(m)];
    walk_.log_prior(m, proposed.x[static_cast<std::size_t>(m)], theta, log_prior);
    for (std::size_t w = 0; w < log_prior.size(); ++w) {
      bool inside = std::isfinite(log_prior[w]);
      for (int d = 0; d < theta.rows() && inside; ++d) inside = std::isfinite(theta(d, static_cast<int>(w)));
      if (!inside) log_prior[w] = -std::numeric_limits<double>::infinity();
    }
  }
}

std::vector<double> Proposals::log_weights(int model, ConstLanes x, std::span<double const> log_prior,
                                           std::function<bool()> const& stop) const {
  auto const m = static_cast<std::size_t>(model);
  std::vector<double> result(log_prior.size());
  for (int begin = 0; begin < x.width() && !(begin > 0 && stop && stop()); begin += piece) {
    int const end = std::min(x.width(), begin + piece);
    candidates_.parallel((end - begin + 63) / 64, [&](int task) {
      int const first = begin + task * 64, count = std::min(64, end - first);
      kernels_[m]->log_density(x.columns(first, count),
                               std::span(result).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)));
    });
  }
  double const factor = elementary::log(candidates_.prior_probability(model) / probability_[m]);
  for (std::size_t w = 0; w < result.size(); ++w) result[w] = factor + log_prior[w] - result[w];
  return result;
}

}  // namespace sysid::abc

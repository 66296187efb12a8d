// Derivatives of the response at prior draws, on solvers made finer until the derivatives no longer change.
#include <algorithm>
#include <cmath>

#include "app/preflight/preflight.hpp"

namespace sysid {
namespace {

constexpr double right_enough = 1e-2;         // change of a response, of its size, when the solver is refined: good for slopes
constexpr double converged = 1e-3;            // at the last refinement: neither unstable nor chaotic
constexpr double tolerable_roughness = 1e-3;  // error of the slopes as a part of them
constexpr std::size_t most_numbers = 1U << 23;

// A draw whose response an ever finer solver leaves where it is.
struct Converged {
  int lane;
  std::size_t level;       // the first solver whose response is right enough
  Eigen::MatrixXd errors;  // [R x solvers - 1] what each refinement changes, SI
  double moved;            // by the first: of a channel's response, the largest part of its sd
};

// The largest part of a slope that is not known; parameters without influence apart.
double roughness(Sensitivity const& s) {
  double worst = s.nuisance_error;
  for (Eigen::Index p = 0; p < s.error.size(); ++p)
    if (double const length = s.slopes.col(p).norm(); length > 3 * s.error(p)) worst = std::max(worst, s.error(p) / length);
  return worst;
}

std::vector<Converged> converge(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws) {
  int const rows = static_cast<int>(preflight.output().places().size());
  auto const refinements = static_cast<Eigen::Index>(preflight.solvers.size()) - 1;
  // Many at once fill the lanes; long records leave room for fewer.
  int const most = std::clamp(static_cast<int>(most_numbers / (static_cast<std::size_t>(rows) * preflight.solvers.size())), 1,
                              preflight.effort.candidates);
  int const width = std::min(most, static_cast<int>(draws.size()));
  LaneArray points(prior.points.rows(), width), before(rows, width), now(rows, width);
  std::vector<Converged> all;
  for (int w = 0; w < width; ++w) {
    all.push_back({draws[static_cast<std::size_t>(w)], preflight.solvers.size(), Eigen::MatrixXd(rows, refinements), 0});
    for (int r = 0; r < points.rows(); ++r) points(r, w) = prior.points(r, all.back().lane);
  }
  preflight.output().centres(points, before);
  std::vector<double> last(all.size());
  for (int w = 0; w < width && refinements == 0; ++w) {
    all[static_cast<std::size_t>(w)].level = 0;
    for (int r = 0; r < rows; ++r) last[static_cast<std::size_t>(w)] += 0 * before(r, w);  // NaN where a solve failed
  }
  for (std::size_t level = 0; level + 1 < preflight.solvers.size(); ++level) {
    preflight.output(level + 1).centres(points, now);
    for (int w = 0; w < width; ++w) {
      Converged& draw = all[static_cast<std::size_t>(w)];
      double& moved = last[static_cast<std::size_t>(w)];
      moved = 0;
      for (auto const& [first, end] : preflight.responses()) {
        double size = 0, change = 0, mean = 0;
        for (int r = first; r < end; ++r) mean += now(r, w) / (end - first);
        for (int r = first; r < end; ++r) {
          double const difference = now(r, w) - before(r, w);
          draw.errors(r, static_cast<Eigen::Index>(level)) = difference;
          change += difference * difference;
          size += (now(r, w) - mean) * (now(r, w) - mean);
        }
        double const part = change == 0 ? 0 : std::sqrt(change / size);  // NaN where a solve failed
        if (!(part <= moved)) moved = part;
      }
      if (level == 0) draw.moved = moved;
      if (last[static_cast<std::size_t>(w)] < right_enough) draw.level = std::min(draw.level, level);
    }
    std::swap(before, now);
  }
  std::vector<Converged> kept;
  for (std::size_t w = 0; w < all.size(); ++w)
    if (last[w] < converged) kept.push_back(std::move(all[w]));
  return kept;
}

// Slopes of the response in units of its noise; first states are nuisances. shift: mean square, in the same units, of what the
// first refinement changes.
LocalSlopes slopes_at(Preflight const& preflight, PriorDraws const& prior, Converged const& draw, double& shift) {
  // Slopes of adaptive steps need a tolerance far below the steps of their differences.
  std::size_t level = draw.level;
  while (!preflight.what.solver.fixed_step() && level + 1 < preflight.solvers.size() &&
         preflight.solvers[level].relative > Preflight::smooth_enough)
    ++level;
  Output const& output = preflight.output_on_jumps() != nullptr ? *preflight.output_on_jumps() : preflight.output(level);
  int const rows = static_cast<int>(output.places().size()), all = prior.points.rows();
  int const own = static_cast<int>(preflight.space->rows().size());
  LaneArray here(all, 1);
  for (int r = 0; r < all; ++r) here(r, 0) = prior.points(r, draw.lane);
  std::vector<double> const noise = output.noise(here), sizes = output.state_sizes(here);

  std::vector<int> moved;  // rows of the point
  std::vector<double> point, scale, spread;
  for (std::size_t k = 0; k < prior.coordinates.size(); ++k) {
    AssessedParameter const& coordinate = prior.coordinates[k];
    if (coordinate.role != ParameterRole::response) continue;
    moved.push_back(preflight.space->sampled()[k]);
    point.push_back(here(moved.back(), 0));
    scale.push_back(coordinate.relative ? std::abs(point.back()) : coordinate.spread);
    spread.push_back(coordinate.relative ? coordinate.spread : 1);
  }
  auto const asked = static_cast<Eigen::Index>(moved.size());
  LocalSlopes local;
  local.value = Eigen::Map<Eigen::VectorXd const>(point.data(), asked);
  local.scale = Eigen::Map<Eigen::VectorXd const>(scale.data(), asked);
  local.spread = Eigen::Map<Eigen::VectorXd const>(spread.data(), asked);
  for (int r = own; r < all; ++r) {
    double const size = std::max(sizes[static_cast<std::size_t>(r - own)], std::abs(here(r, 0)));
    moved.push_back(r);
    point.push_back(here(r, 0));
    scale.push_back(size > 0 ? size : 1);
  }
  Eigen::MatrixXd errors = draw.errors;
  for (int r = 0; r < rows; ++r) {
    if (!(noise[static_cast<std::size_t>(r)] > 0)) return local;
    errors.row(r) /= noise[static_cast<std::size_t>(r)];
  }
  if (errors.cols() > 0) shift = errors.col(0).squaredNorm() / rows;
  if (!(local.scale.array() > 0).all()) return local;
  auto const weighted = [&](ConstLanes points, Lanes out) {
    LaneArray whole(all, points.width());
    for (int r = 0; r < all; ++r)
      for (int w = 0; w < points.width(); ++w) whole(r, w) = here(r, 0);
    for (int i = 0; i < points.rows(); ++i)
      for (int w = 0; w < points.width(); ++w) whole(moved[static_cast<std::size_t>(i)], w) = points(i, w);
    output.centres(whole, out);
    for (int r = 0; r < rows; ++r)
      for (int w = 0; w < points.width(); ++w) out(r, w) /= noise[static_cast<std::size_t>(r)];
  };
  local.sensitivity = sensitivity(weighted, rows, point, scale, static_cast<int>(asked), errors);
  return local;
}

}  // namespace

std::vector<LocalResponse> local_responses(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws) {
  std::vector<LocalResponse> all;
  for (Converged const& draw : converge(preflight, prior, draws)) {
    if (static_cast<int>(all.size()) == preflight.effort.examined) break;
    LocalResponse here;
    here.slopes = slopes_at(preflight, prior, draw, here.shift);
    here.moved = draw.moved;
    if (here.slopes.sensitivity.finite && roughness(here.slopes.sensitivity) <= tolerable_roughness) all.push_back(std::move(here));
  }
  return all;
}

}  // namespace sysid

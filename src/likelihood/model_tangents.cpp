// Derivatives of a model's target by the tangents of its program: by the model's parameters there, by coordinates through the chain
// rule.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "likelihood/model_target_part.hpp"

namespace sysid {
namespace {

/// A value with its gradient by the adjoint, in simulations, roughly.
constexpr std::uint64_t adjoint_simulations = 4;

/// d/d coordinate has the term  d/d parameter * d parameter/d coordinate.
struct Link {
  Eigen::Index parameter;  // its position among those of the program
  int coordinate;
  int slope;  // row of ParameterSpace::slopes
};

std::vector<Link> links_of(ParameterSpace const& space, std::size_t experiment, std::vector<int> const& parameters) {
  std::vector<Link> links;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    int const row = space.row(static_cast<int>(experiment), parameters[k]);
    for (std::size_t s = 0; s < space.slopes().size(); ++s)
      if (space.slopes()[s].row == row)
        links.push_back({static_cast<Eigen::Index>(k), space.slopes()[s].coordinate, static_cast<int>(s)});
  }
  return links;
}

}  // namespace

Simulator const& ModelTarget::squares(std::size_t experiment) const {
  return parts_[experiment].squares.get([&] {
    std::shared_ptr<SimulationProgram const> const program = compiled_->squares();
    return Simulator(program, Schedule(*program, experiments_[experiment], options_.solver), options_.execution, pool_);
  });
}

void ModelTarget::log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, bool jacobian) const {
  if (!jacobian || !space_->log_prior_gradient(theta, out, gradient))
    return Target::log_prior_gradient(theta, out, gradient, jacobian);
  for (int w = 0; w < theta.width(); ++w) {
    bool finite = true;
    for (int p = 0; p < dimension(); ++p) finite = finite && std::isfinite(gradient(p, w));
    if (!finite)
      Target::log_prior_gradient(theta.columns(w, 1), out.subspan(static_cast<std::size_t>(w), 1), gradient.columns(w, 1), true);
    for (int p = 0; p < dimension() && !std::isfinite(out[static_cast<std::size_t>(w)]); ++p) gradient(p, w) = 0;
  }
}

Simulator const& ModelTarget::gradient(std::size_t experiment) const {
  return parts_[experiment].gradient.get([&] {
    std::shared_ptr<SimulationProgram const> const program = compiled_->gradient();
    return Simulator(program, Schedule(*program, experiments_[experiment], options_.solver), options_.execution, pool_);
  });
}

std::vector<int> ModelTarget::gradient_by_program(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const {
  std::vector<Columns> const columns = columns_of(theta);
  int const count = static_cast<int>(compiled_->gradient_by.size()), channels = static_cast<int>(compiled_->model.channels.size());
  std::vector<Run> runs(parts_.size());
  std::vector<Work> work;
  std::vector<std::vector<Link>> links;
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    ConstLanes const parameters = columns[e].parameters;
    Simulator const& simulator = this->gradient(e);
    runs[e].sums = LaneArray(simulator.program().sum_count(), parameters.width());
    runs[e].slopes = LaneArray(count, parameters.width());
    runs[e].outcome.resize(static_cast<std::size_t>(parameters.width()));
    work.push_back(compiled_->adjoint ? simulator.gradients_work(parameters, runs[e].sums, runs[e].slopes, runs[e].outcome)
                                      : simulator.sums_work(parameters, runs[e].sums, runs[e].outcome));
    links.push_back(links_of(*space_, e, compiled_->gradient_by));
  }
  do_work(work, pool_.get());
  LaneArray slopes(static_cast<int>(space_->slopes().size()), theta.width());
  space_->slopes(theta, slopes);
  std::vector<int> left;
  for (int w = 0; w < theta.width(); ++w) {
    double total = 0;
    bool good = true;
    for (int p = 0; p < dimension(); ++p) gradient(p, w) = 0;
    for (std::size_t e = 0; e < parts_.size() && good; ++e) {
      int const column = columns[e].of_lane[static_cast<std::size_t>(w)];
      good = runs[e].outcome[static_cast<std::size_t>(column)].ok;
      if (!good) break;
      SimulationProgram const& program = this->gradient(e).program();
      for (int c = 0; c < channels; ++c) total += runs[e].sums(program.sum_row(c, 0), column);
      for (Link const& each : links[e]) {
        int const k = static_cast<int>(each.parameter);
        double by = compiled_->adjoint ? runs[e].slopes(k, column) : 0;
        for (int c = 0; c < channels && !compiled_->adjoint; ++c) by += runs[e].sums(program.sum_row(c, 1 + k), column);
        gradient(each.coordinate, w) += by * slopes(each.slope, w);
      }
    }
    good = good && std::isfinite(total);
    for (int p = 0; p < dimension(); ++p) good = good && std::isfinite(gradient(p, w));
    out[static_cast<std::size_t>(w)] = total;
    if (!good) left.push_back(w);
  }
  std::uint64_t const each = compiled_->adjoint ? adjoint_simulations : 1 + static_cast<std::uint64_t>(count);
  for (Run const& run : runs)
    ledger.add_solves(each * static_cast<std::uint64_t>(std::ranges::count_if(run.outcome, &Outcome::ok)));
  return left;
}

void ModelTarget::take_squares(Simulator const& simulator, Run const& run, int column, Eigen::VectorXd& gradient,
                               Eigen::MatrixXd& curvature) const {
  auto const count = std::ssize(compiled_->differentiated);
  gradient.setZero(count);
  curvature.setZero(count, count);
  Eigen::VectorXd by_scale(count);
  for (int c = 0; c < static_cast<int>(compiled_->model.channels.size()); ++c) {
    int row = simulator.program().sum_row(c, 0);
    auto const next = [&] { return run.sums(row++, column); };
    double const scale = scale_residual(simulator.schedule().count(c), next());  // its derivative is -(that of the sum)/scale
    for (double& each : by_scale) each = next();
    for (double& each : gradient) each -= next();
    for (Eigen::Index k = 0; k < count; ++k)
      for (Eigen::Index l = 0; l <= k; ++l) curvature(k, l) += next();
    if (!(scale > 0)) continue;
    gradient += by_scale;
    curvature += (by_scale / scale) * (by_scale / scale).transpose();
  }
  for (Eigen::Index k = 0; k < count; ++k)
    for (Eigen::Index l = 0; l < k; ++l) curvature(l, k) = curvature(k, l);
}

std::vector<int> ModelTarget::squares_by_tangents(ConstLanes theta, Lanes gradient, Lanes curvature, Ledger& ledger) const {
  std::vector<Columns> const columns = columns_of(theta);
  std::vector<Run> runs(parts_.size());
  std::vector<Work> work;
  std::vector<std::vector<Link>> links;
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    ConstLanes const parameters = columns[e].parameters;
    runs[e].sums = LaneArray(squares(e).program().sum_count(), parameters.width());
    runs[e].outcome.resize(static_cast<std::size_t>(parameters.width()));
    work.push_back(squares(e).sums_work(parameters, runs[e].sums, runs[e].outcome));
    links.push_back(links_of(*space_, e, compiled_->differentiated));
  }
  do_work(work, pool_.get());
  LaneArray slopes(static_cast<int>(space_->slopes().size()), theta.width());
  space_->slopes(theta, slopes);
  for (Lanes const& each : {gradient, curvature})
    for (int r = 0; r < each.rows(); ++r) std::fill(each.row(r).begin(), each.row(r).end(), 0.0);
  std::vector<int> left;
  Eigen::VectorXd g;
  Eigen::MatrixXd h;
  for (int w = 0; w < theta.width(); ++w) {
    bool good = true;
    for (std::size_t e = 0; e < parts_.size() && good; ++e) {
      int const column = columns[e].of_lane[static_cast<std::size_t>(w)];
      good = runs[e].outcome[static_cast<std::size_t>(column)].ok;
      if (!good) break;
      take_squares(squares(e), runs[e], column, g, h);
      for (Link const& a : links[e]) {
        gradient(a.coordinate, w) += g(a.parameter) * slopes(a.slope, w);
        for (Link const& b : links[e])
          curvature(a.coordinate * dimension() + b.coordinate, w) +=
              h(a.parameter, b.parameter) * slopes(a.slope, w) * slopes(b.slope, w);
      }
    }
    for (Lanes const& each : {gradient, curvature})
      for (int r = 0; r < each.rows(); ++r) good = good && std::isfinite(each(r, w));
    if (!good) left.push_back(w);
  }
  // The derivatives by each parameter count as one more simulation.
  std::uint64_t const each = 1 + compiled_->differentiated.size();
  for (Run const& run : runs)
    ledger.add_solves(each * static_cast<std::uint64_t>(std::ranges::count_if(run.outcome, &Outcome::ok)));
  return left;
}

}  // namespace sysid

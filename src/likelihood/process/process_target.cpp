// Batches of parameter vectors through the parametric part, then one regression per vector and channel.
#include "likelihood/process/process_target.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "gaussian_process/regression.hpp"
#include "likelihood/failures.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

using gaussian_process::Marginal;

}  // namespace

/// The parametric part at a batch of vectors.
struct ProcessTarget::Batch {
  LaneArray covariance;                         // hyper-parameters and noise, SI
  std::vector<ProcessRecord::Records> records;  // by experiment
  bool good(int lane) const {
    return std::all_of(records.begin(), records.end(),
                       [&](ProcessRecord::Records const& each) { return each.outcome[static_cast<std::size_t>(lane)].ok; });
  }
};

ProcessTarget::~ProcessTarget() = default;

ProcessTarget::ProcessTarget(std::shared_ptr<ProcessModel const> model, std::shared_ptr<ParameterSpace const> space,
                             std::vector<Experiment> experiments, TargetOptions options)
    : model_(std::move(model)), space_(std::move(space)), options_(std::move(options)), pool_(make_pool(options_.execution)) {
  for (Experiment const& experiment : experiments)
    records_.emplace_back(model_, experiment, options_.solver, options_.start_rows, options_.execution, pool_);
  for (int c = 0; c < static_cast<int>(model_->channels().size()); ++c) {
    Eigen::VectorXd all(count(c));
    Eigen::Index next = 0;
    for (ProcessRecord const& record : records_) {
      Eigen::VectorXd const own = record.measured(c);
      all.segment(next, own.size()) = own;
      next += own.size();
    }
    measured_.push_back(std::move(all));
  }
}

int ProcessTarget::count(int channel) const {
  int total = 0;
  for (ProcessRecord const& record : records_) total += static_cast<int>(record.fitted(channel).size());
  return total;
}

bool ProcessTarget::stopped() const { return options_.execution.stopped != nullptr && options_.execution.stopped(); }

void ProcessTarget::leave_if_stopped() const {
  if (options_.execution.throws && stopped()) throw Interrupted();
}

ProcessTarget::Batch ProcessTarget::evaluate(ConstLanes theta) const {
  LaneArray const values = space_->values(theta);
  Batch batch;
  for (int e = 0; e < static_cast<int>(records_.size()); ++e) {
    LaneArray parameters(static_cast<int>(model_->model().parameters.size()), theta.width());
    space_->select(values, e, parameters);
    if (e == 0) batch.covariance = model_->parameters_of_covariance(parameters);
    batch.records.push_back(records_[static_cast<std::size_t>(e)].run(parameters));
  }
  return batch;
}

std::optional<ProcessTarget::Regression> ProcessTarget::regression(Batch const& batch, int channel, int lane,
                                                                   bool coefficients) const {
  ProcessChannel const& layout = model_->channels()[static_cast<std::size_t>(channel)];
  if (!batch.good(lane)) return std::nullopt;
  Regression result;
  for (int const output : layout.hyper_parameters) result.parameters.push_back(batch.covariance(output, lane));
  result.parameters.push_back(batch.covariance(layout.noise_sd, lane));
  for (double const value : result.parameters)
    if (!(value > 0) || !std::isfinite(value)) return std::nullopt;
  auto const rows = measured_[static_cast<std::size_t>(channel)].size();
  auto const p = static_cast<Eigen::Index>(coefficients ? layout.slopes.size() : 0);
  auto& observations = result.observations;
  observations.inputs.resize(rows, static_cast<Eigen::Index>(layout.arguments.size()));
  observations.values = measured_[static_cast<std::size_t>(channel)];
  observations.columns.resize(rows, p);
  observations.prior_mean.resize(p);
  observations.prior_sd.resize(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    observations.prior_mean[k] = layout.coefficients[static_cast<std::size_t>(k)].mean;
    observations.prior_sd[k] = layout.coefficients[static_cast<std::size_t>(k)].sd;
  }
  Eigen::Index next = 0;
  for (std::size_t e = 0; e < records_.size(); ++e) {
    ProcessRows const own = records_[e].rows(batch.records[e], channel, lane, records_[e].fitted(channel));
    Eigen::Index const size = own.parametric.size();
    observations.inputs.middleRows(next, size) = own.inputs;
    observations.values.segment(next, size) -= own.parametric;
    if (p > 0) {  // F was computed with the coefficients at the mean of their prior
      observations.columns.middleRows(next, size) = own.slopes;
      observations.values.segment(next, size) += own.slopes * observations.prior_mean;
    }
    next += size;
  }
  if (!observations.inputs.allFinite() || !observations.values.allFinite() || !observations.columns.allFinite())
    return std::nullopt;
  return result;
}

std::optional<ProcessTarget::Regression> ProcessTarget::regression(ConstLanes parameters, int channel, bool coefficients) const {
  Batch batch;
  for (int e = 0; e < static_cast<int>(records_.size()); ++e) {
    ConstLanes const own = parameters.columns(e, 1);
    if (e == 0) batch.covariance = model_->parameters_of_covariance(own);
    batch.records.push_back(records_[static_cast<std::size_t>(e)].run(own));
  }
  return regression(batch, channel, 0, coefficients);
}

Marginal ProcessTarget::marginal(Regression const& regression, int channel, bool with_gradient) const {
  auto const& covariance = model_->channels()[static_cast<std::size_t>(channel)].covariance;
  Marginal result = gaussian_process::marginal(covariance, regression.observations, regression.parameters, with_gradient);
  // A density is that of the declared unit.
  Channel const& declared = model_->model().channels[static_cast<std::size_t>(channel)];
  if (declared.unit)
    result.log_likelihood += static_cast<double>(regression.observations.values.size()) * elementary::log(declared.unit->scale);
  return result;
}

void ProcessTarget::record(Batch const& batch, ConstLanes theta, std::span<double const> values, Ledger& ledger) const {
  LaneArray declared(theta.rows(), theta.width());
  bool any = std::any_of(values.begin(), values.end(), [](double value) { return !std::isfinite(value); });
  for (int w = 0; w < theta.width(); ++w) any = any || !batch.good(w);
  if (any) constrain(theta, declared);
  auto const example = [&](int lane) {
    std::vector<double> out;
    for (int p = 0; p < declared.rows(); ++p) out.push_back(declared(p, lane));
    return out;
  };
  all_or_nothing(ledger, [&] {
    for (std::size_t e = 0; e < records_.size(); ++e)
      record_failures({records_[e].simulator(), batch.records[e].parameters, options_.start_rows > 0, {}}, batch.records[e].outcome,
                      options_.describe, example, ledger);
  });
  for (int w = 0; w < theta.width(); ++w)
    if (!std::isfinite(values[static_cast<std::size_t>(w)]) && batch.good(w))
      ledger.add_failure(FailureClass::non_finite, "the covariance of the Gaussian process", std::nan(""), example(w));
}

void ProcessTarget::log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const {
  Batch const batch = evaluate(theta);
  auto const one = [&](int w) {
    double total = 0;
    for (int c = 0; c < static_cast<int>(measured_.size()); ++c) {
      if (stopped()) return -infinity;
      auto const given = regression(batch, c, w, true);
      if (!given) return -infinity;
      Marginal const result = marginal(*given, c, false);
      if (result.outcome != gaussian_process::Outcome::fine || !std::isfinite(result.log_likelihood)) return -infinity;
      total += result.log_likelihood;
    }
    return total;
  };
  auto const task = [&](int w) { out[static_cast<std::size_t>(w)] = one(w); };
  if (pool_)
    pool_->run(theta.width(), task);
  else
    for (int w = 0; w < theta.width(); ++w) task(w);
  leave_if_stopped();
  record(batch, theta, out, ledger);
}

void ProcessTarget::log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const {
  for (int w = 0; w < theta.width(); ++w)
    out[static_cast<std::size_t>(w)] = gradient_at(theta.columns(w, 1), gradient.columns(w, 1), ledger);
}

double ProcessTarget::gradient_at(ConstLanes theta, Lanes gradient, Ledger& ledger) const {
  int const dimension = this->dimension(), width = 2 * dimension + 1;
  std::vector<double> const steps = difference_steps();
  auto const clear = [&] {
    for (int p = 0; p < dimension; ++p) gradient(p, 0) = 0;
  };
  clear();
  LaneArray const points = moved_lanes(theta, steps);
  Batch const batch = evaluate(points);
  // Neighbours are solves as good as any; a failure of the covariance is looked for at theta alone.
  auto const book = [&](double at_theta) {
    std::vector<double> values(static_cast<std::size_t>(width), 0.0);
    values[0] = at_theta;
    record(batch, points, values, ledger);
  };
  double total = 0;
  for (int c = 0; c < static_cast<int>(measured_.size()); ++c) {
    auto const centre = regression(batch, c, 0, true);
    Marginal result;
    if (centre) result = marginal(*centre, c, true);
    if (!centre || result.outcome != gaussian_process::Outcome::fine || !std::isfinite(result.log_likelihood)) {
      book(-infinity);
      clear();
      return -infinity;
    }
    total += result.log_likelihood;
    for (int p = 0; p < dimension && !stopped(); ++p) {
      auto const up = regression(batch, c, 2 * p + 1, true), down = regression(batch, c, 2 * p + 2, true);
      if (!up && !down) continue;
      // At the edge of what can be computed from the one side alone.
      Regression const &ahead = up ? *up : *centre, &behind = down ? *down : *centre;
      bool const inputs_move =
          ahead.observations.inputs != behind.observations.inputs || ahead.observations.columns != behind.observations.columns;
      double const apart = (up && down ? 2 : 1) * steps[static_cast<std::size_t>(p)];
      double slope = 0;
      if (inputs_move) {
        slope = (marginal(ahead, c, false).log_likelihood - marginal(behind, c, false).log_likelihood) / apart;
      } else {
        for (std::size_t k = 0; k < centre->parameters.size(); ++k)
          slope += result.gradient[static_cast<Eigen::Index>(k)] *
                   (elementary::log(ahead.parameters[k]) - elementary::log(behind.parameters[k])) / apart;
        slope += result.values_gradient.dot(ahead.observations.values - behind.observations.values) / apart;
      }
      if (std::isfinite(slope)) gradient(p, 0) += slope;
    }
  }
  leave_if_stopped();
  book(total);
  return total;
}

double ProcessTarget::measured_variance(int channel) const {
  Eigen::VectorXd const& y = measured_[static_cast<std::size_t>(channel)];
  return (y.array() - y.mean()).square().mean();
}

int ProcessTarget::residual_count() const { return 1; }

void ProcessTarget::residuals(ConstLanes theta, Lanes out, Ledger& ledger) const {
  std::vector<double> density(static_cast<std::size_t>(theta.width()));
  log_likelihood(theta, density, ledger);
  int rows = 0;
  for (Eigen::VectorXd const& each : measured_) rows += static_cast<int>(each.size());
  for (int w = 0; w < theta.width(); ++w) {
    double const value = density[static_cast<std::size_t>(w)];
    out(0, w) = std::isfinite(value) ? scale_residual(rows, value) : infinity;
  }
}

double ProcessTarget::roughness() const { return options_.roughness(model_->model()); }

}  // namespace sysid

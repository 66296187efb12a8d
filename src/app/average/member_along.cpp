// Trajectories by name and in common units, and rows that all members predict.
#include "app/average/member_along.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"

namespace sysid {
namespace {

/// value -> offset + slope value.
struct Conversion {
  double offset = 0, slope = 1;

  Conversion(Channel const& from, std::vector<Channel> const& units) {
    auto const to = std::find_if(units.begin(), units.end(), [&](Channel const& each) { return each.name == from.name; });
    if (to == units.end()) return;
    offset = to->from_si(from.to_si(0));
    slope = to->from_si(from.to_si(1)) - offset;
  }
  bool nothing() const { return offset == 0 && slope == 1; }
  void apply(std::vector<std::vector<double>>& trajectories) const {
    for (std::vector<double>& trajectory : trajectories)
      for (double& value : trajectory) value = offset + slope * value;
  }
};

std::string unit_of(std::string const& name, std::string const& own, std::vector<Channel> const& units) {
  for (Channel const& each : units)
    if (each.name == name && each.unit) return each.unit_text();
  return own;
}

/// Log of the mean over the draws that have a solution; -infinity where none gives the sample a density.
double log_mean_density(std::vector<std::vector<double>> const& log_density, std::size_t sample) {
  double largest = -infinity, sum = 0;
  int draws = 0;
  for (std::vector<double> const& each : log_density)
    if (!std::isnan(each[sample])) ++draws, largest = std::max(largest, each[sample]);
  if (draws == 0) return not_a_number;
  if (!std::isfinite(largest)) return largest;
  for (std::vector<double> const& each : log_density)
    if (!std::isnan(each[sample])) sum += elementary::exp(each[sample] - largest);
  return largest + elementary::log(sum / draws);
}

std::vector<double> log_densities(PointwiseLikelihood const& pointwise, std::vector<std::vector<double>> const& of_channel,
                                  int channel, std::size_t rows, double slope) {
  std::vector<double> out(rows, not_a_number);
  std::vector<int> const& samples = pointwise.samples(channel);
  for (std::size_t k = 0; k < samples.size(); ++k)
    out[static_cast<std::size_t>(samples[k])] = log_mean_density(of_channel, k) - elementary::log(std::fabs(slope));
  return out;
}

void add(Findings findings, MemberAlong& to) {
  for (Finding& each : findings) to.findings.push_back(std::move(each));
}

void cut(std::vector<double>& values, std::size_t first, std::size_t count) {
  if (values.empty()) return;
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  values.resize(count);
}

Experiment cut(Experiment experiment, std::size_t first, std::size_t count) {
  cut(experiment.time, first, count);
  for (InputSignal& input : experiment.inputs) input = input.view(static_cast<int>(first), static_cast<int>(count));
  for (std::vector<double>& channel : experiment.measured) cut(channel, first, count);
  experiment.scored.erase(experiment.scored.begin(), experiment.scored.begin() + static_cast<std::ptrdiff_t>(first));
  experiment.scored.resize(count);
  experiment.first_row += static_cast<int>(first);
  experiment.history.clear();
  experiment.has_lags.clear();
  return experiment;
}

}  // namespace

MemberAlong run_along(Session& session, PosteriorTrajectories const& member, int e, std::vector<Channel> const& units) {
  MemberAlong out;
  out.experiment = member.data()[static_cast<std::size_t>(e)].experiment;
  Trajectory const trajectory = member.trajectory(e);
  LaneArray const parameters = member.parameters(e);
  Trajectory::Result result = member.run(e, trajectory, parameters, true);
  add(check_ranges(member.model(), out.experiment, member.fitted().solver, member.start_rows(), parameters, session.abandonable()),
      out);
  if (!member.model().expansions.empty())
    add(check_reach(member.model(), member.fitted_runs(), {out.experiment, member.start_rows(), parameters}, member.fitted().solver,
                    session.abandonable()),
        out);
  add(drift_findings(session.source, member.model(), result, out.experiment.name), out);
  out.ledger = std::move(result.ledger);
  PointwiseLikelihood const pointwise = member.pointwise(e);
  auto const densities = pointwise.run(parameters);
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    TrajectoryQuantity const& from = trajectory.quantities()[q];
    MemberQuantity quantity{from.name, from.unit, from.channel >= 0, std::move(result.values[q]), {}, {}, {}, {}};
    if (from.channel >= 0) {
      auto const c = static_cast<std::size_t>(from.channel);
      Conversion const conversion(member.model().channels[c], units);
      quantity.noisy = std::move(result.noisy[c]);
      quantity.noise_mean = std::move(result.noise_mean[c]);
      quantity.noise_variance = std::move(result.noise_variance[c]);
      quantity.log_density = log_densities(pointwise, densities[c], from.channel, out.experiment.time.size(), conversion.slope);
      if (!conversion.nothing()) {
        quantity.unit = unit_of(from.name, from.unit, units);
        for (auto* each : {&quantity.values, &quantity.noisy, &quantity.noise_mean}) conversion.apply(*each);
        for (std::vector<double>& each : quantity.noise_variance)
          for (double& variance : each) variance *= conversion.slope * conversion.slope;
      }
    }
    out.quantities.push_back(std::move(quantity));
  }
  return out;
}

void cut_to_common_rows(std::vector<MemberAlong>& members) {
  int first = 0, end = std::numeric_limits<int>::max();
  for (MemberAlong const& each : members) {
    first = std::max(first, each.experiment.first_row);
    end = std::min(end, each.experiment.first_row + static_cast<int>(each.experiment.time.size()));
  }
  auto const count = static_cast<std::size_t>(std::max(0, end - first));
  for (MemberAlong& each : members) {
    auto const skipped = static_cast<std::size_t>(first - each.experiment.first_row);
    if (skipped == 0 && count == each.experiment.time.size()) continue;
    each.experiment = cut(std::move(each.experiment), skipped, count);
    for (MemberQuantity& quantity : each.quantities) {
      for (auto* all : {&quantity.values, &quantity.noisy, &quantity.noise_mean, &quantity.noise_variance})
        for (std::vector<double>& trajectory : *all) cut(trajectory, skipped, count);
      cut(quantity.log_density, skipped, count);
    }
  }
}

}  // namespace sysid

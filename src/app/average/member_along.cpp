// Trajectories by name and in common units, and rows that all members predict.
#include "app/average/member_along.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"

namespace sysid {
namespace {

template <class Quantities>
Quantity const* named(Quantities const& all, std::string const& name) {
  auto const found = std::find_if(all.begin(), all.end(), [&](Quantity const& each) { return each.name == name; });
  return found == all.end() ? nullptr : &*found;
}

Quantity const* quantity_of(Model const& model, std::string const& name, bool channel) {
  if (channel) return named(model.channels, name);
  Quantity const* const state = named(model.states, name);
  return state != nullptr ? state : named(model.derived, name);
}

/// Of one dimension, and not a temperature beside a difference of two; a quantity without a unit is a pure number.
bool comparable(Quantity const& one, Quantity const& other) {
  Unit const of_one = one.unit.value_or(Unit{}), of_other = other.unit.value_or(Unit{});
  return of_one.dimension == of_other.dimension && !zero_against_difference(of_one, of_other);
}

/// Log of the mean over the draws that are solved; -infinity where none gives the sample a density. A draw whose equations have no
/// value at the sample says that it is impossible.
double log_mean_density(std::vector<std::vector<double>> const& log_density, std::vector<char> const& solved, std::size_t sample) {
  std::vector<double> logs;
  for (std::size_t d = 0; d < log_density.size(); ++d)
    if (solved[d] != 0) logs.push_back(std::isnan(log_density[d][sample]) ? -infinity : log_density[d][sample]);
  return logs.empty() ? not_a_number : log_of_mean(logs);
}

std::vector<double> log_densities(PointwiseLikelihood const& pointwise, std::vector<std::vector<double>> const& of_channel,
                                  std::vector<char> const& solved, int channel, std::size_t rows, double slope) {
  std::vector<double> out(rows, not_a_number);
  std::vector<int> const& samples = pointwise.samples(channel);
  for (std::size_t k = 0; k < samples.size(); ++k)
    out[static_cast<std::size_t>(samples[k])] = log_mean_density(of_channel, solved, k) - elementary::log(std::fabs(slope));
  return out;
}

void add(Findings findings, MemberAlong& to) {
  for (Finding& each : findings) to.findings.push_back(std::move(each));
}

template <class Value>
void cut(std::vector<Value>& values, std::size_t first, std::size_t count) {
  if (values.empty()) return;
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  values.resize(count);
}

}  // namespace

MemberAlong run_along(Session& session, PosteriorTrajectories const& member, int e, Model const& units) {
  MemberAlong out;
  out.experiment = member.data()[static_cast<std::size_t>(e)].experiment;
  Trajectory const trajectory = member.trajectory(e);
  LaneArray const parameters = member.parameters(e);
  Trajectory::Result result = member.run(e, trajectory, parameters, true);
  add(check_ranges(member.model(), out.experiment, member.solver(), member.start_rows(), parameters, session.abandonable()), out);
  if (!member.model().expansions.empty())
    add(check_reach(member.model(), member.fitted_runs(), {out.experiment, member.start_rows(), parameters}, member.solver(),
                    session.abandonable()),
        out);
  add(drift_findings(session.source, member.model(), result, out.experiment.name), out);
  out.ledger = std::move(result.ledger);
  PointwiseLikelihood const pointwise = member.pointwise(e);
  auto const densities = pointwise.run(parameters);
  member.add_noise(e, trajectory, parameters, result);
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    TrajectoryQuantity const& from = trajectory.quantities()[q];
    bool const is_channel = from.channel >= 0;
    MemberQuantity quantity{from.name, from.unit, is_channel, true, result.drawn(q), {}, {}, {}, {}, {}};
    Quantity const* const own = quantity_of(member.model(), from.name, is_channel);
    Quantity const* to = quantity_of(units, from.name, is_channel);
    quantity.comparable = to != nullptr && comparable(*own, *to);
    if (!quantity.comparable) to = own;
    BetweenQuantities const conversion(*own, *to);
    quantity.unit = to->unit_of_numbers();
    conversion.apply(quantity.values);
    if (is_channel) {
      auto const c = static_cast<std::size_t>(from.channel);
      quantity.logarithmic = multiplies(*member.model().channels[c].noise.row);
      quantity.noisy = std::move(result.noisy[c]);
      quantity.noise_mean = std::move(result.noise_mean[c]);
      quantity.noise_variance = std::move(result.noise_variance[c]);
      quantity.log_density =
          log_densities(pointwise, densities[c], result.solved, from.channel, out.experiment.time.size(), conversion.slope());
      for (auto* each : {&quantity.noisy, &quantity.noise_mean}) conversion.apply(*each);
      for (std::vector<double>& each : quantity.noise_variance)
        for (double& variance : each) variance *= conversion.slope() * conversion.slope();
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
    each.experiment = slice(each.experiment, static_cast<int>(skipped), static_cast<int>(skipped + count));
    for (MemberQuantity& quantity : each.quantities) {
      for (auto* all : {&quantity.values, &quantity.noisy, &quantity.noise_mean, &quantity.noise_variance})
        for (std::vector<double>& trajectory : *all) cut(trajectory, skipped, count);
      cut(quantity.log_density, skipped, count);
    }
  }
}

}  // namespace sysid

// Which samples count, and the tests of the others.
#include "diagnostics/residuals/channel_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/statistics.hpp"
#include "diagnostics/residuals/outliers.hpp"
#include "diagnostics/residuals/start_far_off.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/experiment_words.hpp"

namespace sysid {

std::string ChannelResiduals::name() const { return described().name + on_experiment(data().name, experiments.size() > 1); }

std::vector<std::string> ChannelResiduals::names() const { return {described().name, data().name}; }

double ChannelResiduals::nmse_of(std::vector<double> const& some_observed, std::vector<double> const& some_predicted) const {
  return multiplies(*described().noise.row) ? nmse_of_logarithms(some_observed, some_predicted)
                                            : nmse(some_observed, some_predicted);
}

bool ChannelResiduals::noise_is_estimated() const {
  return std::any_of(described().noise.arguments.begin() + 1, described().noise.arguments.end(),
                     [&](NodeId argument) { return reads_estimated(model(), argument); });
}

int ChannelResiduals::fitted() const {
  return static_cast<int>(std::ranges::count_if(model().parameters, [](Parameter const& each) { return each.prior.has_value(); }));
}

char const* ChannelTests::first_cure() const {
  constexpr double useless = 80;  // nmse [%] that offset or trend leave, from which they are not what the fit lacks
  if (offset.fires && unexplained * (1 - offset.share) < useless)
    return "the misfit is mostly a constant: add the offset first (`residual_offset`)";
  if (trend.fires && unexplained * (1 - trend.share) < useless)
    return "the misfit is mostly a line in time: add the drift first (`residual_trend`)";
  return nullptr;
}

std::vector<double> without(std::vector<double> residuals, std::vector<std::size_t> const& places) {
  for (std::size_t const place : places) residuals[place] = std::nan("");
  return residuals;
}

namespace {

double error_at(ChannelResiduals const& of, std::size_t place) {
  auto const at = std::lower_bound(of.places.begin(), of.places.end(), place);
  if (at == of.places.end() || *at != place) return 0;
  auto const i = static_cast<std::size_t>(at - of.places.begin());
  return std::fabs(of.observed[i] - of.predicted[i]);
}

// A response that is missed is missed most where it is largest, but never at one sample alone.
std::vector<std::size_t> alone(ChannelResiduals const& of, std::vector<std::size_t> places) {
  constexpr double larger = 5;  // than its neighbours
  std::erase_if(places, [&](std::size_t place) {
    return error_at(of, place) < larger * std::max(place > 0 ? error_at(of, place - 1) : 0.0, error_at(of, place + 1));
  });
  return places;
}

// Single samples that do not belong; none of counts, where one is far from a small mean.
std::vector<std::size_t> far_off(ChannelResiduals const& of) {
  if (of.described().noise.row->discrete) return {};
  std::vector<std::size_t> const places = outliers(of.sized.values);
  bool const noise_besides = of.model().dynamics == Dynamics::none || !whiteness(without(of.residuals, places)).fires();
  return noise_besides ? places : alone(of, places);
}

// Single errors far from all others, whatever tails the noise has: of these alone the variance of a record may be.
std::vector<std::size_t> spikes(ChannelResiduals const& of) {
  std::vector<double> errors(of.data().time.size(), std::nan(""));
  std::vector<double> sizes;
  for (std::size_t const place : of.places) sizes.push_back(errors[place] = error_at(of, place));
  if (sizes.empty()) return {};
  double const middle = median(sizes);
  if (!(middle > 0)) return {};
  for (double& error : errors) error /= sd_of_mad * middle;
  return alone(of, outliers(errors));
}

// nmse [%] without `excluded`, places that rise.
double unexplained(ChannelResiduals const& of, std::vector<std::size_t> const& excluded) {
  std::vector<double> observed, predicted;
  for (std::size_t i = 0; i < of.observed.size(); ++i) {
    if (std::binary_search(excluded.begin(), excluded.end(), of.places[i])) continue;
    observed.push_back(of.observed[i]);
    predicted.push_back(of.predicted[i]);
  }
  return of.nmse_of(observed, predicted);
}

/// Measured minus predicted samples, without those far off, in the channel's declared unit.
struct Errors {
  std::vector<double> time, values;  // [s]
};
Errors errors_of(ChannelResiduals const& of, std::vector<std::size_t> const& far) {
  Errors errors;
  for (std::size_t i = 0; i < of.places.size(); ++i)
    if (!std::binary_search(far.begin(), far.end(), of.places[i])) {
      errors.time.push_back(of.data().time[of.places[i]]);
      errors.values.push_back(of.observed[i] - of.predicted[i]);
    }
  return errors;
}

Trend trend_of(ChannelResiduals const& of, Errors const& errors) {
  std::optional<Unit> const& unit = of.data().time_unit;
  Line const line = fitted_line(errors.time, errors.values);
  Trend trend;
  trend.slope = line.slope * (unit ? unit->scale : 1);
  trend.largest_slope = std::fabs(trend.slope);
  trend.largest_value =
      std::max({std::fabs(line.at(errors.time.front())), std::fabs(line.at(errors.time.back())), std::fabs(line.at_zero)});
  if (unit) trend.time_unit = unit->text;
  return trend;
}

}  // namespace

ChannelTests test_channel(ChannelResiduals const& of) {
  ChannelTests tested;
  tested.start = start_far_off(of);
  tested.far = far_off(of);
  tested.unexplained = unexplained(of, spikes(of));
  std::vector<double> residuals = without(of.residuals, tested.far);
  if (tested.start) {
    std::erase_if(tested.far, [](std::size_t place) { return place < samples_of_start; });
    std::fill_n(residuals.begin(), std::min(samples_of_start, residuals.size()), std::nan(""));
  }
  bool const ordered = of.model().dynamics != Dynamics::none;
  if (offset_can_be_added(of.model(), of.described())) {
    tested.offset = offset_test(residuals, ordered);
    if (!tested.offset.fires && of.model().dynamics == Dynamics::continuous) tested.trend = trend_test(residuals, of.data().time);
  }
  if (tested.offset.fires) tested.offset_size = mean(errors_of(of, tested.far).values);
  if (tested.trend.fires) tested.line = trend_of(of, errors_of(of, tested.far));
  if (!ordered) return tested;
  tested.white = whiteness(residuals);
  for (std::size_t i = 0; i < of.model().inputs.size(); ++i) {
    std::vector<double> input;
    for (std::size_t k = 0; k < of.data().time.size(); ++k) input.push_back(of.data().inputs[i].sample(static_cast<int>(k)));
    tested.with_input.push_back(input_correlation(residuals, input));
  }
  return tested;
}

}  // namespace sysid

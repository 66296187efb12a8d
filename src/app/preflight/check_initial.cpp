// Initial values beside the first measured samples, at all draws of the prior.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/preflight/preflight.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr double part_of_range = 0.5, noise_sds = 6;
constexpr std::size_t fewest_to_compare = 10, fewest_to_begin = 8;

/// Names of the states that a channel shows at its first sample.
std::vector<std::string> states_read(Model const& model, Channel const& channel) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < model.states.size(); ++s)
    if (model.graph.depends(channel.noise.arguments.front(), [&](Node const& node) {
          return node.operation == Operation::leaf && node.leaf_kind == LeafKind::state && node.index == static_cast<int>(s);
        }))
      names.push_back(model.states[s].name);
  return names;
}

/// The sd of white noise in a record that is smooth otherwise, by its second differences.
double noise_of(std::vector<double> const& samples) {
  std::vector<double> sizes;
  for (std::size_t i = 2; i < samples.size(); ++i) sizes.push_back(std::fabs(samples[i] - 2 * samples[i - 1] + samples[i - 2]));
  return sd_of_mad * median(sizes) / std::sqrt(6.0);
}

std::string cure(std::vector<std::string> const& states) {
  std::vector<std::string> initial;
  for (std::string const& state : states) initial.push_back("initial " + state);
  return fmt::format("check {} and {}; if it is not known, make it a parameter with a prior: `initial {} = START`", quoted(initial),
                     initial.size() == 1 ? "its unit" : "their units", states.front());
}

}  // namespace

void check_initial(Preflight const& preflight, PriorDraws const& prior) {
  Model const& model = preflight.model();
  if (!model.integrated() || model.filtered() || preflight.what.start.kind == StartRule::Kind::estimated) return;
  std::vector<Output::Place> const& places = preflight.output().places();
  for (auto const& [first, end] : preflight.responses()) {
    Output::Place const& place = places[static_cast<std::size_t>(first)];
    Channel const& channel = model.channels[static_cast<std::size_t>(place.channel)];
    std::vector<std::string> const states = states_read(model, channel);
    if (place.sample != 0 || states.empty() || channel.noise.row->discrete) continue;
    std::vector<double> samples;
    for (int r = first; r < end; ++r) samples.push_back(places[static_cast<std::size_t>(r)].measured);
    if (samples.size() < fewest_to_compare) continue;
    auto const [least, most] = std::ranges::minmax_element(samples);
    double nearest = std::numeric_limits<double>::infinity(), low = nearest, high = -nearest;
    std::size_t draws = 0;
    for (int w = 0; w < prior.simulations.centres.width(); ++w) {
      double const centre = prior.simulations.centres(first, w);
      if (!prior.simulations.followed[static_cast<std::size_t>(w)] || !std::isfinite(centre)) continue;
      ++draws;
      nearest = std::min(nearest, std::fabs(centre - place.measured));
      low = std::min(low, centre);
      high = std::max(high, centre);
    }
    bool const one_side = low > place.measured || high < place.measured;
    if (draws < fewest_to_begin || !one_side || !(nearest > part_of_range * (*most - *least)) ||
        !(nearest > noise_sds * noise_of(samples)) || !(std::fabs(samples[1] - samples[0]) < part_of_range * nearest))
      continue;
    std::string const unit = unit_after_number(channel.unit_text());
    std::string const begins =
        low == high ? significant(channel.from_si(low), 3) + unit
                    : fmt::format("{} to {}{}", significant(channel.from_si(low), 3), significant(channel.from_si(high), 3), unit);
    Experiment const& experiment = preflight.experiments[static_cast<std::size_t>(place.experiment)];
    preflight.add(FindingCode::initial_far_off, Severity::warning, {channel.name, experiment.name},
                  fmt::format("`{}` begins with {} = {}{}, but its first sample, row {} of {}, is {}{}", model.name, channel.name,
                              begins, low == high ? "" : " in all prior draws", experiment.first_row, experiment.name,
                              significant(channel.from_si(place.measured), 3), unit),
                  cure(states));
  }
}

}  // namespace sysid

// Initial values beside the first measured samples, at all draws of the prior.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "app/preflight/preflight.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/source.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr double part_of_range = 0.5, noise_sds = 6;
constexpr std::size_t fewest_to_compare = 10, fewest_to_begin = 8;

template <typename Wanted>
bool depends_on(Model const& model, NodeId on, Wanted const& wanted) {
  return model.graph.depends(on, [&](Node const& node) { return node.operation == Operation::leaf && wanted(node); });
}

/// The states that an expression reads.
std::vector<int> states_read(Model const& model, NodeId expression) {
  std::vector<int> states;
  for (int s = 0; s < static_cast<int>(model.states.size()); ++s)
    if (depends_on(model, expression, [&](Node const& node) { return node.leaf_kind == LeafKind::state && node.index == s; }))
      states.push_back(s);
  return states;
}

/// Names of the parameters with a prior that the expressions read.
std::vector<std::string> sampled_read(Model const& model, std::vector<NodeId> const& expressions) {
  std::vector<std::string> names;
  for (int p = 0; p < static_cast<int>(model.parameters.size()); ++p) {
    Parameter const& parameter = model.parameters[static_cast<std::size_t>(p)];
    bool const read = std::ranges::any_of(expressions, [&](NodeId expression) {
      return depends_on(model, expression,
                        [&](Node const& node) { return node.leaf_kind == LeafKind::parameter && node.index == p; });
    });
    if (parameter.prior && read) names.push_back(parameter.name);
  }
  return names;
}

/// The sd of white noise in a record that is smooth otherwise, by its second differences.
double noise_of(std::vector<double> const& samples) {
  std::vector<double> sizes;
  for (std::size_t i = 2; i < samples.size(); ++i) sizes.push_back(std::fabs(samples[i] - 2 * samples[i - 1] + samples[i - 2]));
  return sd_of_mad * median(sizes) / std::sqrt(6.0);
}

/// A new parameter as the initial value of a state: "declare `parameter v_start [m/s] ~ normal(11.9, sd = 2)` and write
/// `initial v = v_start`". first, width: of what a channel that is the state itself measures.
std::string as_parameter(Source const& source, State const& state, bool itself, double first, double width) {
  std::string name;
  for (char const each : state.name) name += each == '\'' ? std::string("_rate") : std::string(1, each);
  name += "_start";
  while (mentions(source, name)) name += "_2";
  std::string const prior = itself && width > 0 ? fmt::format("normal({}, sd = {})", significant(first, 3), significant(width, 1))
                                                : std::string("normal(MEAN, sd = SD)");
  return fmt::format("declare `parameter {} [{}] ~ {}` and write `initial {} = {}`", name, state.unit_text(), prior, state.name,
                     name);
}

std::string cure(Source const& source, Model const& model, Channel const& channel, std::vector<int> const& states, double first,
                 double width) {
  NodeId const location = channel.noise.arguments.front();
  std::vector<std::string> initial;
  std::vector<NodeId> expressions{location};
  for (int const s : states) {
    State const& state = model.states[static_cast<std::size_t>(s)];
    initial.push_back("initial " + state.name);
    expressions.push_back(state.initial);
  }
  std::vector<std::string> const sampled = sampled_read(model, expressions);
  std::string text = fmt::format("check {} and {}", quoted(initial), initial.size() == 1 ? "its unit" : "their units");
  if (!sampled.empty()) text += fmt::format(", and the {} of {}", plural("prior", sampled.size()), quoted(sampled));
  State const& state = model.states[static_cast<std::size_t>(states.front())];
  bool const own_name =
      state.unit && std::ranges::all_of(state.name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '\''; });
  if (own_name && sampled_read(model, {state.initial}).empty()) {
    Node const& node = model.graph[location];
    bool const itself = node.operation == Operation::leaf && node.leaf_kind == LeafKind::state && channel.unit &&
                        channel.unit->text == state.unit->text;
    text += "; if the initial value is not known, " + as_parameter(source, state, itself, first, width);
  }
  return text;
}

}  // namespace

void check_initial(Preflight const& preflight, PriorDraws const& prior) {
  Model const& model = preflight.model();
  if (!model.integrated() || model.filtered() || preflight.what.start.kind == StartRule::Kind::estimated) return;
  std::vector<Output::Place> const& places = preflight.output().places();
  for (auto const& [first, end] : preflight.responses()) {
    Output::Place const& place = places[static_cast<std::size_t>(first)];
    Channel const& channel = model.channels[static_cast<std::size_t>(place.channel)];
    NodeId const location = channel.noise.arguments.front();
    std::vector<int> const states = states_read(model, location);
    bool const driven = depends_on(model, location, [](Node const& node) { return node.leaf_kind == LeafKind::input; });
    if (place.sample != 0 || states.empty() || driven || channel.noise.row->discrete) continue;
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
                  cure(preflight.session.source, model, channel, states, channel.from_si(place.measured),
                       channel.from_si(part_of_range * (*most - *least))));
  }
}

}  // namespace sysid

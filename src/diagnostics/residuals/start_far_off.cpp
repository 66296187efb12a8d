// A fit whose states begin at rest takes the first motion for noise and for disturbance.
#include "diagnostics/residuals/start_far_off.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {
namespace {

/// States without a random or an estimated start that the location of a channel reads, and the rates of these.
std::vector<int> states_known_at_start(Model const& model, Channel const& channel) {
  std::vector<int> known;
  for (int s = 0; s < static_cast<int>(model.states.size()); ++s) {
    State const& state = model.states[static_cast<std::size_t>(s)];
    if (state.initial_variance || reads_estimated(model, state.initial)) continue;
    bool const read = model.graph.depends(channel.noise.arguments.front(), [&](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind == LeafKind::state && node.index == s;
    });
    if (read) known.push_back(s);
  }
  return known;
}

/// Whether the channel measures the state itself, in its unit.
bool measures(Model const& model, Channel const& channel, int s) {
  Node const& node = model.graph[channel.noise.arguments.front()];
  State const& state = model.states[static_cast<std::size_t>(s)];
  return node.operation == Operation::leaf && node.leaf_kind == LeafKind::state && node.index == s &&
         channel.unit_text() == state.unit_text();
}

}  // namespace

std::optional<double> start_far_off(ChannelResiduals const& of) {
  constexpr double far = 4.5;
  constexpr std::size_t fewest = 20;
  if (!of.model().filtered() || of.places.size() < fewest || of.places.front() >= samples_of_start) return std::nullopt;
  double const first = of.residuals[of.places.front()];
  if (!(std::fabs(first) > far) || states_known_at_start(of.model(), of.described()).empty()) return std::nullopt;
  return first;
}

Finding initial_of_states(ChannelResiduals const& of, double sds) {
  Model const& model = of.model();
  std::vector<int> const known = states_known_at_start(model, of.described());
  std::string help;
  std::vector<double> squares;
  for (double const value : of.observed) squares.push_back(value * value);
  for (int const s : known) {
    State const& state = model.states[static_cast<std::size_t>(s)];
    std::string sd = measures(model, of.described(), s) ? significant(std::sqrt(mean(squares)), 1) : "SD";
    if (state.unit) sd += fmt::format(" [{}]", state.unit_text());
    help += fmt::format("{}`initial {} ~ normal(0, sd = {})`", help.empty() ? "" : ", ", state.name, sd);
  }
  return {
      FindingCode::initial_far_off, Severity::warning, of.names(),
      fmt::format("the first sample of {}, row {}, lies {:.1f} sds from where the model begins: the record begins in motion, but "
                  "the model has known initial values",
                  of.name(), of.data().first_row + static_cast<int>(of.places.front()), std::fabs(sds)),
      fmt::format(
          "give the initial values a distribution as wide as the motion, {}, and do the same for the other initial values of "
          "this motion, above all its rates; do not empty the row: the misfit would only move to the next one",
          help)};
}

}  // namespace sysid

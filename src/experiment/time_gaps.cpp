// A recorder that was stopped leaves a gap, which the rule between input samples fills with values that nobody measured.
#include "experiment/time_gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/numeric/statistics.hpp"
#include "core/text/words.hpp"
#include "experiment/new_ranges.hpp"

namespace sysid {
namespace {

constexpr std::size_t enough_steps = 10;
constexpr double wide = 10, regular = 0.1, most_regular = 0.9;

struct Gaps {
  double usual = 0, longest = 0;  // [s]
  std::size_t at = 0;             // index of the row before the longest
  std::vector<std::size_t> all;   // of the row before each
};

std::optional<Gaps> gaps_of(std::vector<double> const& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  if (steps.size() < enough_steps) return std::nullopt;
  Gaps gaps;
  gaps.usual = median(steps);
  auto const alike =
      std::count_if(steps.begin(), steps.end(), [&](double each) { return std::fabs(each - gaps.usual) <= regular * gaps.usual; });
  if (static_cast<double>(alike) < most_regular * static_cast<double>(steps.size())) return std::nullopt;
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] > wide * gaps.usual) gaps.all.push_back(i);
  if (gaps.all.empty()) return std::nullopt;
  auto const longest = std::max_element(steps.begin(), steps.end());
  gaps.longest = *longest;
  gaps.at = static_cast<std::size_t>(longest - steps.begin());
  return gaps;
}

/// Ranges of rows of the file without a gap in them, of those that are scored; shorter ones are not worth a range.
std::vector<RowRange> rows_between(Gaps const& gaps, Experiment const& experiment, RowRange const& scored) {
  constexpr int fewest = 10;
  std::vector<RowRange> ranges;
  int first = scored.first;
  auto const close = [&](int last) {
    if (last - first + 1 >= fewest) ranges.push_back({first, last});
    first = std::max(first, last + 1);
  };
  for (std::size_t const gap : gaps.all) close(std::min(scored.last, experiment.first_row + static_cast<int>(gap)));
  close(scored.last);
  return ranges;
}

struct InitialValues {
  std::set<int> parameters;                // that some initial value reads
  bool all_free = true;                    // each reads some, none of which is read by anything else
  std::vector<std::string> shared, alone;  // of those that nothing else reads: not `per experiment`; all
};

InitialValues initial_values(Model const& model) {
  InitialValues values;
  std::vector<NodeId> others;
  for (State const& state : model.states) {
    bool reads = false;
    for (NodeId const id : model.graph.reachable(std::vector<NodeId>{state.initial})) {
      Node const& node = model.graph[id];
      if (node.operation != Operation::leaf || node.leaf_kind != LeafKind::parameter) continue;
      if (!model.parameters[static_cast<std::size_t>(node.index)].prior) continue;
      reads = true;
      values.parameters.insert(node.index);
    }
    values.all_free = values.all_free && reads;
    others.push_back(state.derivative);
  }
  for (Channel const& channel : model.channels)
    others.insert(others.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  std::set<int> elsewhere;
  for (NodeId const id : model.graph.reachable(others)) {
    Node const& node = model.graph[id];
    if (node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter) elsewhere.insert(node.index);
  }
  for (int const p : values.parameters) {
    Parameter const& parameter = model.parameters[static_cast<std::size_t>(p)];
    bool const alone = !elsewhere.contains(p);
    if (alone && !parameter.per_experiment) values.shared.push_back(parameter.name);
    if (alone) values.alone.push_back(parameter.name);
    values.all_free = values.all_free && (alone || parameter.per_experiment);
  }
  return values;
}

/// What makes the simulation of a range begin at its own first row. fewest: rows of the shortest range.
std::string start_words(Model const& model, int fewest) {
  std::string const at_record =
      "; with the default, `start = record`, a simulation begins at the first row of the file and goes through the gap";
  InitialValues const initial = initial_values(model);
  bool const may_estimate = model.invariants.empty() && !model.filtered();
  if (initial.all_free || !may_estimate) {
    std::vector<std::string> own;
    for (std::string const& name : initial.shared) own.push_back("parameter " + name + " per experiment");
    return fmt::format(" with `start = rest`{}{}",
                       own.empty() ? "" : fmt::format(" and {}, since each range has its own start", quoted(own)), at_record);
  }
  std::string const fixed = initial.alone.empty()
                                ? std::string()
                                : fmt::format(", and give {} a value (`=` in place of `~`), as the initial values are then fitted",
                                              quoted(initial.alone));
  return fmt::format(" with `start = estimated(rows = {})` (`start = rest` if the motion begins anew in each range){}{}",
                     std::clamp(fewest / 4, 2, 20), fixed, at_record);
}

std::string cure(DataBlock const& block, ExperimentData const& data, Gaps const& gaps, Model const& model) {
  constexpr std::size_t most_listed = 6;
  int const part = data.use.part;
  DataPart const* const old = part < 0 ? nullptr : &block.parts[static_cast<std::size_t>(part)];
  RowRange const scored{old == nullptr ? 1 : old->first, old == nullptr || old->last == 0 ? data.record.rows() : old->last};
  std::vector<RowRange> const ranges = rows_between(gaps, data.experiment, scored);
  int fewest = scored.last - scored.first + 1;
  for (RowRange const& each : ranges) fewest = std::min(fewest, each.last - each.first + 1);
  bool const from_first = ranges.size() == 1 && ranges.front().first <= data.experiment.first_row;
  std::string const start = model.states.empty() || from_first ? "" : start_words(model, fewest);
  std::string const name = data_name(block, part);
  if (ranges.size() == 1 && ranges.front().first == scored.first && ranges.front().last == scored.last)
    return fmt::format("fit to `{}`{}", name, start);
  if (ranges.empty() || ranges.size() > most_listed)
    return fmt::format("give the rows between gaps ranges of their own in `split` of `{}`, and fit to these{}", block.name, start);
  return new_ranges(block, part, ranges) + start;
}

}  // namespace

Findings find_time_gaps(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  if (model.dynamics != Dynamics::continuous) return {};
  Experiment const& experiment = data.experiment;
  auto const gaps = gaps_of(experiment.time);
  if (!gaps) return {};
  double const scale = experiment.time_unit ? experiment.time_unit->scale : 1;
  std::string const unit = experiment.time_unit ? experiment.time_unit->text : "s";
  int const row = experiment.first_row + static_cast<int>(gaps->at);
  std::string const others = gaps->all.size() > 1 ? fmt::format(" (and {} more)", gaps->all.size() - 1) : "";
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  return {{FindingCode::time_gap,
           Severity::warning,
           {experiment.name},
           fmt::format("the time of {} has a gap of {:.3g} {} between rows {} and {}{}; the usual step is {:.3g} {}",
                       experiment.name, gaps->longest / scale, unit, row, row + 1, others, gaps->usual / scale, unit),
           (model.inputs.empty() ? "the simulation continues through the gap; if the recording was restarted there, "
                                 : "the input during the gap is unknown: ") +
               cure(block, data, *gaps, model)}};
}

}  // namespace sysid

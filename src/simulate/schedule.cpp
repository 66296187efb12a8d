// Tables of uniforms: raw data leaves in, one row per step or sample out, by the same kernels that serve lanes.
#include "simulate/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/numeric/lanes.hpp"
#include "core/text/diagnostic.hpp"
#include "program/embedded.hpp"

namespace sysid {
namespace {

constexpr int rows_at_once = 4096;

std::size_t measured_channels(SimulationSource const& source) {
  return static_cast<std::size_t>(std::ranges::count_if(source.channels, [](ChannelSource const& each) { return !each.always; }));
}

bool suits_exact_steps(Experiment const& experiment) {
  return std::ranges::all_of(experiment.inputs, [](InputSignal const& each) { return each.degree() <= 1; });
}

/// Of a method that computes nothing from the length of a step, what reads a length reads the mean.
StepLengths lengths_of(Experiment const& experiment, SolverSettings const& solver) {
  std::size_t const samples = experiment.time.size();
  if (solver.row().exact) return step_lengths(experiment.time);
  return {{samples > 1 ? mean_step(experiment.time) : 0},
          std::vector<int>(samples),
          std::vector<int>(samples, static_cast<int>(samples))};
}

}  // namespace

Schedule::Schedule(SimulationProgram const& program, Experiment const& experiment, SolverSettings const& solver)
    : experiment_(experiment),
      solver_(solver),
      lengths_(lengths_of(experiment, solver)),
      map_(program.source.map && !program.source.stepped) {
  std::size_t const channels = program.source.channels.size();
  if (solver.substeps < 1 || (map_ && solver.substeps > 1) || solver.method != program.source.integrator ||
      static_cast<int>(experiment.inputs.size()) < program.source.inputs ||
      experiment.measured.size() < measured_channels(program.source))
    throw InternalError("the experiment does not fit the program");

  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<std::uint8_t> summed(experiment.time.size());
    int count = 0;
    for (std::size_t i = 0; i < summed.size(); ++i) {
      bool const always = program.source.channels[c].always;
      summed[i] = always || experiment.is_scored(c, i) ? 1 : 0;
      if (always || summed[i] == 0) continue;
      ++count;
      last_summed_ = std::max(last_summed_, static_cast<int>(i) + 1);
    }
    summed_.push_back(std::move(summed));
    counts_.push_back(count);
  }

  if (solver.row().exact && !map_ && (solver.substeps > 1 || !suits_exact_steps(experiment)))
    throw InternalError("an exact step along samples that it does not suit");
  prologue_ = tabulate_lengths(program.prologue.uniforms);
  start_ = tabulate_samples(program.start.uniforms, 1);
  carry_ = tabulate_samples(program.carry.uniforms, samples());
  // An embedded method finds its own steps: its rows belong to whole intervals.
  if (solver.row().in_program) steps_ = tabulate_steps(program.step.uniforms);
  records_ = tabulate_samples(program.record.uniforms, samples());
  records_after_ = tabulate_samples(program.record_after.uniforms, samples());
  for (Section const& observe : program.observe) observe_.push_back(tabulate_samples(observe.uniforms, samples()));

  if (!program.source.adjoint_by.empty()) {
    reverse_steps_ = tabulate_steps(program.reverse.step.uniforms);
    for (Section const& observe : program.reverse.observe)
      reverse_observe_.push_back(tabulate_samples(observe.uniforms, samples()));
    reverse_start_ = tabulate_samples(program.reverse.start.uniforms, 1);
    reverse_values_ = tabulate_lengths(program.reverse.values.uniforms);
  }

  for (int const count : counts_) epilogue_.push_back(count);
  for (std::size_t c = 0; c < channels; ++c) {
    UniformRows const terms = tabulate_samples(program.data_sums[c], samples());
    std::vector<double> sums(static_cast<std::size_t>(terms.width));
    for (int i = 0; i < samples(); ++i)
      for (std::size_t k = 0; k < sums.size() && summed(static_cast<int>(c), i); ++k) sums[k] += terms.row(i)[k];
    epilogue_.insert(epilogue_.end(), sums.begin(), sums.end());
  }
}

bool Schedule::summed(int channel, int sample) const {
  return summed_[static_cast<std::size_t>(channel)][static_cast<std::size_t>(sample)] != 0;
}

int Schedule::count(int channel) const { return counts_[static_cast<std::size_t>(channel)]; }

std::vector<double> Schedule::counts(int from, int to) const {
  std::vector<double> result;
  for (std::vector<std::uint8_t> const& each : summed_)
    result.push_back(static_cast<double>(std::count(each.begin() + from, each.begin() + to, std::uint8_t{1})));
  return result;
}

int Schedule::without_gaps() const {
  int first = last_summed_;
  while (first > 0 &&
         std::ranges::all_of(summed_, [&](auto const& each) { return each[static_cast<std::size_t>(first - 1)] == 1; }))
    --first;
  return first;
}

bool Schedule::jumps(int sample) const {
  if (sample == 0) return true;
  for (InputSignal const& signal : experiment_.inputs) {
    InputRuleRow const& rule = row_of(signal.rule());
    if (rule.jumps && signal.value(sample - 1, 1) != signal.value(sample, 0)) return true;
    if (rule.kinks && signal.rate(sample - 1, 1) != signal.rate(sample, 0)) return true;
  }
  return false;
}

double Schedule::at_step(UniformLeaf const& leaf, int sample, int substep) const {
  if (map_) return at_sample(leaf, sample);
  double const place = leaf.stage == Stage::begin ? 0 : leaf.stage == Stage::middle ? 0.5 : 1;
  double const s = (substep + place) / solver_.substeps;
  double const interval = time(sample + 1) - time(sample);
  switch (leaf.kind) {
    case LeafKind::input:
      return experiment_.inputs[static_cast<std::size_t>(leaf.index)].value(sample, s, place == 1);
    case LeafKind::input_rate:
      return experiment_.inputs[static_cast<std::size_t>(leaf.index)].rate(sample, s);
    case LeafKind::time:
      return time(sample) + s * interval;
    case LeafKind::step_size:
      return interval / solver_.substeps;
    case LeafKind::step_length:
      return length_of_step(sample);
    case LeafKind::coefficient: {
      InputSignal const& input = experiment_.inputs[static_cast<std::size_t>(leaf.index / (largest_input_degree + 1))];
      auto const power = static_cast<std::size_t>(leaf.index % (largest_input_degree + 1));
      std::span<double const> const coefficients = input.coefficients(sample);
      if (coefficients.size() > largest_input_degree + 1) throw InternalError("an input's polynomial is of too high a degree");
      return power < coefficients.size() ? coefficients[power] : 0;
    }
    case LeafKind::interval:
      switch (static_cast<IntervalData>(leaf.index)) {
        case IntervalData::begin:
          return time(sample);
        case IntervalData::length:
          return interval;
        case IntervalData::relative:
          return solver_.relative;
        case IntervalData::absolute:
          return solver_.absolute;
      }
      throw InternalError("step control reads what there is not");
    default:
      throw InternalError("a step reads what only a sample has");
  }
}

double Schedule::at_sample(UniformLeaf const& leaf, int sample) const {
  bool const last = sample + 1 == samples();
  int const row = sample - leaf.lag;
  switch (leaf.kind) {
    case LeafKind::input: {
      InputSignal const& signal = experiment_.inputs[static_cast<std::size_t>(leaf.index)];
      return signal.earlier() + row < 0 ? std::nan("") : signal.sample(row);  // nothing is known of what was before the record
    }
    case LeafKind::input_rate:
      return experiment_.inputs[static_cast<std::size_t>(leaf.index)].rate(last ? sample - 1 : sample, last ? 1 : 0);
    case LeafKind::time:
      return row >= 0 ? time(row) : time(0) + row * (time(1) - time(0));
    case LeafKind::step_length:
      return length_of_step(sample);
    case LeafKind::measured:
      return measured_sample(experiment_, leaf.index, row);
    default:
      throw InternalError("a sample reads what only a step has");
  }
}

UniformRows Schedule::tabulate_steps(UniformTable const& table) const {
  std::int64_t const steps = std::int64_t{samples() - 1} * solver_.substeps;
  if (steps > std::numeric_limits<int>::max())
    throw UserError(
        {Severity::error,
         "E5003",
         fmt::format("{} samples with {} steps between them are more steps than a simulation counts", samples(), solver_.substeps),
         std::nullopt,
         {},
         "use fewer samples, or a smaller value of `substeps`"});
  return tabulate(table, static_cast<int>(steps), [this](UniformLeaf const& leaf, int row) {
    return at_step(leaf, row / solver_.substeps, row % solver_.substeps);
  });
}

UniformRows Schedule::tabulate_samples(UniformTable const& table, int rows) const {
  return tabulate(table, rows, [this](UniformLeaf const& leaf, int row) { return at_sample(leaf, row); });
}

UniformRows Schedule::tabulate_lengths(UniformTable const& table) const {
  return tabulate(table, lengths_.count(), [this](UniformLeaf const& leaf, int row) {
    if (leaf.kind != LeafKind::step_length) throw InternalError("what is computed before the first step reads data");
    return lengths_.values[static_cast<std::size_t>(row)];
  });
}

UniformRows Schedule::tabulate(UniformTable const& table, int rows, ValueOf const& value_of) {
  int const width = table.kernel.outputs;
  UniformRows result{width, std::vector<double>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width))};
  if (width == 0) return result;
  // A few thousand rows at a time: of a long record the whole would be written to fresh memory three times, which takes longer than
  // the arithmetic.
  for (int first = 0; first < rows; first += rows_at_once) {
    int const count = std::min(rows_at_once, rows - first);
    LaneArray leaves(table.kernel.inputs, count), values(width, count);
    for (int k = 0; k < table.kernel.inputs; ++k) {
      UniformLeaf const& leaf = table.leaves[static_cast<std::size_t>(k)];
      for (int r = 0; r < count; ++r) leaves(k, r) = value_of(leaf, first + r);
    }
    run(table.kernel, leaves, values);
    double* row = result.values.data() + static_cast<std::size_t>(first) * static_cast<std::size_t>(width);
    for (int r = 0; r < count; ++r, row += width)
      for (int k = 0; k < width; ++k) row[k] = values(k, r);
  }
  return result;
}

}  // namespace sysid

// What the record noted when it was read, in words.
#include "experiment/doubtful_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/text/number.hpp"
#include "data/table/reading_rules.hpp"
#include "experiment/record_request.hpp"

namespace sysid {

namespace {

std::string cure_of(UnitInName const& found) {
  if (found.of_file) return "check that this is the column of the right quantity; if it is, the unit in the file is wrong";
  std::string const named = column_text(found.column, found.in_name), read = column_text(found.column, found.read_in);
  if (found.cycles)
    return fmt::format(
        "one unit counts cycles, the other radians: declare the quantity in the model in {}, and write the factor 2*pi where the "
        "equations need it; if the name is wrong, write `{}` in the data block",
        found.in_name, read);
  if (found.word)
    return fmt::format(
        "if the name is right, write `time {}` in the data block{}", named,
        found.stated ? "; if not, give the column another name in the file" : fmt::format("; if not, `time {}`", read));
  bool const has_zero_point = found.in_name == "degC" || found.in_name == "degF";
  return fmt::format(
      "if the name is right, write `{}` in the data block{}{}", named,
      has_zero_point ? fmt::format(", or `{}` if it is a difference", column_text(found.column, "delta_" + found.in_name)) : "",
      found.stated ? "" : fmt::format("; if not, `{}`", read));
}

/// "steps of 0.02 s (50 Hz)": what the column has in place of the steps of the block.
std::string times_of(UnusedTime const& found) {
  switch (found.kind) {
    case UnusedTime::Kind::gap:
      return fmt::format("a gap of {:.4g} s between rows {} and {}{}", found.longest, found.row, found.row + 1,
                         found.gaps > 1 ? fmt::format(" (and {} more)", found.gaps - 1) : "");
    case UnusedTime::Kind::unequal:
      return fmt::format("unequal steps, {:.4g} to {:.4g} s", found.shortest, found.longest);
    case UnusedTime::Kind::other_rate:
    case UnusedTime::Kind::by_steps:
    case UnusedTime::Kind::other_units:
      break;
  }
  return fmt::format("steps of {:.5g} s ({:.5g} Hz)", found.step, 1 / found.step);
}

}  // namespace

Findings find_other_units(ExperimentData const& data) {
  Findings findings;
  for (UnitInName const& each : data.record.other_units) {
    if (each.of_file) {
      findings.push_back({FindingCode::unit_in_file,
                          Severity::warning,
                          {each.column, data.use.name},
                          fmt::format("column `{}` of {} is read in {}, but the file states its unit as {}", each.column,
                                      data.use.name, each.read_in, each.in_name),
                          cure_of(each)});
      continue;
    }
    findings.push_back({FindingCode::unit_in_name,
                        each.stated && !each.word ? Severity::note : Severity::warning,
                        {each.column, data.use.name},
                        fmt::format("column `{}` of {} is read in {}, but its name {} {}", each.column, data.use.name, each.read_in,
                                    each.word ? "is that of a unit," : "ends in", each.in_name),
                        cure_of(each)});
  }
  return findings;
}

namespace {

/// What a rate in place of times does to the origin of the time, which is 0 then. first: s.
std::string origin_words(double first, Model const& model) {
  if (first == 0) return "";
  if (!reads_time(model)) return " (the time then begins at 0)";
  return fmt::format("; the time then begins at 0: add {} [s] to it where the model reads it", shortest(first));
}

}  // namespace

Findings find_rounded_times(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  std::optional<RoundedSteps> const& rounded = data.record.rounded;
  if (!rounded || model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  // In the wrong unit the rate would be wrong, too, and with `time` the name that tells it would be gone.
  auto const is_time = [&](UnitInName const& each) { return block.time && each.column == block.time->column && !each.stated; };
  if (std::any_of(data.record.other_units.begin(), data.record.other_units.end(), is_time)) return {};
  double const scale = data.record.time_unit ? data.record.time_unit->scale : 1;
  std::string const unit = data.record.time_unit ? data.record.time_unit->text : "s";
  return {{FindingCode::times_rounded,
           Severity::warning,
           {data.use.name},
           fmt::format("the time steps of {} are {} or {} {}: this results if times at equal steps, {} Hz, are rounded",
                       data.use.name, fmt::format("{:.6g}", rounded->lower / scale),
                       fmt::format("{:.6g}", (rounded->lower + rounded->unit) / scale), unit, shortest(rounded->rate)),
           fmt::format("if the samples were taken at equal steps, write `rate {} [Hz]` in place of `time` in `{}`: times that are "
                       "wrong by a fraction of a step act like noise, and bias the estimates{}",
                       shortest(rounded->rate), block.name, origin_words(data.record.time.front(), model))}};
}

Findings find_contradicted_rate(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  std::optional<UnusedTime> const& found = data.record.unused_time;
  if (!found || model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  bool const of_block = block.step > 0;
  double const step = of_block ? block.step : model.step.value_or(0);
  std::string const word = of_block && !block.step_stated ? "rate" : "step";
  std::string const stated = word == "rate" ? fmt::format("`rate` {:.6g} Hz", 1 / step) : fmt::format("`step` {:.6g} s", step);
  std::string const owner = of_block ? block.name : model.name;
  bool const perhaps = found->kind == UnusedTime::Kind::other_units || found->kind == UnusedTime::Kind::by_steps;
  auto const finding = [&](std::string message, std::string help) {
    return Findings{{FindingCode::rate_contradicted,
                     perhaps ? Severity::note : Severity::warning,
                     {data.use.name},
                     std::move(message),
                     std::move(help)}};
  };
  std::string const use = of_block ? fmt::format("write {} in place of `{}`", found->lines, word)
                                   : fmt::format("write {} in `{}`, and the same step in the model", found->lines, block.name);
  if (found->kind == UnusedTime::Kind::other_units)
    return finding(fmt::format("column `{}` of {} agrees with the {} of `{}` only if its numbers are in {}", found->column,
                               block.name, stated, owner, found->meant_unit),
                   fmt::format("if they are, {}: the times of the column are then used", use));
  if (found->kind == UnusedTime::Kind::by_steps)
    return finding(
        fmt::format("`{}` has {}, but column `{}` of {}, which is not used, has equal steps of {:.5g}: it may be the time", owner,
                    stated, found->column, block.name, found->step),
        fmt::format("if it is, {}", use));
  std::string const rate = found->kind == UnusedTime::Kind::other_rate && of_block
                               ? word == "rate" ? fmt::format(" or `rate {:.6g} [Hz]`", 1 / found->step)
                                                : fmt::format(" or `step {:.6g} [s]`", found->step)
                               : "";
  return finding(
      fmt::format("`{}` has {}, but the time in column `{}` of {} has {}: with a wrong time all rates and frequencies "
                  "are wrong",
                  owner, stated, found->column, block.name, times_of(*found)),
      fmt::format("{}{}; if `{}` is not the time of these samples, give it another name in the file", use, rate, found->column));
}

Findings find_shared_columns(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  auto const has = [](auto const& all, std::string const& name) {
    return std::any_of(all.begin(), all.end(), [&](auto const& each) { return each.name == name; });
  };
  std::vector<std::string> unused = data.record.unused_columns;
  if (unused.size() > 3) unused.resize(3);
  std::string others;
  for (std::string const& column : unused) others += (others.empty() ? "`" : ", `") + column_text(column, "") + "`";
  Findings findings;
  for (std::size_t m = 0; m < block.measured.size(); ++m) {
    DataMeasureUse const& channel = block.measured[m];
    if (!has(model.channels, channel.channel)) continue;
    std::string use;
    if (block.time && block.time->column == channel.column) use = "the time";
    for (DataInputUse const& input : block.inputs)
      if (input.column == channel.column && has(model.inputs, input.input)) use = fmt::format("the input {}", input.input);
    for (std::size_t before = 0; before < m && use.empty(); ++before)
      if (block.measured[before].column == channel.column && has(model.channels, block.measured[before].channel))
        use = fmt::format("the channel {}", block.measured[before].channel);
    if (use.empty() && data.record.measured_time == channel.column) use = "a time, by its name and its equal steps";
    if (use.empty()) continue;
    findings.push_back(
        {FindingCode::column_used_twice,
         Severity::warning,
         {channel.channel, data.use.name},
         fmt::format("{} is read from column `{}` of {}, which is also {}: the channel has no measurement of its own",
                     channel.channel, channel.column, data.use.name, use),
         fmt::format("write the column of its sensor in `measure {} = ...`{}", channel.channel,
                     others.empty() ? "" : "; columns that are not used: " + others)});
  }
  return findings;
}

}  // namespace sysid

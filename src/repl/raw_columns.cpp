// The columns of a data block as they stand in its file, before any fit.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/words.hpp"
#include "data/format/open_record.hpp"
#include "repl/answers.hpp"

namespace sysid::repl {
namespace {

/// A column of a file, and what the block calls it.
struct RawColumn {
  std::string name;
  ColumnUse const* use;
};

std::string unit_of(std::optional<Unit> const& stated, RecordFile const& file, std::string const& column) {
  std::string const text = stated ? stated->text : file.unit(column).value_or("");
  return text == "-" ? "" : text;
}

/// Times as the file has them, or counted at the rate of the block; row numbers where it has none.
std::vector<double> times_of(DataBlock const& block, RecordFile const& file, std::size_t rows) {
  if (block.time) return file.times(block.time->column);
  std::vector<double> times;
  for (std::size_t i = 0; i < rows; ++i)
    times.push_back(block.step > 0 ? static_cast<double>(i) * block.step : static_cast<double>(i + 1));
  return times;
}

AxisName time_axis(DataBlock const& block, RecordFile const& file) {
  if (!block.time) return block.step > 0 ? AxisName{"t", "s"} : AxisName{"row", ""};
  return {block.time->column, file.has_stamps() ? "s" : unit_of(block.time->unit, file, block.time->column)};
}

[[noreturn]] void no_such(DataBlock const& block, std::string const& name, Span span) {
  std::vector<std::string> known;
  for (DataMeasureUse const& each : block.measured) known.push_back(each.channel);
  for (DataInputUse const& each : block.inputs) known.push_back(each.input);
  for (DataPart const& each : block.parts) known.push_back(each.name);
  std::string help = did_you_mean(name, known);
  if (help.empty() && !known.empty()) help = fmt::format("it has {}", quoted(known));
  throw UserError({Severity::error,
                   "",
                   fmt::format("data `{}` has no channel, input or range `{}`", block.name, name),
                   Label{span, {}},
                   {},
                   std::move(help)});
}

}  // namespace

std::optional<std::string> plot_columns(Context const& context, std::string const& name, Span span) {
  if (!context.work.checked) return std::nullopt;
  std::vector<DataBlock> const& blocks = context.work.checked->file.data;
  std::string const first = name.substr(0, name.find('.')), rest = first == name ? "" : name.substr(first.size() + 1);
  auto const block = std::find_if(blocks.begin(), blocks.end(), [&](DataBlock const& each) { return each.name == first; });
  if (block == blocks.end()) return std::nullopt;
  std::vector<RawColumn> columns;
  for (DataMeasureUse const& each : block->measured)
    if (rest.empty() || each.channel == rest) columns.push_back({each.channel, &each});
  for (DataInputUse const& each : block->inputs)
    if (each.input == rest) columns.push_back({each.input, &each});
  DataPart const* part = nullptr;
  for (DataPart const& each : block->parts)
    if (columns.empty() && each.name == rest) part = &each;
  if (part != nullptr)
    for (DataMeasureUse const& each : block->measured) columns.push_back({each.channel, &each});
  if (columns.empty()) no_such(*block, rest, span);
  ColumnNeeds needs;
  if (block->time) needs.time = block->time->column;
  std::string const path = (context.work.statements.path.parent_path() / block->path).string();
  auto const file = open_record(path, block->rules, needs, std::nullopt, block->shown_path);
  std::string drawn;
  for (RawColumn const& column : columns) {
    std::vector<double> values = file->numbers(column.use->column), times = times_of(*block, *file, values.size());
    std::size_t const rows = std::min(values.size(), times.size());
    std::size_t const begin = part != nullptr ? std::min(static_cast<std::size_t>(part->first - 1), rows) : 0;
    std::size_t const end = part != nullptr && part->last > 0 ? std::min(static_cast<std::size_t>(part->last), rows) : rows;
    Curve curve;
    curve.x.assign(times.begin() + static_cast<std::ptrdiff_t>(begin), times.begin() + static_cast<std::ptrdiff_t>(end));
    curve.y.assign(values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end));
    drawn += plot_curves({curve}, time_axis(*block, *file), {column.name, unit_of(column.use->unit, *file, column.use->column)},
                         context.plot_size);
  }
  return drawn;
}

}  // namespace sysid::repl

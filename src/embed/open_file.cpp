// Opening: read, check, point data blocks to their tables.
#include "embed/open_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/checked/task_kinds.hpp"
#include "core/system/files.hpp"
#include "data/cell/number_notation.hpp"
#include "data/cell/serial_time.hpp"
#include "data/table/reading_rules.hpp"
#include "syntax/parse.hpp"

namespace sysid::embed {
namespace {

template <class Items>
std::string names_of(Items const& items) {
  std::string names;
  for (auto const& each : items) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", each.name);
  return names;
}

[[noreturn]] void unknown(std::string message, std::string help) {
  throw UserError({Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)});
}

/// E4025 at the column.
[[noreturn]] void refuse(DataBlock const& block, ColumnUse const& column, std::string_view message, std::string help) {
  throw UserError({Severity::error,
                   "E4025",
                   fmt::format("`{}`, column `{}`: {}", block.shown_path, column.column, message),
                   Label{column.span, {}},
                   {},
                   std::move(help)});
}

/// Units and dates that the block has read of its file are not in arrays, and numbers without them would be in other units.
void refuse_what_only_the_file_states(DataBlock const& block) {
  bool const has_dates = !block.rules.stamp.empty() && find_serial_time(block.rules.stamp) == nullptr;
  if (block.time && !block.time->unit && has_dates)
    refuse(
        block, *block.time, "`read stamp` converts the dates of the file to seconds, but the numbers of an array are not dates",
        fmt::format("write the unit that they have: `time {}`; the file is read as before", column_text(block.time->column, "s")));
  if (block.rules.units == UnitsPlace::none) return;
  auto const check = [&](ColumnUse const& column, std::string_view example) {
    if (!column.unit)
      refuse(block, column, "`read units` takes its unit from the file, and an array has none",
             fmt::format("write the unit of the array after the column, such as `{}`; plain numbers have `[1]`",
                         column_text(column.column, example)));
  };
  if (block.time && block.rules.stamp.empty()) check(*block.time, "s");
  for (DataInputUse const& input : block.inputs) check(input, "N");
  for (DataMeasureUse const& channel : block.measured) check(channel, "mm");
}

/// The table of arrays is plain, however the file is written that it replaces. What numbers mean stays: marks of missing samples,
/// written with a point here, and what times count since a date.
ReadingRules rules_of_arrays(ReadingRules const& of_file) {
  ReadingRules rules;
  rules.names = 1;
  rules.separator = ',';
  rules.asked_for_missing = of_file.asked_for_missing;
  rules.no_other_mark = of_file.no_other_mark;
  NumberNotation const notation{of_file.decimal, of_file.thousands};
  for (std::string const& word : of_file.missing) {
    double value = 0;
    bool const is_number = parse_cell(word, notation, value) == CellKind::number;
    rules.missing.push_back(is_number ? in_plain_notation(word, notation).value_or(word) : word);
  }
  if (find_serial_time(of_file.stamp) != nullptr) rules.stamp = of_file.stamp;
  return rules;
}

void point(CheckedFile& file, std::map<std::string, std::string> const& records) {
  for (auto const& [name, path] : records) {
    auto const block = std::find_if(file.data.begin(), file.data.end(), [&](DataBlock const& each) { return each.name == name; });
    if (block == file.data.end())
      unknown(fmt::format("there is no data block `{}` in this file", name), fmt::format("it has {}", names_of(file.data)));
    block->path = path;
    block->shown_path = fmt::format("{} (arrays)", name);
    refuse_what_only_the_file_states(*block);
    block->rules = rules_of_arrays(block->rules);
  }
}

/// The index of the fit task of that name; of the first one for an empty name.
int fit_task(CheckedFile const& file, std::string const& name) {
  for (std::size_t i = 0; i < file.tasks.size(); ++i) {
    Task const& task = file.tasks[i];
    if (kind_of(task) == TaskKind::fit && (name.empty() || task.name == name)) return static_cast<int>(i);
  }
  if (name.empty())
    unknown("this file has no fit task, which states what a density is of",
            "add one, such as `posterior = fit MODEL to DATA with auto`");
  unknown(fmt::format("`{}` is not a fit task of this file", name), fmt::format("its tasks are {}", names_of(file.tasks)));
}

}  // namespace

OpenFile::OpenFile(std::string const& path, std::optional<std::string> const& text,
                   std::map<std::string, std::string> const& records, bool awaits_records)
    : source_(path, "") {
  guarded(source_, [&] { source_ = Source(path, text ? *text : read_file(path, most_text_bytes + 1)); });
  guarded(source_, [&] {
    Diagnostics diagnostics;
    file_ = load(source_, diagnostics, {}, [&](std::string const& block) { return awaits_records || records.contains(block); });
    if (!file_) throw Raised(diagnostics, source_);
    if (!diagnostics.all().empty()) warnings_ = Raised(diagnostics, source_).what();
    point(*file_, records);
  });
}

OpenDensity::OpenDensity(std::shared_ptr<OpenFile const> file, std::string const& task, int threads)
    : file_(std::move(file)), session_(file_->source(), file_->file(), options_, silent_, out_, notices_) {
  options_.execution.threads = threads;
  density_ = guarded(file_->source(), [&] { return std::make_unique<FitDensity>(session_, fit_task(file_->file(), task)); });
}

Ledger OpenDensity::ledger() const {
  std::lock_guard const lock(mutex_);
  return ledger_;
}

void OpenDensity::add(Ledger const& ledger) {
  std::lock_guard const lock(mutex_);
  ledger_.merge(ledger);
}

}  // namespace sysid::embed

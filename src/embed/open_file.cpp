// Opening: read, check, point data blocks to their tables.
#include "embed/open_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/checked/task_kinds.hpp"
#include "core/system/files.hpp"
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

void point(CheckedFile& file, std::map<std::string, std::string> const& records) {
  for (auto const& [name, path] : records) {
    auto const block = std::find_if(file.data.begin(), file.data.end(), [&](DataBlock const& each) { return each.name == name; });
    if (block == file.data.end())
      unknown(fmt::format("there is no data block `{}` in this file", name), fmt::format("it has {}", names_of(file.data)));
    block->path = path;
    block->shown_path = fmt::format("{} (arrays)", name);
    // The table of the arrays is plain, however the file is written that it replaces.
    block->rules = {};
    block->rules.names = 1;
    block->rules.separator = ',';
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
                   std::map<std::string, std::string> const& records)
    : source_(path, "") {
  guarded(source_, [&] { source_ = Source(path, text ? *text : read_file(path, most_text_bytes + 1)); });
  guarded(source_, [&] {
    Diagnostics diagnostics;
    file_ = load(source_, diagnostics);
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

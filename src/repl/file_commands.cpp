// Commands about files: taken in, written, looked at.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "core/system/files.hpp"
#include "core/text/number.hpp"
#include "data/table.hpp"
#include "load/load.hpp"
#include "repl/workbench.hpp"
#include "syntax/format.hpp"
#include "syntax/parse.hpp"

namespace sysid::repl {

namespace {

/// A path as it is typed, with or without quotes; `~/` is the home folder.
std::filesystem::path path_of(std::string text) {
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  if (text.starts_with("~/"))
    if (char const* home = std::getenv("HOME")) return std::filesystem::path(home) / text.substr(2);
  return text;
}

}  // namespace

bool Workbench::take_file(std::filesystem::path const& path) {
  std::string const text = read_file(path, most_text_bytes + 1);
  Source source(path.string(), text);
  Diagnostics diagnostics;
  auto const file = sysid::load(source, diagnostics);
  voices_.messages << at_the_prompt(render(diagnostics, source, voices_.colour));
  for (Diagnostic const& each : diagnostics.all()) warned_.insert(each.code + each.message);
  if (!file) return false;
  Work loaded;
  loaded.path = path;
  loaded.items = items_of(text);
  Work draft = work_;
  if (draft.items.empty())
    draft.path = path;
  else
    loaded.move_to(draft.path);
  std::vector<std::string> notices;
  for (WorkItem& item : loaded.items) {
    auto const more = draft.put(std::move(item), tasks_run());
    notices.insert(notices.end(), more.begin(), more.end());
  }
  draft.prune();
  bool const first = work_.items.empty();
  if (!adopt(std::move(draft), "")) return false;
  if (first) unsaved_ = false;
  for (std::string const& notice : notices) say(notice);
  for (WorkItem const& item : work_.items) {
    if (item.kind == ItemKind::model && !item.kept) model_ = item.name;
    if (item.kind == ItemKind::data && !item.kept) data_ = item.name;
  }
  // Of several models the one that is fitted last is the likeliest to be worked on.
  for (Task const& task : checked_->file.tasks)
    if (auto const* fit = std::get_if<FitTask>(&task.what)) {
      std::string const& model = checked_->file.models[static_cast<std::size_t>(fit->model)].name;
      if (work_.find(ItemKind::model, model) < work_.items.size()) model_ = model;
    }
  loaded_ = path;
  std::size_t tasks = 0;
  std::string names;
  for (WorkItem const& item : items_of(text)) {
    tasks += item.kind == ItemKind::task ? 1 : 0;
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", word_of(item.kind), item.name);
  }
  say(fmt::format("{}: {}{}", path.string(), names, tasks == 0 ? "" : "; `run` runs its tasks"));
  return true;
}

bool Workbench::load(Arguments path) {
  if (path.empty()) return refuse("load what?", "`load FILE.sysid`");
  return take_file(path_of(path));
}

bool Workbench::reload(Arguments) {
  if (loaded_.empty()) return refuse("no file has been loaded or saved", "`load FILE.sysid`");
  return take_file(loaded_);
}

bool Workbench::save(Arguments path) {
  std::filesystem::path const to = path.empty() ? loaded_ : path_of(path);
  if (to.empty()) return refuse("`save` needs the name of a file", "`save work.sysid`");
  if (work_.items.empty()) return refuse("there is nothing to save yet");
  if (std::filesystem::exists(to) && to != loaded_)
    return refuse(fmt::format("`{}` exists already", to.string()), "use another name, or remove the file");
  Work moved = work_;
  moved.move_to(to);
  Diagnostics diagnostics;
  auto const text = formatted(Source(to.string(), moved.text()), diagnostics);
  if (!text) throw InternalError("the work cannot be laid out");
  write_file(to, *text);
  if (!adopt(std::move(moved), "")) return false;
  loaded_ = to;
  unsaved_ = false;
  say(fmt::format("{} written; `sysid run {} -o DIR` repeats it", to.string(), to.string()));
  return true;
}

bool Workbench::columns(Arguments path) {
  if (path.empty()) return refuse("`columns` needs the name of a data file", "`columns FILE.csv`");
  auto const folder = work_.path.parent_path();
  auto const given = path_of(path);
  Table const table = Table::read((std::filesystem::exists(given) ? given : folder / given).string());
  std::vector<std::vector<std::string>> rows = {{"column", "numbers", "smallest", "largest", "first"}};
  for (std::string const& column : table.columns()) {
    std::vector<double> values;
    try {
      values = table.numbers(column);
    } catch (UserError const&) {
      rows.push_back({column, "not all numbers", "", "", ""});
      continue;
    }
    double low = std::nan(""), high = low;
    int count = 0;
    for (double const each : values) {
      if (std::isnan(each)) continue;
      ++count;
      low = std::isnan(low) ? each : std::min(low, each);
      high = std::isnan(high) ? each : std::max(high, each);
    }
    rows.push_back({column, std::to_string(count), significant(low, 4), significant(high, 4),
                    values.empty() ? "" : significant(values.front(), 6)});
  }
  voices_.answers << fmt::format("{} rows\n", table.rows()) << align_columns(rows, 1) << std::flush;
  return true;
}

}  // namespace sysid::repl

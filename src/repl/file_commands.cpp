// Commands about files: load, save, show columns.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "core/system/files.hpp"
#include "core/text/number.hpp"
#include "data/format/open_record.hpp"
#include "load/load.hpp"
#include "repl/commands.hpp"
#include "repl/statements.hpp"
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

/// The warnings of a file that has been loaded: not shown again with what is typed next.
void mark_shown(Context& context, Diagnostics const& warnings, Source const& source) {
  Diagnostics none;
  auto const tree = parse(source, none);
  for (Diagnostic const& each : warnings.all()) {
    std::string item;
    for (std::size_t i = 0; tree && each.primary && i < tree->items.size(); ++i)
      if (Span const span = span_of(tree->items[i]); span.begin <= each.primary->span.begin && each.primary->span.begin < span.end)
        item = title_of(kind_of(tree->items[i]), name_of(tree->items[i]));
    context.output.is_new(each, item);
  }
}

bool take_file(Context& context, std::filesystem::path const& path) {
  std::string const text = read_file(path, most_text_bytes + 1);
  Source source(path.string(), text);
  Diagnostics diagnostics;
  auto const file = sysid::load(source, diagnostics);
  context.output.show(diagnostics, source);
  if (!file) return false;
  mark_shown(context, diagnostics, source);
  Workspace loaded;
  loaded.path = path;
  loaded.items = items_of(text);
  Workspace draft = context.work.statements;
  if (draft.items.empty())
    draft.path = path;
  else
    loaded.move_to(draft.path);
  std::vector<std::string> notices;
  for (WorkItem& item : loaded.items) {
    auto const more = draft.put(std::move(item), context.results.tasks());
    notices.insert(notices.end(), more.begin(), more.end());
  }
  draft.prune();
  bool const first = context.work.statements.items.empty();
  if (!adopt(context, std::move(draft), "")) return false;
  if (first) context.work.unsaved = false;
  for (std::string const& notice : notices) context.output.say(notice);
  for (WorkItem const& item : context.work.statements.items) {
    if (item.kind == ItemKind::model && item.kept_of.empty()) context.work.model = item.name;
    if (item.kind == ItemKind::data && item.kept_of.empty()) context.work.data = item.name;
  }
  // Of several models the one that is fitted last is the likeliest to be worked on.
  for (Task const& task : context.work.checked->file.tasks)
    if (auto const* fit = std::get_if<FitTask>(&task.what)) {
      std::string const& model = context.work.checked->file.models[static_cast<std::size_t>(fit->model)].name;
      if (context.work.statements.find(ItemKind::model, model) < context.work.statements.items.size()) context.work.model = model;
    }
  context.work.file = path;
  std::size_t tasks = 0;
  std::string names;
  for (WorkItem const& item : items_of(text)) {
    tasks += item.kind == ItemKind::task ? 1 : 0;
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", word_of(item.kind), item.name);
  }
  context.output.say(fmt::format("{}: {}{}", path.string(), names, tasks == 0 ? "" : "; `run` runs its tasks"));
  return true;
}

}  // namespace

namespace command {

bool load(Context& context, std::string const& path) {
  if (path.empty()) return context.output.refuse("`load` needs the name of a file", "`load FILE.sysid`");
  return take_file(context, path_of(path));
}

bool reload(Context& context, std::string const&) {
  if (context.work.file.empty()) return context.output.refuse("no file has been loaded or saved", "`load FILE.sysid`");
  return take_file(context, context.work.file);
}

bool save(Context& context, std::string const& path) {
  std::filesystem::path const to = path.empty() ? context.work.file : path_of(path);
  if (to.empty()) return context.output.refuse("`save` needs the name of a file", "`save work.sysid`");
  if (context.work.statements.items.empty()) return context.output.refuse("there is nothing to save yet");
  if (std::filesystem::exists(to) && to != context.work.file)
    return context.output.refuse(fmt::format("`{}` exists already", to.string()), "use another name, or remove the file");
  Workspace moved = context.work.statements;
  moved.move_to(to);
  Diagnostics diagnostics;
  auto const text = formatted(Source(to.string(), moved.text()), diagnostics);
  if (!text) throw InternalError("the session cannot be formatted");
  write_file(to, *text);
  if (!adopt(context, std::move(moved), "")) return false;
  context.work.file = to;
  context.work.unsaved = false;
  context.output.say(fmt::format("{} written; `sysid run {} -o DIR` repeats it", to.string(), to.string()));
  return true;
}

bool columns(Context& context, std::string const& path) {
  if (path.empty()) return context.output.refuse("`columns` needs the name of a data file", "`columns FILE.csv`");
  auto const folder = context.work.statements.path.parent_path();
  auto const given = path_of(path);
  auto const record = open_record((std::filesystem::exists(given) ? given : folder / given).string(), {});
  std::vector<std::vector<std::string>> rows = {{"column", "numbers", "smallest", "largest", "first"}};
  for (std::string const& column : record->columns()) {
    std::vector<double> values;
    try {
      values = record->numbers(column);
    } catch (UserError const&) {
      rows.push_back({column, "not only numbers", "", "", ""});
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
  if (auto const count = record->row_count()) context.output.answers() << fmt::format("{} rows\n", *count);
  context.output.answers() << align_columns(rows, 1) << std::flush;
  return true;
}

}  // namespace command

}  // namespace sysid::repl

// Entries to a checked work. Statements mean the same as in a file, since the work is checked as a file.
#include "repl/statements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/session/preconditions.hpp"
#include "core/text/words.hpp"
#include "data/format/open_record.hpp"
#include "experiment/experiments.hpp"
#include "load/load.hpp"
#include "repl/answers.hpp"
#include "repl/commands.hpp"
#include "repl/tasks.hpp"
#include "repl/words.hpp"
#include "repl/work/assignment.hpp"
#include "repl/work/change.hpp"
#include "repl/work/entry.hpp"
#include "syntax/entry.hpp"
#include "syntax/parse.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

void suggest_command(Diagnostics& diagnostics, std::string const& entry) {
  std::vector<Diagnostic> all = diagnostics.all();
  if (std::string ours = instead_of_command(entry); !ours.empty()) {
    all.front().help = std::move(ours);
    all.front().prompt_help.clear();
    return diagnostics.replace(std::move(all));
  }
  if (all.front().code != "E1105") return;
  std::vector<std::string> names;
  for (CommandRow const& row : commands()) names.emplace_back(row.name);
  std::string const word = entry.substr(0, std::min(entry.find(' '), entry.size()));
  if (std::string near = did_you_mean(word, names); !near.empty()) all.front().help = std::move(near);
  diagnostics.replace(std::move(all));
}

bool is_task(EntryPart const& part, std::string const& entry) {
  return part.kind == EntryPart::Kind::items &&
         kind_of(item_of(entry.substr(part.span.begin, part.span.end - part.span.begin))) == ItemKind::task;
}

/// Gives a task a name in its text.
void name_task(WorkItem& item, std::string const& name) {
  std::string const head = name + " = ";
  auto const length = static_cast<std::uint32_t>(head.size());
  item.text = head + item.text;
  item.name = name;
  for (TypedPart& each : item.typed) each.in_text = {each.in_text.begin + length, each.in_text.end + length};
}

/// Whether a task fits a plain model of the work: of a family its name would hold the arguments, which the checker knows.
bool of_plain_model(ast::Task const& task, Workspace const& work) {
  auto const kind = words::task_kind(task.verb.text);
  if (kind != TaskKind::fit && kind != TaskKind::simulate) return true;
  std::size_t const place = work.find(ItemKind::model, task.subject.text);
  return place < work.items.size() && std::get<ast::Model>(item_of(work.items[place].text)).arguments.empty();
}

/// A task without a name is called after what it does. Another one of that name, which was run, keeps its results.
void keep_unnamed(Context const& context, ast::Item const& tree, WorkItem& item, Workspace const& work,
                  std::vector<std::string>& notices) {
  auto const& task = std::get<ast::Task>(tree);
  if (task.name) return;
  if (!of_plain_model(task, work)) {
    std::string const plain = item.name;
    bool const taken = work.find(item.name) < work.items.size();
    return name_task(item, taken ? free_task_name(context, plain) : plain);
  }
  std::size_t const place = work.find(ItemKind::task, item.name);
  if (place == work.items.size() || work.items[place].text == item.text || !context.results.tasks().contains(item.name)) return;
  std::string const name = free_task_name(context, item.name);
  notices.push_back(fmt::format("`{}` is an earlier task, which is kept: the new task is called `{}`", item.name, name));
  name_task(item, name);
}

/// Puts a part into the draft; tasks to run when it has been checked. False when it cannot be.
bool draft(Context& context, EntryPart const& part, std::string const& entry, Workspace& work, std::vector<std::string>& tasks,
           std::vector<std::string>& notices) {
  auto const put = [&](WorkItem item) {
    auto const more = work.put(std::move(item), context.results.tasks());
    notices.insert(notices.end(), more.begin(), more.end());
  };
  std::string const text = entry.substr(part.span.begin, part.span.end - part.span.begin);
  auto const length = static_cast<std::uint32_t>(text.size());
  if (part.kind == EntryPart::Kind::items) {
    ast::Item const tree = item_of(text);
    WorkItem item{kind_of(tree), name_of(tree), "", text, {}, {{{0, length}, part.span.begin}}};
    if (item.kind == ItemKind::task) {
      item.text = with_seed(context, text);
      keep_unnamed(context, tree, item, work, notices);
      tasks.push_back(item.name);
    }
    if (item.kind == ItemKind::model) context.work.model = item.name;
    if (item.kind == ItemKind::data) context.work.data = item.name;
    put(std::move(item));
    return true;
  }
  bool const of_model = part.kind == EntryPart::Kind::model_statement;
  std::string const& name = of_model ? context.work.model : context.work.data;
  std::size_t const place = work.find(of_model ? ItemKind::model : ItemKind::data, name);
  if (name.empty() || place == work.items.size()) {
    Diagnostics diagnostics;
    diagnostics.add({Severity::error,
                     "",
                     of_model ? "this statement belongs to a model, but there is none yet"
                              : "this statement belongs to a data block, but there is none yet",
                     Label{part.span, {}},
                     {},
                     of_model ? "begin with `model NAME {`, or `load FILE`" : "begin with `data NAME {`, or `load FILE`"});
    context.output.show(diagnostics, entry);
    return false;
  }
  if (auto refused = of_model ? assignment(work.items[place], entry, part.span) : std::nullopt) {
    Diagnostics diagnostics;
    diagnostics.add(std::move(*refused));
    context.output.show(diagnostics, entry);
    return false;
  }
  WorkItem changed = with_statement(work.items[place], entry, part.span);
  for (auto const& [parameter, unit] : lost_units(work.items[place], changed))
    notices.push_back(fmt::format("`{0}` was declared in [{1}] and has no unit now: to keep it, write `{2} {0} [{1}] ...`",
                                  parameter, unit, text.substr(0, text.find_first_of(" \t\n"))));
  put(std::move(changed));
  return true;
}

/// Asks the files of data blocks that a draft adds or changes for their columns, as far as the files are there.
void ask_for_columns(Context& context, Workspace const& draft, Source const& source, CheckedFile const& file,
                     Diagnostics& diagnostics) {
  std::ostream nowhere(nullptr);
  Session const session(source, file, context.options, context.progress, nowhere, nowhere);
  for (DataBlock const& block : file.data) {
    std::size_t const now = draft.find(ItemKind::data, block.name),
                      before = context.work.statements.find(ItemKind::data, block.name);
    bool const changed = now < draft.items.size() && (before == context.work.statements.items.size() ||
                                                      context.work.statements.items[before].text != draft.items[now].text);
    std::filesystem::path const path = session.folder() / block.path;
    // What a task has yet to make may look otherwise then.
    Task const* made = maker(session, block);
    if (!changed || !std::filesystem::is_regular_file(path) || (made != nullptr && !context.results.made.contains(made->name)))
      continue;
    auto const refused = [&](auto const& ask) {
      try {
        ask();
        return false;
      } catch (UserError const& error) {
        diagnostics.add(error.diagnostic());
        return true;
      } catch (IoError const&) {
        return true;  // who reads it says so
      }
    };
    std::unique_ptr<RecordFile> record;
    ColumnNeeds needs;
    if (block.time) needs.time = block.time->column;
    if (refused([&] { record = open_record(path.string(), block.rules, needs, block.path_span); })) continue;
    auto const ask = [&](ColumnUse const& use) { refused([&] { record->numbers(use.column, use.span); }); };
    if (block.time) refused([&] { record->times(block.time->column, block.time->span); });
    for (DataInputUse const& input : block.inputs) ask(input);
    for (DataMeasureUse const& measure : block.measured) ask(measure);
  }
}

}  // namespace

bool adopt(Context& context, Workspace draft, std::string const& entry) {
  Source source(draft.path.string(), draft.text());
  Diagnostics diagnostics;
  auto file = sysid::load(source, diagnostics);
  // What comes from a file is said of the tasks that read it.
  if (file && !entry.empty()) ask_for_columns(context, draft, source, *file, diagnostics);
  context.output.show(diagnostics, source, draft, entry);
  if (!file || diagnostics.has_errors()) return false;
  for (WorkItem& item : draft.items) item.typed.clear();
  if (draft.text() != context.work.statements.text()) context.work.unsaved = true;
  context.work.statements = std::move(draft);
  context.work.checked = std::make_shared<CheckedText const>(CheckedText{std::move(source), std::move(*file)});
  return true;
}

bool enter_statements(Context& context, std::string const& entry) {
  Diagnostics diagnostics;
  auto const parts = parts_of(entry, diagnostics);
  if (!diagnostics.all().empty()) {
    suggest_command(diagnostics, std::string(trimmed(entry)));
    context.output.show(diagnostics, entry);
    return false;
  }
  for (std::size_t i = 0; i < parts.size();) {
    if (parts[i].kind == EntryPart::Kind::expression) {
      // Blanks before it, so that places are those in the entry.
      std::string text(parts[i].span.begin, ' ');
      text += entry.substr(parts[i].span.begin, parts[i].span.end - parts[i].span.begin);
      auto const tree = parse_expression(Source("prompt", text), diagnostics);
      if (!tree || !answer(context, *tree, text)) return false;
      ++i;
      continue;
    }
    // What stands together is checked together, up to a task, which is run before what follows.
    Workspace changed = context.work.statements;
    std::string const model = context.work.model, data = context.work.data;
    std::vector<std::string> tasks, notices;
    // What stands before a task stays when the task cannot be run.
    std::size_t const first = i;
    for (; i < parts.size() && parts[i].kind != EntryPart::Kind::expression && tasks.empty() &&
           (i == first || !is_task(parts[i], entry));
         ++i)
      if (!draft(context, parts[i], entry, changed, tasks, notices)) {
        context.work.model = model;
        context.work.data = data;
        return false;
      }
    changed.prune();
    Workspace const before = context.work.statements;
    auto const checked_before = context.work.checked;
    bool const unsaved_before = context.work.unsaved;
    if (!adopt(context, std::move(changed), entry)) {
      context.work.model = model;
      context.work.data = data;
      return false;
    }
    for (std::string const& notice : notices) context.output.say(notice);
    for (std::string const& task : tasks) {
      if (run_task(context, task, context.work.checked, false)) continue;
      // What could not be run is no part of the work.
      context.work.statements = before;
      context.work.checked = checked_before;
      context.work.unsaved = unsaved_before;
      return false;
    }
  }
  return true;
}

}  // namespace sysid::repl

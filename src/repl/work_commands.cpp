// Commands about the work: what it holds, what is changed, what a word means.
#include <fmt/format.h>

#include <algorithm>

#include "app/catalogue/lists.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "core/text/wrapped.hpp"
#include "repl/commands.hpp"
#include "repl/help.hpp"
#include "repl/statements.hpp"
#include "repl/work/change.hpp"
#include "syntax/entry.hpp"
#include "syntax/format.hpp"
#include "syntax/unparse.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {

namespace {

// "linear = fit circuit to record with map": settings would not fit beside the scores, and `show` has them. An option that stands
// before the back end goes with all that follows.
std::string without_settings(std::string const& statement) {
  auto const task = std::get<ast::Task>(item_of(statement));
  if (task.options.empty()) return statement;
  ast::Option const& first = task.options.front();
  constexpr std::string_view with = "with";
  std::string_view head = trimmed(std::string_view(statement).substr(0, first.span.begin));
  head = trimmed(head.substr(0, head.size() - with.size()));
  // What a prediction takes first is a number of draws.
  if (first.key || first.input || words::task_kind(task.verb.text) == TaskKind::predict) return std::string(head);
  auto const* const call = std::get_if<ast::Box<ast::Call>>(&first.value.node);
  return fmt::format("{} {} {}", head, with, call != nullptr ? (*call)->function.text : unparse(first.value));
}

std::string score(std::optional<double> value) { return value ? significant(*value, 4) : std::string(); }

}  // namespace

namespace command {

bool list(Context& context, std::string const& topic) {
  if (!topic.empty()) {
    ListRow const* const row = find_list(topic);
    if (row == nullptr) return context.output.refuse(fmt::format("there is no list of {}", topic), "topics are " + list_topics());
    context.output.answers() << wrapped_rows(row->text(), context.output.columns()) << std::flush;
    return true;
  }
  if (context.work.statements.items.empty()) {
    context.output.say("nothing yet: begin with `load FILE`, or with `model NAME {`");
    return true;
  }
  std::vector<std::vector<std::string>> rows;
  for (WorkItem const& item : context.work.statements.items) {
    if (item.kind == ItemKind::task) continue;
    bool const current = (item.kind == ItemKind::model && item.name == context.work.model) ||
                         (item.kind == ItemKind::data && item.name == context.work.data);
    rows.push_back({std::string(word_of(item.kind)), item.name,
                    current                 ? "the next statements change this one"
                    : !item.kept_of.empty() ? "as it was when a task was run"
                                            : ""});
  }
  if (!rows.empty()) context.output.answers() << align_columns(rows, 3);
  std::vector<std::vector<std::string>> tasks = {{"task", "", "nmse [%]", "rmse"}};
  for (WorkItem const& item : context.work.statements.items) {
    if (item.kind != ItemKind::task) continue;
    Result const* result = context.results.find(item.name);
    tasks.push_back({without_settings(in_one_line(item.text)),
                     result == nullptr                                 ? "not run"
                     : context.results.interrupted.contains(item.name) ? "stopped"
                                                                       : "done",
                     result == nullptr ? "" : score(result->nmse), result == nullptr ? "" : score(result->rmse)});
  }
  if (tasks.size() > 1) context.output.answers() << align_columns(tasks, 2);
  context.output.answers() << std::flush;
  return true;
}

bool show(Context& context, std::string const& name) {
  auto const laid_out = [](std::string const& text) {
    Diagnostics ignored;
    return formatted(Source("", text), ignored).value_or(text + "\n");
  };
  if (name.empty()) {
    if (context.work.statements.items.empty()) return list(context, "");
    context.output.answers() << laid_out(context.work.statements.text()) << std::flush;
    return true;
  }
  Result const* result = context.results.find(name);
  std::size_t const place = context.work.statements.find(name);
  if (result == nullptr && place == context.work.statements.items.size()) {
    std::vector<std::string> known;
    for (WorkItem const& item : context.work.statements.items) known.push_back(item.name);
    return context.output.refuse(fmt::format("there is no `{}` in the session", name), did_you_mean(name, known));
  }
  if (place < context.work.statements.items.size()) context.output.answers() << laid_out(context.work.statements.items[place].text);
  if (result != nullptr) context.output.answer(fmt::format("\n{}files: {}\n", result->summary, result->folder.string()));
  context.output.answers() << std::flush;
  return true;
}

bool change(Context& context, std::string const& block) {
  for (ItemKind const kind : {ItemKind::model, ItemKind::data})
    if (context.work.statements.find(kind, block) < context.work.statements.items.size()) {
      (kind == ItemKind::model ? context.work.model : context.work.data) = block;
      context.output.say(
          fmt::format("the next statements of a {} change `{}`", kind == ItemKind::model ? "model" : "data block", block));
      return true;
    }
  std::vector<std::string> known;
  for (WorkItem const& item : context.work.statements.items)
    if (item.kind == ItemKind::model || item.kind == ItemKind::data) known.push_back(item.name);
  return context.output.refuse(fmt::format("there is no model or data block `{}` in the session", block),
                               did_you_mean(block, known));
}

bool drop(Context& context, std::string const& name) {
  Workspace draft = context.work.statements;
  std::size_t const place = draft.find(name);
  std::size_t const model = draft.find(ItemKind::model, context.work.model);
  if (name.empty())
    return context.output.refuse("`drop` needs a name",
                                 "`drop NAME` removes a statement of the session, or a declaration of the current model");
  if (place < draft.items.size()) {
    draft.items.erase(draft.items.begin() + static_cast<std::ptrdiff_t>(place));
  } else if (model < draft.items.size()) {
    WorkItem without = without_statement(draft.items[model], name);
    if (without.text == draft.items[model].text)
      return context.output.refuse(
          fmt::format("there is no `{}` in the session, and no declaration of it alone in `{}`", name, context.work.model));
    for (std::string const& notice : draft.put(std::move(without), context.results.tasks())) context.output.say(notice);
  } else {
    return context.output.refuse(fmt::format("there is no `{}` in the session", name));
  }
  draft.prune();
  if (!adopt(context, std::move(draft), "")) return false;
  if (context.work.statements.find(ItemKind::task, name) == context.work.statements.items.size()) {
    context.results.erase(name);
    context.results.interrupted.erase(name);
  }
  return true;
}

bool help(Context& context, std::string const& word) {
  if (word.empty()) {
    context.output.answers() << help_overview(context.output.columns()) << std::flush;
    return true;
  }
  if (auto const text = help_on(word, context.output.columns())) {
    context.output.answers() << *text << std::flush;
    return true;
  }
  if (context.results.find(word) != nullptr || context.work.statements.find(word) < context.work.statements.items.size())
    return show(context, word);
  return context.output.refuse(fmt::format("there is no help on `{}`", word), did_you_mean(word, words_with_help()));
}

bool quit(Context& context, std::string const&) {
  context.over = true;
  return true;
}

}  // namespace command

}  // namespace sysid::repl

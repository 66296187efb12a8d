// Commands about the work: what it holds, what is changed, what a word means.
#include <fmt/format.h>

#include <algorithm>

#include "app/catalogue/lists.hpp"
#include "core/text/number.hpp"
#include "core/text/wrapped.hpp"
#include "repl/change.hpp"
#include "repl/help.hpp"
#include "repl/workbench.hpp"
#include "syntax/entry.hpp"
#include "syntax/format.hpp"

namespace sysid::repl {

namespace {

// "linear = fit circuit to record with map": settings would not fit beside the scores, and `show` has them. An option that stands
// before the back end goes with all that follows.
std::string without_settings(std::string task) {
  constexpr std::string_view with = " with ";
  std::size_t const begin = task.find(with);
  if (begin == std::string::npos) return task;
  std::size_t const end = std::min(task.find_first_of("(,= ", begin + with.size()), task.size());
  bool const option = end < task.size() && task[task.find_first_not_of(' ', end)] == '=';
  task.erase(option || task.find("predict ") < begin ? begin : end);
  return task;
}

std::string score(std::optional<double> value) { return value ? significant(*value, 4) : std::string(); }

}  // namespace

bool Workbench::command(CommandRow const& row, std::string const& arguments) {
  return guarded(Source("prompt", arguments), [&] { return (this->*row.run)(arguments); });
}

bool Workbench::list(Arguments topic) {
  if (!topic.empty()) {
    ListRow const* const row = find_list(topic);
    if (row == nullptr) return refuse(fmt::format("there is no list of {}", topic), "topics are " + list_topics());
    voices_.answers << wrapped_rows(row->text(), voices_.columns()) << std::flush;
    return true;
  }
  if (work_.items.empty()) {
    say("nothing yet: begin with `load FILE`, or with `model NAME {`");
    return true;
  }
  std::vector<std::vector<std::string>> rows;
  for (WorkItem const& item : work_.items) {
    if (item.kind == ItemKind::task) continue;
    bool const current =
        (item.kind == ItemKind::model && item.name == model_) || (item.kind == ItemKind::data && item.name == data_);
    rows.push_back({std::string(word_of(item.kind)), item.name,
                    current     ? "the next statements change this one"
                    : item.kept ? "as it was when a task was run"
                                : ""});
  }
  if (!rows.empty()) voices_.answers << align_columns(rows, 3);
  std::vector<std::vector<std::string>> tasks = {{"task", "", "nmse [%]", "rmse"}};
  for (WorkItem const& item : work_.items) {
    if (item.kind != ItemKind::task) continue;
    Result const* result = find_result(item.name);
    tasks.push_back({without_settings(in_one_line(item.text)),
                     result == nullptr                  ? "not run"
                     : interrupted_.contains(item.name) ? "stopped"
                                                        : "done",
                     result == nullptr ? "" : score(result->nmse), result == nullptr ? "" : score(result->rmse)});
  }
  if (tasks.size() > 1) voices_.answers << align_columns(tasks, 2);
  voices_.answers << std::flush;
  return true;
}

bool Workbench::show_text(Arguments name) {
  auto const laid_out = [](std::string const& text) {
    Diagnostics ignored;
    return formatted(Source("", text), ignored).value_or(text + "\n");
  };
  if (name.empty()) {
    if (work_.items.empty()) return list("");
    voices_.answers << laid_out(work_.text()) << std::flush;
    return true;
  }
  Result const* result = find_result(name);
  std::size_t const place = work_.find(name);
  if (result == nullptr && place == work_.items.size()) {
    std::vector<std::string> known;
    for (WorkItem const& item : work_.items) known.push_back(item.name);
    return refuse(fmt::format("there is no `{}` in the work", name), did_you_mean(name, known));
  }
  if (place < work_.items.size()) voices_.answers << laid_out(work_.items[place].text);
  if (result != nullptr) answer_lines(fmt::format("\n{}files: {}\n", result->summary, result->folder.string()));
  voices_.answers << std::flush;
  return true;
}

bool Workbench::change(Arguments block) {
  for (ItemKind const kind : {ItemKind::model, ItemKind::data})
    if (work_.find(kind, block) < work_.items.size()) {
      (kind == ItemKind::model ? model_ : data_) = block;
      say(fmt::format("the next statements of a {} change `{}`", kind == ItemKind::model ? "model" : "data block", block));
      return true;
    }
  std::vector<std::string> known;
  for (WorkItem const& item : work_.items)
    if (item.kind == ItemKind::model || item.kind == ItemKind::data) known.push_back(item.name);
  return refuse(fmt::format("there is no model or data block `{}` in the work", block), did_you_mean(block, known));
}

bool Workbench::drop(Arguments name) {
  Work draft = work_;
  std::size_t const place = draft.find(name);
  std::size_t const model = draft.find(ItemKind::model, model_);
  if (name.empty())
    return refuse("drop what?", "`drop NAME` removes a statement of the work, or a declaration of the current model");
  if (place < draft.items.size()) {
    draft.items.erase(draft.items.begin() + static_cast<std::ptrdiff_t>(place));
  } else if (model < draft.items.size()) {
    WorkItem without = without_statement(draft.items[model], name);
    if (without.text == draft.items[model].text)
      return refuse(fmt::format("there is no `{}` in the work, and no declaration of it in `{}`", name, model_));
    for (std::string const& notice : draft.put(std::move(without), tasks_run())) say(notice);
  } else {
    return refuse(fmt::format("there is no `{}` in the work", name));
  }
  draft.prune();
  if (!adopt(std::move(draft), "")) return false;
  if (work_.find(ItemKind::task, name) == work_.items.size()) {
    std::erase_if(results_, [&](Result const& each) { return each.task == name; });
    fitted_.erase(name);
    interrupted_.erase(name);
  }
  return true;
}

bool Workbench::help(Arguments word) {
  if (word.empty()) {
    voices_.answers << help_overview(voices_.columns()) << std::flush;
    return true;
  }
  if (auto const text = help_on(word, voices_.columns())) {
    voices_.answers << *text << std::flush;
    return true;
  }
  if (find_result(word) != nullptr || work_.find(word) < work_.items.size()) return show_text(word);
  return refuse(fmt::format("there is no help on `{}`", word), did_you_mean(word, words_with_help()));
}

bool Workbench::quit(Arguments) {
  over_ = true;
  return true;
}

}  // namespace sysid::repl

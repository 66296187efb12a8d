// Commands about tasks: checked, run, taken up, compared.
#include <fmt/format.h>

#include <algorithm>

#include "app/comparison/compare.hpp"
#include "app/preflight/check_file.hpp"
#include "check/checked/checked.hpp"
#include "repl/commands.hpp"
#include "repl/statements.hpp"
#include "repl/tasks.hpp"
#include "repl/words.hpp"
#include "report/page/check_page.hpp"
#include "syntax/entry.hpp"

namespace sysid::repl {
namespace {

/// The model of a task by the name of `list`, where what it ran on is kept beside what it has become.
std::string model_of_work(CheckedFile const& file, std::string const& name, std::string const& model) {
  auto const place = std::find_if(file.tasks.begin(), file.tasks.end(), [&](Task const& each) { return each.name == name; });
  if (place == file.tasks.end()) return model;
  Task const* task = &*place;
  if (auto const* what = std::get_if<PredictTask>(&task->what)) {
    // Of a prediction, that of its fit; of an average, whose models are several, that of its results.
    if (what->averages()) return model;
    task = &file.tasks[static_cast<std::size_t>(what->fit)];
  }
  if (auto const* fit = std::get_if<FitTask>(&task->what)) return file.models[static_cast<std::size_t>(fit->model)].name;
  if (auto const* what = std::get_if<SelectTask>(&task->what))
    return file.candidates[static_cast<std::size_t>(what->candidates)].name;
  return model;
}

}  // namespace

namespace command {

bool check(Context& context, std::string const&) {
  if (!context.work.checked) return context.output.refuse("there is nothing to check yet");
  std::ostream nowhere(nullptr);
  Session session(context.work.checked->source, context.work.checked->file, context.options, context.progress, nowhere, nowhere);
  CheckResult const result = check_file(session);
  context.output.show(result.diagnostics, context.work.checked->source);
  context.output.answer(check_text(result.page));
  return !result.diagnostics.has_errors();
}

bool run(Context& context, std::string const& tasks) {
  if (!context.work.checked) return context.output.refuse("there is nothing to run yet");
  std::vector<std::string> names = words_in(tasks);
  if (names.empty())
    for (WorkItem const& item : context.work.statements.items)
      if (item.kind == ItemKind::task && context.results.find(item.name) == nullptr) names.push_back(item.name);
  if (names.empty()) {
    context.output.say("all tasks have been run; `run TASK` runs one again");
    return true;
  }
  for (std::string const& name : names) {
    std::size_t const place = context.work.statements.find(ItemKind::task, name);
    if (place == context.work.statements.items.size()) {
      std::vector<std::string> known;
      for (WorkItem const& item : context.work.statements.items)
        if (item.kind == ItemKind::task) known.push_back(item.name);
      return context.output.refuse(fmt::format("there is no task `{}`", name), did_you_mean(name, known));
    }
    std::string const seeded = with_seed(context, in_one_line(context.work.statements.items[place].text));
    if (seeded != in_one_line(context.work.statements.items[place].text)) {
      Workspace draft = context.work.statements;
      draft.items[place].text = seeded;
      if (!adopt(context, std::move(draft), "")) return false;
    }
    if (!run_task(context, name, context.work.checked, false)) return false;
    if (context.results.interrupted.contains(name)) return true;  // whoever stops one stops all
  }
  return true;
}

bool compare(Context& context, std::string const& tasks) {
  std::vector<std::filesystem::path> folders;
  std::vector<std::string> names = words_in(tasks);
  // What can be compared of all that has been run: candidates of a selection have their probabilities already.
  if (names.empty())
    for (Result const& each : context.results.all)
      if (each.kind == TaskKind::fit || each.kind == TaskKind::predict) names.push_back(each.task);
  if (names.empty())
    return context.output.refuse("no fit and no prediction has been run yet", "`fit1 = fit MODEL to DATA with map`");
  for (std::string const& name : names) {
    Result const* result = context.results.find(name);
    if (result == nullptr) {
      std::vector<std::string> known;
      for (Result const& each : context.results.all) known.push_back(each.task);
      return context.output.refuse(fmt::format("there is no result of `{}`", name), did_you_mean(name, known));
    }
    folders.push_back(result->folder);
  }
  context.output.answer(comparison_text(sysid::compare(folders, [&](std::string const& task, std::string const& model) {
    return context.work.checked ? model_of_work(context.work.checked->file, task, model) : model;
  })));
  return true;
}

bool resume(Context& context, std::string const& task) {
  std::string name = task;
  if (name.empty() && context.results.interrupted.size() == 1) name = context.results.interrupted.begin()->first;
  auto const place = context.results.interrupted.find(name);
  if (place == context.results.interrupted.end())
    return context.output.refuse(
        context.results.interrupted.empty() ? "no task has been stopped" : "more than one task was stopped: name one of them",
        context.results.interrupted.empty() ? "" : "`resume TASK`");
  return run_task(context, name, std::shared_ptr<CheckedText const>(place->second), true);
}

}  // namespace command

}  // namespace sysid::repl

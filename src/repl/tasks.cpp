// Tasks at the prompt: one at a time, with what earlier ones have left at hand.
#include "repl/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "app/run/pipeline.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/stored_draws.hpp"
#include "app/session/task_rows.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/wrapped.hpp"
#include "report/file/replacement.hpp"

namespace sysid::repl {
namespace {

void keep(Context& context, Session& session, Task const& task, int index, std::string summary) {
  context.results.erase(task.name);
  context.results.all.push_back(read_result(session.result_folder(task), task.name, kind_of(task)));
  Result& result = context.results.all.back();
  result.summary = std::move(summary);
  if (auto const selected = session.selected.find(index); selected != session.selected.end())
    context.results.selected[task.name] = selected->second;
  if (kind_of(task) != TaskKind::fit) return;
  auto const fitted = session.fitted.find(index);
  if (fitted != session.fitted.end() && !context.results.interrupted.contains(task.name)) {
    context.results.fitted[task.name] = fitted->second;
    return;
  }
  // The draws so far, and those of a result that was complete already, stand in the folder alone.
  std::vector<std::string> names;
  for (DrawColumn const& column : result.draws) names.push_back(column.name);
  FittedModel stored = read_fitted(result.folder, names);
  for (DrawColumn const& column : result.draws) stored.draws.units.push_back(column.unit);
  context.results.fitted[task.name] = std::move(stored);
}

/// Whether the folder of a task holds results of the task as it is written now, whoever has computed them.
bool holds_own_result(Session const& session, Task const& task) {
  if (!summary_stands(session.result_folder(task))) return false;
  try {
    return !stored_otherwise(session, task, stated_seed(task));
  } catch (UserError const&) {
    return false;
  } catch (IoError const&) {  // what cannot be read is nothing to go on from
    return false;
  }
}

/// Those of the other tasks: what the task itself has left before may be of another text.
void hand_over_draws(TaskResults const& results, std::string const& name, Session& session) {
  std::vector<Task> const& tasks = session.file.tasks;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].name == name) continue;
    if (auto const known = results.fitted.find(tasks[i].name); known != results.fitted.end())
      session.fitted[static_cast<int>(i)] = known->second;
    if (auto const known = results.selected.find(tasks[i].name); known != results.selected.end())
      session.selected[static_cast<int>(i)] = known->second;
  }
}

}  // namespace

std::string with_seed(Context const& context, std::string const& text) {
  ast::Task const task = std::get<ast::Task>(item_of(text));
  for (ast::Option const& option : task.options)
    if (option.key && option.key->text == "seed") return text;
  std::random_device device;
  std::uint64_t const seed = context.options.seed ? *context.options.seed : device() % 1'000'000U;
  // Behind the last token: the text of a statement has no comment at its end.
  return text + fmt::format("{} seed = {}", task.options.empty() ? " with" : ",", seed);
}

std::string free_task_name(Context const& context, std::string const& like) {
  std::string base = like;
  while (!base.empty() && base.back() >= '0' && base.back() <= '9') base.pop_back();
  int number = base.size() < like.size() ? std::stoi(like.substr(base.size()).substr(0, 6)) + 1 : 2;
  auto const taken = [&](std::string const& name) {
    return context.work.statements.find(name) < context.work.statements.items.size() ||
           std::filesystem::exists(context.options.output / name);
  };
  while (taken(base + std::to_string(number))) ++number;
  return base + std::to_string(number);
}

std::string last_fit(Context const& context) {
  std::string found;
  for (Result const& each : context.results.all)
    if (each.kind == TaskKind::fit &&
        context.work.statements.find(ItemKind::task, each.task) < context.work.statements.items.size())
      found = each.task;
  return found;
}

bool run_task(Context& context, std::string const& name, std::shared_ptr<CheckedText const> const& checked, bool resume) {
  std::vector<Task> const& tasks = checked->file.tasks;
  auto const place = std::find_if(tasks.begin(), tasks.end(), [&](Task const& each) { return each.name == name; });
  if (place == tasks.end()) throw InternalError("a task that was checked is not there");
  RunOptions options = context.options;
  context.options.interrupt_after = 0;
  options.seed.reset();  // it stands in the task
  options.resume = resume;
  options.force = context.options.force || context.results.made.contains(name);
  LineOutput notices(context.output.messages(), [](std::string const& line) { return line; });
  std::ostringstream answers;
  Session session(checked->source, checked->file, options, context.progress, answers, notices);
  // Where a run was stopped before it left anything, the result of an earlier text is nothing to go on from.
  if (resume && sysid::complete(session.result_folder(*place)) && !holds_own_result(session, *place)) options.resume = false;
  hand_over_draws(context.results, name, session);
  for (int const earlier : task_row(*place).needs(*place)) {
    Task const& needed = tasks[static_cast<std::size_t>(earlier)];
    bool const there = session.fitted.contains(earlier) || session.selected.contains(earlier);
    if (!there && !sysid::complete(session.result_folder(needed)))
      return context.output.refuse(
          fmt::format("`{}` starts from the draws of `{}`, but there are none yet", name, needed.name),
          fmt::format("`{} {}`", context.results.interrupted.contains(needed.name) ? "resume" : "run", needed.name));
  }
  clear_interrupt();
  auto const index = static_cast<int>(place - tasks.begin());
  bool claimed = false;
  ExitCode exit = ExitCode::user_error;
  bool const ended = context.output.guarded(checked->source, [&] {
    exit = run_tasks(session, [&](Task const& task) {
      claimed = true;
      return task.name == name;
    });
    return true;
  });
  clear_interrupt();
  if (claimed && ended) context.results.made.insert(name);
  bool const stands = summary_stands(session.result_folder(*place));
  // A run that was stopped may have left the result of an earlier text where it was.
  bool const something = ended && (kind_of(*place) == TaskKind::simulate ||
                                   (exit == ExitCode::interrupted ? holds_own_result(session, *place) : stands));
  // A result of before that this run has swept away is none, nor one of a text that the work no longer has: of a run that failed
  // the work goes back to the text of before.
  if (!something && (ended || !stands)) context.results.erase(name);
  if (!ended) return false;
  if (exit == ExitCode::interrupted)
    context.results.interrupted[name] = checked;
  else
    context.results.interrupted.erase(name);
  // Stopped before its first draw, a task stays in the work: `resume` goes on with it.
  if (!something) return exit == ExitCode::interrupted;
  keep(context, session, *place, index, answers.str());
  context.output.answer(answers.str());
  return true;
}

}  // namespace sysid::repl

// Tasks at the prompt: one at a time, with what earlier ones have left at hand.
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "app/run/pipeline.hpp"
#include "app/session/results.hpp"
#include "app/session/stored_draws.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/wrapped.hpp"
#include "repl/workbench.hpp"
#include "report/file/result_folder.hpp"

namespace sysid::repl {
namespace {

/// The task whose draws this one begins from.
std::optional<int> earlier_of(Task const& task) {
  if (auto const* fit = std::get_if<FitTask>(&task.what)) return fit->near;
  if (auto const* prediction = std::get_if<PredictTask>(&task.what)) return prediction->fit;
  return std::nullopt;
}

}  // namespace

Result* Workbench::find_result(std::string_view task) {
  auto const place = std::find_if(results_.begin(), results_.end(), [&](Result const& each) { return each.task == task; });
  return place == results_.end() ? nullptr : &*place;
}

std::string Workbench::with_seed(std::string const& text) const {
  ast::Task const task = std::get<ast::Task>(item_of(text));
  for (ast::Option const& option : task.options)
    if (option.key && option.key->text == "seed") return text;
  std::random_device device;
  std::uint64_t const seed = options_.seed ? *options_.seed : device() % 1'000'000U;
  // Behind the last token: the text of a statement has no comment at its end.
  return text + fmt::format("{} seed = {}", task.options.empty() ? " with" : ",", seed);
}

std::string Workbench::free_task_name(std::string const& like) const {
  std::string base = like;
  while (!base.empty() && base.back() >= '0' && base.back() <= '9') base.pop_back();
  int number = base.size() < like.size() ? std::stoi(like.substr(base.size()).substr(0, 6)) + 1 : 2;
  auto const taken = [&](std::string const& name) {
    return work_.find(name) < work_.items.size() || std::filesystem::exists(options_.output / name);
  };
  while (taken(base + std::to_string(number))) ++number;
  return base + std::to_string(number);
}

bool Workbench::run_task(std::string const& name, std::shared_ptr<Checked const> const& checked, bool resume) {
  std::vector<Task> const& tasks = checked->file.tasks;
  auto const place = std::find_if(tasks.begin(), tasks.end(), [&](Task const& each) { return each.name == name; });
  if (place == tasks.end()) throw InternalError("a task that was checked is not there");
  RunOptions options = options_;
  options_.interrupt_after = 0;
  options.seed.reset();  // it stands in the task
  options.resume = resume;
  options.force = options_.force || made_.contains(name);
  LineOutput notices(voices_.messages, [](std::string const& line) { return at_the_prompt(line); });
  std::ostringstream answers;
  Session session(checked->source, checked->file, options, progress_, answers, notices);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (auto const known = fitted_.find(tasks[i].name); known != fitted_.end()) session.fitted[static_cast<int>(i)] = known->second;
    if (auto const known = selected_.find(tasks[i].name); known != selected_.end())
      session.selected[static_cast<int>(i)] = known->second;
  }
  if (auto const earlier = earlier_of(*place)) {
    Task const& needed = tasks[static_cast<std::size_t>(*earlier)];
    bool const there = session.fitted.contains(*earlier) || session.selected.contains(*earlier);
    if (!there && !sysid::complete(session.result_folder(needed)))
      return refuse(fmt::format("`{}` starts from the draws of `{}`, but there are none yet", name, needed.name),
                    fmt::format("`{} {}`", interrupted_.contains(needed.name) ? "resume" : "run", needed.name));
  }
  clear_interrupt();
  auto const index = static_cast<int>(place - tasks.begin());
  bool claimed = false;
  ExitCode exit = ExitCode::user_error;
  bool const ended = guarded(checked->source, [&] {
    exit = run_tasks(session, [&](Task const& task) {
      claimed = true;
      return task.name == name;
    });
    return true;
  });
  clear_interrupt();
  if (claimed && ended) made_.insert(name);
  bool const something =
      ended && (kind_of(*place) == TaskKind::simulate || std::filesystem::exists(session.result_folder(*place) / "summary.json"));
  // A result of before that this run has swept away is none.
  if (!something && !std::filesystem::exists(options_.output / name / "summary.json"))
    std::erase_if(results_, [&](Result const& each) { return each.task == name; });
  if (!ended) return false;
  if (exit == ExitCode::interrupted)
    interrupted_[name] = checked;
  else
    interrupted_.erase(name);
  // Stopped before its first draw, a task stays in the work: `resume` goes on with it.
  if (!something) return exit == ExitCode::interrupted;
  keep(session, *place, index, at_the_prompt(answers.str()));
  answer_lines(at_the_prompt(answers.str()));
  return true;
}

void Workbench::keep(Session& session, Task const& task, int index, std::string summary) {
  std::erase_if(results_, [&](Result const& each) { return each.task == task.name; });
  results_.push_back(read_result(session.result_folder(task), task.name, verb_of(task)));
  Result& result = results_.back();
  result.summary = std::move(summary);
  if (auto const selected = session.selected.find(index); selected != session.selected.end())
    selected_[task.name] = selected->second;
  if (kind_of(task) != TaskKind::fit) return;
  auto const fitted = session.fitted.find(index);
  if (interrupted_.contains(task.name)) {
    // The draws so far stand in the folder alone.
    std::vector<std::string> names;
    for (DrawColumn const& column : result.draws) names.push_back(column.name);
    fitted_[task.name] = read_fitted(result.folder, names);
    for (DrawColumn const& column : result.draws) fitted_[task.name].draws.units.push_back(column.unit);
  } else if (fitted != session.fitted.end()) {
    fitted_[task.name] = fitted->second;
  }
}

}  // namespace sysid::repl

// Commands about tasks: checked, run, fitted again, taken up, compared.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "app/preflight/check_file.hpp"
#include "app/run/compare.hpp"
#include "core/text/words.hpp"
#include "repl/words.hpp"
#include "repl/workbench.hpp"
#include "report/page/check_page.hpp"
#include "syntax/entry.hpp"
#include "syntax/parse.hpp"

namespace sysid::repl {

bool Workbench::check(Arguments) {
  if (!checked_) return refuse("there is nothing to check yet");
  std::ostream nowhere(nullptr);
  Session session(checked_->source, checked_->file, options_, progress_, nowhere, nowhere);
  CheckResult const result = check_file(session);
  voices_.messages << at_the_prompt(render(result.diagnostics, checked_->source, voices_.colour)) << std::flush;
  answer_lines(check_text(result.page));
  return !result.diagnostics.has_errors();
}

bool Workbench::run(Arguments tasks) {
  if (!checked_) return refuse("there is nothing to run yet");
  std::vector<std::string> names = words_in(tasks);
  if (names.empty())
    for (WorkItem const& item : work_.items)
      if (item.kind == ItemKind::task && find_result(item.name) == nullptr) names.push_back(item.name);
  if (names.empty()) {
    say("all tasks have been run; `run TASK` runs one again");
    return true;
  }
  for (std::string const& name : names) {
    std::size_t const place = work_.find(ItemKind::task, name);
    if (place == work_.items.size()) {
      std::vector<std::string> known;
      for (WorkItem const& item : work_.items)
        if (item.kind == ItemKind::task) known.push_back(item.name);
      return refuse(fmt::format("there is no task `{}`", name), did_you_mean(name, known));
    }
    std::string const seeded = with_seed(in_one_line(work_.items[place].text));
    if (seeded != in_one_line(work_.items[place].text)) {
      Work draft = work_;
      draft.items[place].text = seeded;
      if (!adopt(std::move(draft), "")) return false;
    }
    if (!run_task(name, checked_, false)) return false;
    if (interrupted_.contains(name)) return true;  // whoever stops one stops all
  }
  return true;
}

bool Workbench::refit(Arguments arguments) {
  // [FIT] [as NAME] [with ...]
  std::string head = arguments, with;
  if (auto const at = (" " + arguments).find(" with "); at != std::string::npos) {
    head = arguments.substr(0, at);
    with = arguments.substr(at + 5);
  }
  std::vector<std::string> words = words_in(head);
  std::string name, from;
  if (words.size() >= 2 && words[words.size() - 2] == "as") {
    name = words.back();
    words.resize(words.size() - 2);
  }
  if (words.size() > 1) return refuse("`refit` takes one fit", "`refit`, `refit FIT`, `refit FIT as NAME with mh(samples = 4000)`");
  if (words.size() == 1) from = words[0];
  if (from.empty())
    for (Result const& each : results_)
      if (each.verb == "fit" && work_.find(ItemKind::task, each.task) < work_.items.size()) from = each.task;
  if (from.empty()) return refuse("no fit has been run yet", "`fit1 = fit MODEL to DATA with map`");
  std::size_t const place = work_.find(ItemKind::task, from);
  if (place == work_.items.size() || !fitted_.contains(from))
    return refuse(fmt::format("`{}` is not a fit that has been run", from));
  std::string const& text = work_.items[place].text;
  ast::Task const task = std::get<ast::Task>(item_of(text));
  auto const written = [&](Span span) { return text.substr(span.begin, span.end - span.begin); };
  // What was kept under a name of its own is meant as it is now.
  auto const now = [&](ItemKind kind, std::string const& item) {
    std::size_t const at = work_.find(kind, item);
    return at < work_.items.size() && work_.items[at].kept ? item.substr(0, item.rfind('_')) : item;
  };
  if (name.empty()) name = free_task_name(from);
  std::string statement = fmt::format("{} = fit {}", name, now(ItemKind::model, task.subject.text));
  for (std::size_t i = 0; i < task.arguments.size(); ++i) statement += (i == 0 ? "(" : ", ") + written(task.arguments[i].span);
  if (!task.arguments.empty()) statement += ")";
  for (std::size_t i = 0; i < task.data.size(); ++i)
    statement += fmt::format("{}{}{}", i == 0 ? " to " : ", ", now(ItemKind::data, task.data[i].data.text),
                             task.data[i].part ? "." + task.data[i].part->text : "");
  std::string options(trimmed(with));
  // What the new options state, by the rules of the language; a mistake in them is told when the fit is entered.
  std::set<std::string> stated;
  bool backend = false;
  Diagnostics ignored;
  if (auto const given = parse(Source("", fmt::format("fit m to d with {}\n", options)), ignored);
      given && given->items.size() == 1)
    if (auto const* as_task = std::get_if<ast::Task>(&given->items.front()))
      for (ast::Option const& option : as_task->options) {
        if (option.key) stated.insert(option.key->text);
        backend = backend || (!option.key && !option.input);
      }
  bool const anew = !stated.contains("search");
  if (anew && name == from)
    return refuse(fmt::format("`{}` is the fit that the refit starts from and cannot be replaced by it", from),
                  fmt::format("use another name, `refit as {}`, or search anew, `refit as {} with search = everywhere`",
                              free_task_name(from), from));
  std::string kept;
  for (ast::Option const& option : task.options) {
    // Of new options the rest stays: the back end, where the simulation starts, how it is solved, the seed.
    bool const is_backend = !option.key && !option.input;
    if ((option.key && (option.key->text == "search" || stated.contains(option.key->text))) || (is_backend && backend)) continue;
    kept += (kept.empty() ? "" : ", ") + written(option.span);
  }
  // Without a back end of their own, new options follow the old one.
  options = backend ? options + (kept.empty() ? "" : ", ") + kept : kept + (kept.empty() || options.empty() ? "" : ", ") + options;
  statement += " with " + options;
  if (anew) statement += fmt::format("{}search = near({})", options.empty() ? "" : ", ", from);
  say(statement);
  return enter_parts(statement);
}

std::string Workbench::model_of_work(std::string const& task, std::string model) const {
  std::size_t place = work_.find(ItemKind::task, task);
  if (place == work_.items.size()) return model;
  ast::Task tree = std::get<ast::Task>(item_of(work_.items[place].text));
  // Of a prediction, that of its fit.
  place = work_.find(ItemKind::task, tree.subject.text);
  if (place < work_.items.size()) tree = std::get<ast::Task>(item_of(work_.items[place].text));
  return model.replace(0, std::min(model.find('('), model.size()), tree.subject.text);
}

bool Workbench::compare(Arguments tasks) {
  std::vector<std::filesystem::path> folders;
  std::vector<std::string> names = words_in(tasks);
  // What can be compared of all that has been run: candidates of a selection have their probabilities already.
  if (names.empty())
    for (Result const& each : results_)
      if (each.verb == "fit" || each.verb == "predict") names.push_back(each.task);
  if (names.empty()) return refuse("no fit and no prediction has been run yet", "`fit1 = fit MODEL to DATA with map`");
  for (std::string const& name : names) {
    Result const* result = find_result(name);
    if (result == nullptr) {
      std::vector<std::string> known;
      for (Result const& each : results_) known.push_back(each.task);
      return refuse(fmt::format("there is no result of `{}`", name), did_you_mean(name, known));
    }
    folders.push_back(result->folder);
  }
  answer_lines(comparison_text(
      sysid::compare(folders, [this](std::string const& task, std::string const& model) { return model_of_work(task, model); })));
  return true;
}

bool Workbench::resume(Arguments task) {
  std::string name = task;
  if (name.empty() && interrupted_.size() == 1) name = interrupted_.begin()->first;
  auto const place = interrupted_.find(name);
  if (place == interrupted_.end())
    return refuse(interrupted_.empty() ? "no task has been stopped" : "more than one task was stopped: give its name",
                  interrupted_.empty() ? "" : "`resume TASK`");
  return run_task(name, std::shared_ptr<Checked const>(place->second), true);
}

}  // namespace sysid::repl

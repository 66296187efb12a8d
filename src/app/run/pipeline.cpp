// text -> syntax tree -> checked file -> tasks, one line each.
#include "app/run/pipeline.hpp"
#include "report/page/check_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/preflight/check_file.hpp"
#include "app/selection/select.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/session.hpp"
#include "app/task/tasks.hpp"
#include "likelihood/compiled_model.hpp"
#include "model/dump.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::string dump(CandidateSet const& set) {
  std::string text = fmt::format("candidates {}{}\n", set.name, set.title.empty() ? "" : " \"" + set.title + "\"");
  for (CandidateModel const& each : set.models) text += fmt::format("  {} probability {}\n", each.name, each.probability);
  if (!set.shared.empty()) text += fmt::format("  shared {}\n", fmt::join(set.shared, ", "));
  return text;
}

// Names of the file in a task that it could have, so that the line can be copied.
std::string nothing_to_do(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs) {
  std::string text = verbs.empty() ? fmt::format("there is no task in {}\n", source.name())
                                   : fmt::format("there is no {} task in {}\n", fmt::join(verbs, " or "), source.name());
  std::string const model = file.models.empty() ? "MODEL" : file.models.front().name;
  std::string const data = file.data.empty() ? "DATA" : file.data.front().name;
  if (verbs.empty() || verbs.front() == "fit")
    text += fmt::format("help: add one, for example `posterior = fit {} to {} with mh`\n", model, data);
  else if (verbs.front() == "select")
    text += fmt::format("help: add one, for example `selection = select {} to {} with abc_smc`\n",
                        file.candidates.empty() ? model : file.candidates.front().name, data);
  else if (verbs.front() == "discover")
    text += fmt::format("help: add one, for example `found = discover {} from {}`\n",
                        file.dictionaries.empty() ? "DICTIONARY" : file.dictionaries.front().name, data);
  else if (verbs.front() == "predict")
    text += fmt::format("help: add one, for example `forecast = predict posterior on {}`\n", data);
  else
    text += fmt::format("help: add one, for example `truth = simulate {} with samples = 1000, rate = 1000 [Hz]`\n", model);
  return text;
}

}  // namespace

std::string verb_of(Task const& task) {
  return std::holds_alternative<SimulateTask>(task.what)   ? "simulate"
         : std::holds_alternative<FitTask>(task.what)      ? "fit"
         : std::holds_alternative<SelectTask>(task.what)   ? "select"
         : std::holds_alternative<DiscoverTask>(task.what) ? "discover"
                                                           : "predict";
}

std::string dump_stage(Source& source, std::string const& stage, Diagnostics& diagnostics) {
  if (stage == "ast") {
    auto const tree = parse(source, diagnostics);
    return tree ? unparse(*tree) : std::string();
  }
  auto const file = load(source, diagnostics);
  if (!file) return {};
  if (stage == "flat") return unparse(file->tree);
  std::string text;
  for (Model model : file->models) {
    if (stage == "program") remove_processes(model);
    text += stage == "model" ? dump(model) : dump_program(*compile(model, false, model.implicit ? "ida" : SolverSettings{}.method));
  }
  if (stage == "model") {
    for (CandidateSet const& set : file->candidates) text += dump(set);
    for (CheckedDictionary const& dictionary : file->dictionaries) text += dictionary_text(describe_dictionary(dictionary));
  }
  return text;
}

ExitCode run_tasks(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs, RunOptions const& options,
                   Progress& progress, std::ostream& out, std::ostream& notices) {
  Session session(source, file, options, progress, out, notices);
  auto const asked = [&](Task const& task) {
    return verbs.empty() || std::find(verbs.begin(), verbs.end(), verb_of(task)) != verbs.end();
  };
  if (std::any_of(file.tasks.begin(), file.tasks.end(), asked)) return run_tasks(session, asked);
  notices << nothing_to_do(source, file, verbs);
  return ExitCode::usage;
}

ExitCode run_tasks(Session& session, std::function<bool(Task const&)> const& asked) {
  CheckedFile const& file = session.file;
  RunOptions const& options = session.options;
  // A simulate task leaves its record and nothing else.
  auto const kept = [&](Task const& task) {
    auto const* made = std::get_if<SimulateTask>(&task.what);
    if (made != nullptr) return std::filesystem::exists(session.result_folder(task) / made->file);
    if (!complete(session.result_folder(task))) return false;
    std::optional<std::uint64_t> const seed =
        options.seed ? options.seed : std::visit([](auto const& what) { return what.seed; }, task.what);
    if (auto const wrong = stored_otherwise(session, task, seed); wrong && options.resume) throw UserError(*wrong);
    return true;
  };
  std::set<Task const*> complete_already;
  for (Task const& task : file.tasks)
    if (asked(task) && options.resume && kept(task)) complete_already.insert(&task);
  auto const wanted = [&](Task const& task) { return asked(task) && !complete_already.contains(&task); };
  check_readiness(session, wanted).require();  // before old results are touched
  for (Task const& task : file.tasks) {
    if (!wanted(task)) continue;
    if (std::holds_alternative<SimulateTask>(task.what) && kept(task) && !options.force)
      throw UserError({Severity::error,
                       "",
                       fmt::format("`{}` holds results already", session.result_folder(task).string()),
                       std::nullopt,
                       {},
                       "add --force to replace them, or -o DIR to write elsewhere"});
    claim_results(session.result_folder(task), options);
  }
  ExitCode worst = ExitCode::success;
  for (std::size_t i = 0; i < file.tasks.size(); ++i) {
    Task const& task = file.tasks[i];
    if (complete_already.contains(&task)) session.notices << fmt::format("{}: complete, kept\n", task.name);
    if (!wanted(task)) continue;
    ExitCode const code = std::visit(
        [&](auto const& what) -> ExitCode {
          using What = std::decay_t<decltype(what)>;
          if constexpr (std::is_same_v<What, SimulateTask>)
            return run_simulate(session, task, what);
          else if constexpr (std::is_same_v<What, FitTask>)
            return run_fit(session, static_cast<int>(i), task, what);
          else if constexpr (std::is_same_v<What, DiscoverTask>)
            return run_discover(session, task, what);
          else if constexpr (std::is_same_v<What, SelectTask>)
            return run_select(session, static_cast<int>(i), task, what);
          else if (std::holds_alternative<SelectTask>(file.tasks[static_cast<std::size_t>(what.fit)].what))
            return run_predict_selection(session, task, what);
          else
            return run_predict(session, task, what);
        },
        task.what);
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
  }
  return worst;
}

}  // namespace sysid

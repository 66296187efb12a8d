// Two runs of one fit and a comparison.
#include "app/disturbed/fit_disturbed.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/disturbed/disturbance_size.hpp"
#include "app/run/nothing_to_do.hpp"
#include "app/run/pipeline.hpp"
#include "app/session/results.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"

namespace sysid {
namespace {

/// The results of another task of this file would be written over.
void require_free_name(CheckedFile const& file, Task const& fit) {
  for (Task const& other : file.tasks)
    if (other.name == changed_name(fit.name))
      throw UserError(
          {Severity::error,
           "",
           fmt::format("this fit with a disturbance would have the name `{}`, but another task has this name already", other.name),
           Label{other.span, {}},
           {},
           "give that task another name"});
}

/// Those whose model can have a disturbance; the others are named in a notice. UserError where there is none.
std::vector<Task const*> wanted_fits(Source const& source, CheckedFile const& file, std::ostream& notices) {
  std::vector<Task const*> wanted;
  std::vector<std::pair<std::string, UserError>> refused;
  for (Task const& task : file.tasks) {
    if (kind_of(task) != TaskKind::fit) continue;
    try {
      require_free_name(file, task);
      (void)disturbed_equations(source, file, task);
      wanted.push_back(&task);
    } catch (UserError const& error) {
      refused.emplace_back(task.name, error);
    }
  }
  if (wanted.empty() && !refused.empty()) throw refused.front().second;
  for (auto const& [name, error] : refused)
    notices << fmt::format("{}: fitted without a disturbance only: {}\n", name, error.diagnostic().message);
  return wanted;
}

/// The texts of modules beside the file are needed where the changed file lies, too.
void copy_modules(Source const& source, std::filesystem::path const& folder) {
  for (int k = 1; k < source.files(); ++k) {
    std::filesystem::path const from(source.name(k));
    if (std::filesystem::exists(from)) write_file(folder / from.filename(), std::string(source.text(k)));
  }
}

/// What is wrong in another text than that of the file that was asked for: its place goes into the words.
UserError said_of(Source const& changed, Diagnostic diagnostic) {
  if (diagnostic.primary) {
    Place const place = changed.place(diagnostic.primary->span.begin);
    diagnostic.message = fmt::format("{}:{}:{}: {}", changed.name(place.file), place.line, place.column, diagnostic.message);
  }
  diagnostic.primary.reset();
  diagnostic.secondary.clear();
  return UserError(std::move(diagnostic));
}

class DisturbedFit {
 public:
  DisturbedFit(Session& session, Task const& fit) : session_(session), fit_(fit) {}

  ExitCode run(Progress& progress) {
    Task const& fit = fit_;
    std::filesystem::path const plain = session_.result_folder(fit), folder = session_.options.output / changed_name(fit.name);
    std::filesystem::path const path = folder / "with_disturbance.sysid";
    DisturbanceFound const found = find_disturbance(session_, fit);
    Source changed(path.string(), text_with_disturbances(session_.source, fit, found.equations, found.sizes, folder));
    std::filesystem::create_directories(folder);
    copy_modules(session_.source, folder);
    write_file(path, std::string(changed.text(0)));
    ranks::wait_for_all();
    Diagnostics diagnostics;
    auto const file = load(changed, diagnostics);
    if (!file) {
      auto const first = std::find_if(diagnostics.all().begin(), diagnostics.all().end(),
                                      [](Diagnostic const& each) { return each.severity == Severity::error; });
      throw said_of(changed, *first);
    }
    session_.notices << fmt::format("{}: the model with a disturbance is `{}`\n", fit.name, path.string());
    ExitCode code = ExitCode::success;
    try {
      code = run_tasks(changed, *file, {"fit"}, session_.options, progress, session_.out, session_.notices);
    } catch (UserError const& error) {
      throw said_of(changed, error.diagnostic());
    }
    if (code == ExitCode::interrupted || code == ExitCode::usage) return code;
    session_.out << "\n" << disturbance_words(plain, folder, found.equations, explained_shares(session_, fit, folder));
    return code;
  }

 private:
  Session& session_;
  Task const& fit_;
};

}  // namespace

DisturbanceFound find_disturbance(Session& session, Task const& fit) {
  DisturbanceFound found{disturbed_equations(session.source, session.file, fit), {}};
  found.sizes = disturbance_sizes(session, fit, session.result_folder(fit), found.equations);
  // White noise has no value that a channel, such as an acceleration, could have.
  Source trial(session.source.name(), text_with_disturbances(session.source, fit, found.equations, found.sizes, session.folder()));
  Diagnostics diagnostics;
  load(trial, diagnostics);
  bool const read =
      std::any_of(diagnostics.all().begin(), diagnostics.all().end(), [](Diagnostic const& each) { return each.code == "E3306"; });
  for (DisturbedEquation& each : found.equations) each.memory = read && !each.discrete;
  return found;
}

ExplainedShares explained_shares(Session& session, Task const& fit, std::filesystem::path const& with) {
  return {explained_share(session, fit, session.result_folder(fit)), explained_share(session, fit, with)};
}

ExitCode fit_with_disturbance(Source const& source, CheckedFile const& file, RunOptions const& options, Progress& progress,
                              std::ostream& out, std::ostream& notices) {
  if (std::none_of(file.tasks.begin(), file.tasks.end(), [](Task const& each) { return kind_of(each) == TaskKind::fit; })) {
    notices << nothing_to_do(source, file, {"fit"});
    return ExitCode::usage;
  }
  std::vector<Task const*> const wanted = wanted_fits(source, file, notices);
  RunOptions kept = options;
  kept.resume = !options.force;  // a fit that is there already is the one to be compared with
  Session session(source, file, kept, progress, out, notices);
  ExitCode worst = run_tasks(session, [](Task const& task) { return kind_of(task) == TaskKind::fit; });
  if (worst == ExitCode::interrupted) return worst;
  for (Task const* each : wanted) {
    ExitCode const code = DisturbedFit(session, *each).run(progress);
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
  }
  return worst;
}

}  // namespace sysid

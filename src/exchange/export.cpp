// Folders to files.
#include "exchange/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/results.hpp"
#include "app/stored_draws.hpp"
#include "core/diagnostic.hpp"
#include "core/files.hpp"
#include "exchange/inference_data.hpp"
#include "exchange/selection_data.hpp"
#include "exchange/stan_program.hpp"
#include "report/selection.hpp"
#include "typeset/typeset.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;

UserError refused(std::string message, std::string help) {
  return UserError({Severity::error, "", std::move(message), std::nullopt, {}, std::move(help)});
}

/// A file to write.
struct Export {
  fs::path path;
  InferenceData data;
};

fs::path fit_path(StoredResult const& stored) { return stored.folder / (stored.task() + ".nc"); }

fs::path candidate_path(StoredResult const& stored, std::string const& candidate) {
  return stored.folder / fmt::format("{}_{}.nc", stored.task(), model_file_name(candidate));
}

std::string recorded_file(fs::path const& folder) {
  if (!fs::exists(folder / "timing.json")) return {};
  auto const timing = nlohmann::json::parse(read_file(folder / "timing.json"), nullptr, false);
  return timing.is_object() && timing.contains("file") && timing["file"].is_string() ? timing["file"].get<std::string>() : "";
}

/// The task of a session whose results these are.
int task_of(Session const& session, StoredResult const& stored) {
  for (std::size_t t = 0; t < session.file.tasks.size(); ++t) {
    Task const& task = session.file.tasks[t];
    if (task.name != stored.task()) continue;
    if (fs::weakly_canonical(session.result_folder(task)) != fs::weakly_canonical(stored.folder))
      throw refused(fmt::format("`{}` holds results of the task `{}`", stored.folder.string(), task.name),
                    fmt::format("give the folder that name, or export what it holds itself with --draws 0"));
    return static_cast<int>(t);
  }
  throw refused(
      fmt::format("`{}` has no task `{}`, whose results `{}` holds", session.source.name(), stored.task(), stored.folder.string()),
      "name the file that they are of with --model FILE, or export what they hold themselves with --draws 0");
}

/// Predictions from a fit's draws that lie beside it, in the order of the file.
std::vector<std::pair<Task const*, StoredResult>> predictions_of(Session const& session, int fit) {
  std::vector<std::pair<Task const*, StoredResult>> found;
  for (Task const& task : session.file.tasks) {
    auto const* what = std::get_if<PredictTask>(&task.what);
    if (what == nullptr || what->fit != fit || !complete(session.result_folder(task))) continue;
    found.emplace_back(&task, read_stored_result(session.result_folder(task)));
  }
  return found;
}

Export fit_export(StoredResult const& stored, Session* session, int draws) {
  Export file{fit_path(stored), stored_inference_data(stored)};
  if (session == nullptr) return file;
  int const task = task_of(*session, stored);
  auto const* fit = std::get_if<FitTask>(&session->file.tasks[static_cast<std::size_t>(task)].what);
  if (fit == nullptr)
    throw refused(fmt::format("`{}` is no fit in `{}`", stored.task(), session->source.name()),
                  "name the file that the results are of with --model FILE");
  add_simulated(*session, task, stored, draws, file.data);
  auto const predictions = predictions_of(*session, task);
  bool const process = !session->file.models[static_cast<std::size_t>(fit->model)].processes.empty();
  if (!process)
    add_predictions(*session, predictions, file.data);
  else
    for (auto const& each : predictions)
      file.data.left_out.push_back(
          fmt::format("predictions of `{}`: with an unknown function over the rows only the bands of predict.csv are stored",
                      each.first->name));
  return file;
}

std::vector<Export> selection_exports(StoredResult const& stored, Session* session) {
  std::vector<CandidateData> candidates = stored_candidates(stored);
  if (session != nullptr) {
    int const task = task_of(*session, stored);
    if (!std::holds_alternative<SelectTask>(session->file.tasks[static_cast<std::size_t>(task)].what))
      throw refused(fmt::format("`{}` is no selection in `{}`", stored.task(), session->source.name()),
                    "name the file that the results are of with --model FILE");
    add_candidate_data(*session, task, candidates);
  }
  std::vector<Export> files;
  for (CandidateData& each : candidates) files.push_back({candidate_path(stored, each.name), std::move(each.data)});
  return files;
}

std::string groups_text(InferenceData const& data) {
  std::vector<std::string> names;
  for (NetcdfGroup const& group : data.groups) names.push_back(group.name());
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

ExportedResults find_results(fs::path const& folder) {
  if (!fs::is_directory(folder)) throw IoError(fmt::format("there is no folder `{}`", folder.string()));
  // A folder's name is its task's, also where it is given as `.`.
  fs::path given = folder.lexically_normal();
  if (!given.has_filename()) given = given.parent_path();
  if (given.empty() || given.filename() == "." || given.filename() == "..") given = fs::canonical(folder);
  ExportedResults found;
  if (fs::exists(given / "summary.json")) {
    found.one_task = true;
    found.results.push_back(read_stored_result(given));
    found.run = given.has_parent_path() ? given.parent_path() : fs::path(".");
    found.file = recorded_file(given);
    return found;
  }
  found.run = given;
  std::set<fs::path> tasks;
  for (fs::directory_entry const& entry : fs::directory_iterator(given))
    if (fs::exists(entry.path() / "summary.json")) tasks.insert(entry.path());
  for (fs::path const& task : tasks) {
    found.results.push_back(read_stored_result(task));
    if (found.file.empty()) found.file = recorded_file(task);
  }
  if (tasks.empty())
    throw refused(fmt::format("`{}` holds no results", folder.string()),
                  "give the folder of a task, such as results/posterior, or of a whole run, such as results");
  return found;
}

void require_exportable(ExportedResults const& results, bool force) {
  bool any = false;
  for (StoredResult const& stored : results.results) {
    if (results.one_task && stored.is("predict"))
      throw refused(fmt::format("`{}` is a prediction, which goes into the file of its fit", stored.folder.string()),
                    "export the folder of the fit, or of the whole run");
    std::vector<fs::path> paths;
    if (stored.is("fit")) paths.push_back(fit_path(stored));
    if (stored.is("select"))
      for (std::string const& candidate : living_candidates(stored)) paths.push_back(candidate_path(stored, candidate));
    for (fs::path const& path : paths)
      if (!force && fs::exists(path))
        throw refused(fmt::format("`{}` is there already", path.string()), "add --force to replace it");
    any = any || !paths.empty();
  }
  if (!any)
    throw refused(
        fmt::format("`{}` holds no draws", results.one_task ? results.results.front().folder.string() : results.run.string()),
        "draws are what a fit or a selection leaves");
}

void export_netcdf(ExportedResults const& results, Session* session, int draws, std::ostream& out) {
  for (StoredResult const& stored : results.results) {
    std::vector<Export> files;
    if (stored.is("fit")) files.push_back(fit_export(stored, session, draws));
    if (stored.is("select")) files = selection_exports(stored, session);
    for (Export const& file : files) {
      write_file(file.path, file.data.bytes());
      out << fmt::format("{}: {}\n", file.path.string(), groups_text(file.data));
      for (std::string const& line : file.data.left_out) out << "  left out: " << line << '\n';
    }
  }
}

void export_stan(Session& session, ExportedResults const* results, bool force, std::ostream& out) {
  std::vector<std::pair<fs::path, std::string>> files;
  auto const add = [&](Task const& task, SolverSettings const& solver) {
    StanProgram written = stan_program(session, task, solver);
    fs::path const folder = session.result_folder(task);
    files.emplace_back(folder / (task.name + ".stan"), std::move(written.program));
    files.emplace_back(folder / (task.name + ".data.json"), std::move(written.data));
  };
  if (results != nullptr) {
    for (StoredResult const& stored : results->results)
      if (stored.is("fit")) {
        int const task = task_of(session, stored);
        add(session.file.tasks[static_cast<std::size_t>(task)], fitted_model(session, task).solver);
      }
  } else {
    for (Task const& task : session.file.tasks)
      if (auto const* fit = std::get_if<FitTask>(&task.what)) add(task, fit->solver);
  }
  if (files.empty()) throw refused("there is no fit to write as a Stan program", "name a file with a fit task, or results of one");
  for (auto const& [path, text] : files)
    if (!force && fs::exists(path)) throw refused(fmt::format("`{}` is there already", path.string()), "add --force to replace it");
  for (auto const& [path, text] : files) {
    make_folder(path.parent_path());
    write_file(path, text);
    out << path.string() << '\n';
  }
}

std::string equations_latex(ast::File const& file) {
  std::string text;
  for (ast::Item const& item : file.items)
    if (auto const* model = std::get_if<ast::Model>(&item)) text += fmt::format("% {}\n{}\n", model->name.text, latex(*model));
  return text;
}

}  // namespace sysid

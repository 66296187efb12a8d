// Folders to files.
#include "exchange/export_netcdf.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/session/made_from.hpp"
#include "app/session/results.hpp"
#include "core/system/files.hpp"
#include "exchange/inference_data.hpp"
#include "exchange/predictions_data.hpp"
#include "exchange/refused.hpp"
#include "exchange/selection_data.hpp"
#include "exchange/simulated_data.hpp"
#include "report/file/result_files.hpp"
#include "report/file/selection.hpp"
#include "result/selection.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;

/// A file to write.
struct Export {
  fs::path path;
  InferenceData data;
};

fs::path fit_path(StoredResult const& stored) { return stored.folder / exported_file(stored.task(), ".nc"); }

fs::path candidate_path(StoredResult const& stored, std::string const& file_name) {
  return stored.folder / exported_file(stored.task(), ".nc", file_name);
}

/// The index of the task whose results these are. kind: "fit", "selection".
template <class What>
int task_of_kind(Session& session, StoredResult const& stored, char const* kind) {
  int const index = find_task(session, stored);
  if (!std::holds_alternative<What>(session.file.tasks[static_cast<std::size_t>(index)].what))
    throw refused(fmt::format("`{}` is not a {} in `{}`", stored.task(), kind, session.source.name()),
                  "name the .sysid file of these results with --model FILE");
  return index;
}

/// Predictions from the draws of a task that lie beside it, in the order of the file. Those of earlier draws are left out, with a
/// sentence in `omitted`.
std::vector<StoredPrediction> predictions_of(Session const& session, int source, std::vector<std::string>& omitted) {
  std::vector<StoredPrediction> found;
  for (Task const& task : session.file.tasks) {
    auto const* what = std::get_if<PredictTask>(&task.what);
    if (what == nullptr || !complete(session.result_folder(task))) continue;
    if (what->averages()) {
      bool const among =
          std::any_of(what->members.begin(), what->members.end(), [&](PredictTask const& member) { return member.fit == source; });
      if (among) omitted.push_back(fmt::format("{}: it averages over several fits and belongs to none of them", task.name));
      continue;
    }
    if (what->fit != source) continue;
    if (auto const earlier = made_from_earlier(session.result_folder(task))) {
      omitted.push_back(fmt::format("{}: {}", task.name, earlier->message));
      continue;
    }
    found.push_back({task, *what, read_stored_result(session.result_folder(task)).seed()});
  }
  return found;
}

/// Under another name they are a copy, and what lies beside it was predicted from the task's own folder.
bool renamed(StoredResult const& stored, InferenceData& data) {
  if (stored.folder.filename() == stored.task()) return false;
  data.omitted.push_back(fmt::format("predictions: `{}` is a copy, and the predictions stored beside it were made from `{}`",
                                     stored.folder.filename().string(), stored.task()));
  return true;
}

std::vector<Export> selection_exports(StoredResult const& stored, Session* session) {
  std::vector<CandidateData> candidates = stored_candidates(stored);
  if (session != nullptr) {
    int const task = task_of_kind<SelectTask>(*session, stored, "selection");
    add_candidate_data(*session, task, candidates);
    std::vector<std::string> omitted;
    std::vector<StoredPrediction> const predictions = predictions_of(*session, task, omitted);
    for (CandidateData& each : candidates) {
      each.data.omitted.insert(each.data.omitted.end(), omitted.begin(), omitted.end());
      if (!predictions.empty() && !renamed(stored, each.data)) add_predictions(*session, predictions, each.place, each.data);
    }
  }
  std::vector<Export> files;
  for (CandidateData& each : candidates) files.push_back({candidate_path(stored, each.file_name), std::move(each.data)});
  return files;
}

std::string groups_text(InferenceData const& data) {
  std::vector<std::string> names;
  for (NetcdfGroup const& group : data.groups) names.push_back(group.name());
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

InferenceData fit_data(StoredResult const& stored, Session* session, int draws) {
  InferenceData data = stored_inference_data(stored);
  if (session == nullptr) return data;
  int const task = task_of_kind<FitTask>(*session, stored, "fit");
  add_simulated(*session, task, stored, draws, data);
  std::vector<StoredPrediction> const predictions = predictions_of(*session, task, data.omitted);
  if (!predictions.empty() && !renamed(stored, data)) add_predictions(*session, predictions, data);
  return data;
}

void require_exportable(ResultsFolder const& results, bool force) {
  bool any = false;
  for (StoredResult const& stored : results.results) {
    if (results.one_task && stored.is("predict") && stored.summary.contains("average"))
      throw refused(fmt::format("`{}` is an average over several fits, which is not exported", stored.folder.string()),
                    "export the folders of its fits");
    if (results.one_task && stored.is("predict"))
      throw refused(fmt::format("`{}` is a prediction and is exported with its fit", stored.folder.string()),
                    "export the folder of the fit, or of the whole run");
    std::vector<fs::path> paths;
    if (stored.is("fit")) paths.push_back(fit_path(stored));
    if (stored.is("select"))
      for (LivingCandidate const& candidate : living_candidates(stored))
        paths.push_back(candidate_path(stored, candidate.file_name));
    for (fs::path const& path : paths)
      if (!force && fs::exists(path)) throw refused(fmt::format("`{}` exists already", path.string()), "add --force to replace it");
    any = any || !paths.empty();
  }
  if (!any)
    throw refused(
        fmt::format("`{}` contains no draws", results.one_task ? results.results.front().folder.string() : results.run.string()),
        "only a fit or a selection stores draws");
}

void export_netcdf(ResultsFolder const& results, Session* session, int draws, std::ostream& out) {
  for (StoredResult const& stored : results.results) {
    std::vector<Export> files;
    if (stored.is("fit")) files.push_back({fit_path(stored), fit_data(stored, session, draws)});
    if (stored.is("select")) files = selection_exports(stored, session);
    for (Export const& file : files) {
      write_file(file.path, file.data.bytes());
      out << fmt::format("{}: {}\n", file.path.string(), groups_text(file.data));
      for (std::string const& line : file.data.omitted) out << "  left out: " << line << '\n';
    }
  }
}

}  // namespace sysid

// Stan CSV back to draws; decimals were shortest round-trip, so the numbers are the same.
#include "app/session/stored_draws.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/session/repetition.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/solver_record.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "experiment/experiments.hpp"
#include "model/simulated_parameters.hpp"
#include "report/file/csv.hpp"
#include "report/file/number_table.hpp"
#include "report/file/selection.hpp"
#include "report/file/standing_files.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/task_folder.hpp"
#include "result/selection.hpp"

namespace sysid {
std::vector<std::vector<double>> read_draws_rows(std::filesystem::path const& path, std::vector<std::string> const& own,
                                                 std::vector<std::string> const& parameters) {
  NumberTable const table = read_number_table(path);
  std::vector<std::vector<double> const*> columns;
  auto const add = [&](std::string const& name, std::size_t from) {
    columns.push_back(table.find(name, from));
    if (columns.back() == nullptr)
      throw UserError({Severity::error,
                       "E6201",
                       fmt::format("`{}` has no column `{}`: it belongs to another model", path.string(), name),
                       std::nullopt,
                       {},
                       "run the fit again, with --force or another -o"});
  };
  for (std::string const& name : own) add(name, 0);
  // A parameter may have the name of one of the sampler's own.
  for (std::string const& name : parameters) add(stan_name(name), own.size());
  std::vector<std::vector<double>> rows(table.rows());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::vector<double> const* column : columns) rows[r].push_back((*column)[r]);
  return rows;
}

Chain read_chain(std::filesystem::path const& path, std::vector<std::string> const& parameters) {
  Chain chain;
  for (std::vector<double> const& row :
       read_draws_rows(path, {"lp__", "accept_stat__", "log_prior__", "log_likelihood__"}, parameters)) {
    chain.log_density.push_back(row[0]);
    chain.acceptance.push_back(row[1]);
    chain.log_prior.push_back(row[2]);
    chain.log_likelihood.push_back(row[3]);
    chain.values.emplace_back(row.begin() + 4, row.end());
  }
  return chain;
}

FittedModel read_fitted(std::filesystem::path const& folder, std::vector<std::string> const& parameters) {
  FittedModel fitted;
  fitted.draws.names = parameters;
  fitted.draws.parameter_count = static_cast<int>(parameters.size());
  for (int k = 1; std::filesystem::exists(folder / fmt::format("draws_{}.csv", k)); ++k) {
    auto const path = folder / fmt::format("draws_{}.csv", k);
    fitted.draws.chains.push_back(read_chain(path, parameters));
  }
  if (fitted.draws.total() == 0) throw unusable_result(fmt::format("there are no draws in `{}`", folder.string()));
  auto const summary = nlohmann::json::parse(read_summary(folder));
  fitted.solver = interpreted(folder / "summary.json", [&] { return read_solver(summary.at("settings")); });
  return fitted;
}

namespace {

/// " -o DIR", where the results of this run are not where they are without it.
std::string elsewhere(RunOptions const& options) {
  bool const usual = options.temporary_output || options.output == RunOptions().output;
  return usual ? "" : " -o " + quoted_for_shell(options.output.string());
}

/// The folder of a task's complete results; UserError when there are none or they are of another text.
std::filesystem::path stored_results(Session& session, Task const& task, std::string_view verb) {
  auto folder = session.result_folder(task);
  auto const at_task = [&](Diagnostic diagnostic) {
    diagnostic.primary = Label{task.span, {}};
    return diagnostic;
  };
  std::string const there = elsewhere(session.options);
  if (std::filesystem::exists(folder / "checkpoint.cbor"))
    throw UserError(at_task(result_error("E6202", fmt::format("`{}` in `{}` is unfinished", task.name, folder.string()),
                                         {fmt::format("finish it first: sysid {} FILE --resume{}", verb, there),
                                          fmt::format("finish it first: `resume {}`", task.name)})));
  // To force the task that reads the draws would only ask for them again.
  Help const again{fmt::format("run the {0} again first: sysid {0} FILE --force{1}", verb, there),
                   fmt::format("run it again first: `run {}`", task.name)};
  if (!complete(folder))
    throw UserError(at_task(result_error(
        "E6202", fmt::format("there are no draws of `{}` in `{}`", task.name, folder.string()),
        holds_result(folder) ? again
                             : Help{fmt::format("run the {0} first: sysid run FILE{1}, or sysid {0} FILE{1}", verb, there),
                                    fmt::format("run it first: `run {}`", task.name)})));
  std::optional<Diagnostic> wrong;
  try {
    wrong = stored_otherwise(session, task, std::nullopt);
    if (wrong) wrong->code = "E6201";
  } catch (UserError const& error) {
    wrong = error.diagnostic();
  }
  if (wrong) {
    wrong->help = again.command_line;
    wrong->prompt_help = again.prompt;
    throw UserError(at_task(*wrong));
  }
  return folder;
}

std::vector<std::string> names_of(ParameterSpace const& space) {
  std::vector<std::string> names;
  for (ParameterInfo const& parameter : space.infos()) names.push_back(parameter.name);
  return names;
}

}  // namespace

std::vector<SelectedCandidate> const& selected_candidates(Session& session, int select) {
  if (auto const place = session.selected.find(select); place != session.selected.end()) return place->second;
  Task const& task = session.file.tasks[static_cast<std::size_t>(select)];
  SelectTask const& what = std::get<SelectTask>(task.what);
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(what.candidates)];
  auto const folder = stored_results(session, task, "select");
  auto const summary = nlohmann::json::parse(read_summary(folder));
  std::vector<SelectedCandidate> candidates;
  std::vector<std::string> names;
  for (CandidateModel const& each : set.models) names.push_back(each.name);
  std::vector<std::string> const file_names = model_file_names(names);
  for (std::size_t k = 0; k < set.models.size(); ++k) {
    SelectedCandidate candidate;
    std::string const& name = set.models[k].name;
    if (!summary.contains("models") || !summary["models"].contains(name))
      throw UserError({Severity::error,
                       "E6201",
                       fmt::format("`{}` has no model `{}`", (folder / "summary.json").string(), name),
                       std::nullopt,
                       {},
                       "run the selection again, with --force or another -o"});
    candidate.probability =
        interpreted(folder / "summary.json", [&] { return summary.at("models").at(name).value("probability", 0.0); });
    FitTask const& fit = what.fits[k];
    candidate.solver = interpreted(folder / "summary.json", [&] {
      nlohmann::json const& model = summary.at("models").at(name);
      return model.contains("simulated_with") ? read_solver(model.at("simulated_with")) : fit.solver;
    });
    auto const path = folder / model_draws_file(file_names[k]);
    if (std::filesystem::exists(path)) {
      auto const space =
          parameter_space(without_noise_parameters(session.file.models[static_cast<std::size_t>(fit.model)]), fit.experiments);
      candidate.draws.names = names_of(*space);
      candidate.draws.parameter_count = static_cast<int>(candidate.draws.names.size());
      candidate.draws.chains.push_back(read_chain(path, candidate.draws.names));
    }
    candidates.push_back(std::move(candidate));
  }
  return session.selected[select] = std::move(candidates);
}

FittedModel const& fitted_model(Session& session, int fit) {
  if (auto const place = session.fitted.find(fit); place != session.fitted.end()) return place->second;
  Task const& task = session.file.tasks[static_cast<std::size_t>(fit)];
  FitTask const& what = std::get<FitTask>(task.what);
  auto const folder = stored_results(session, task, "fit");
  auto const space = parameter_space(session.file.models[static_cast<std::size_t>(what.model)], what.experiments);
  return session.fitted[fit] = read_fitted(folder, names_of(*space));
}

}  // namespace sysid

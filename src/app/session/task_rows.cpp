// The rows, kind by kind.
#include "app/session/task_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "core/system/digest.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

using Experiments = std::vector<ExperimentUse>;

Model const& model_of(CheckedFile const& file, int index) { return file.models[static_cast<std::size_t>(index)]; }
std::string name_of_model(Session const& session, int index) {
  return fmt::format("model `{}`", model_of(session.file, index).name);
}
std::string digest_of_model(Session const& session, int index) { return model_digest(session, model_of(session.file, index).name); }
std::optional<Diagnostic> never_refused(Session&, Task const&) { return std::nullopt; }
std::vector<int> needs_none(Task const&) { return {}; }

std::vector<ExperimentData> data_of_fit(Session& session, FitTask const& fit) {
  return load_experiments(session, fit.experiments, model_of(session.file, fit.model), fit.start, fit.prediction, fit.solver);
}

namespace simulate {

SimulateTask const& of(Task const& task) { return std::get<SimulateTask>(task.what); }
Experiments experiments(Task const&) { return {}; }
std::vector<TaskData> data(CheckedFile const&, Task const&) { return {}; }
std::string name(Session const& session, Task const& task) { return name_of_model(session, of(task).model); }
std::string digest(Session const& session, Task const& task) { return digest_of_model(session, of(task).model); }

}  // namespace simulate

namespace fit {

FitTask const& of(Task const& task) { return std::get<FitTask>(task.what); }
Experiments experiments(Task const& task) { return of(task).experiments; }
TaskData data_of_one(CheckedFile const& file, FitTask const& what) {
  return {&model_of(file, what.model), &what.experiments, what.start, what.prediction, what.solver};
}
std::vector<TaskData> data(CheckedFile const& file, Task const& task) { return {data_of_one(file, of(task))}; }
std::string name(Session const& session, Task const& task) { return name_of_model(session, of(task).model); }
std::string digest(Session const& session, Task const& task) { return digest_of_model(session, of(task).model); }
std::optional<Diagnostic> refused(Session& session, Task const& task) {
  FitTask const& what = of(task);
  return refusal(task, what, model_of(session.file, what.model), data_of_fit(session, what));
}
std::vector<int> needs(Task const& task) { return of(task).near ? std::vector{*of(task).near} : std::vector<int>(); }

}  // namespace fit

namespace select {

SelectTask const& of(Task const& task) { return std::get<SelectTask>(task.what); }
Experiments experiments(Task const& task) { return of(task).fits.front().experiments; }
std::vector<TaskData> data(CheckedFile const& file, Task const& task) {
  std::vector<TaskData> all;
  for (FitTask const& each : of(task).fits) all.push_back(fit::data_of_one(file, each));
  return all;
}
std::string name(Session const& session, Task const& task) { return name_of_model(session, of(task).fits.front().model); }
std::string digest(Session const& session, Task const& task) {
  std::string all;
  for (FitTask const& each : of(task).fits) all += digest_of_model(session, each.model);
  return sha256(all);
}
std::optional<Diagnostic> refused(Session& session, Task const& task) {
  std::vector<std::vector<ExperimentData>> data;
  for (FitTask const& each : of(task).fits) data.push_back(data_of_fit(session, each));
  return refusal(task, of(task), session.file.models, data);
}

}  // namespace select

namespace discover {

DiscoverTask const& of(Task const& task) { return std::get<DiscoverTask>(task.what); }
CheckedDictionary const& dictionary(CheckedFile const& file, Task const& task) {
  return file.dictionaries[static_cast<std::size_t>(of(task).dictionary)];
}
Experiments experiments(Task const& task) { return of(task).experiments; }
std::vector<TaskData> data(CheckedFile const& file, Task const& task) {
  return {{&dictionary(file, task).measured, &of(task).experiments, {StartRule::Kind::rest, 0}, PredictionRule::as_written, {}}};
}
std::string name(Session const& session, Task const& task) {
  return fmt::format("dictionary `{}`", dictionary(session.file, task).name);
}
std::string digest(Session const& session, Task const& task) {
  return sha256(unparse(ast::File{{dictionary(session.file, task).tree}}));
}
std::optional<Diagnostic> refused(Session& session, Task const& task) {
  std::vector<ExperimentData> const all = load_experiments(session, of(task).experiments, dictionary(session.file, task).measured,
                                                           {StartRule::Kind::rest, 0}, PredictionRule::as_written);
  return refusal(task, of(task), session.file, all);
}

}  // namespace discover

namespace predict {

PredictTask const& of(Task const& task) { return std::get<PredictTask>(task.what); }
Task const& task_at(CheckedFile const& file, int index) { return file.tasks[static_cast<std::size_t>(index)]; }
Task const& subject(CheckedFile const& file, Task const& task) { return task_at(file, of(task).fit); }
Experiments experiments(Task const& task) { return of(task).experiments; }
std::vector<TaskData> data(CheckedFile const& file, Task const& task) {
  PredictTask const& what = of(task);
  std::vector<TaskData> all;
  auto const add = [&](FitTask fitted, std::vector<double> const& input_errors, Experiments const& experiments) {
    Model const& model = model_of(file, fitted.model);
    fitted.input_errors = input_errors;
    all.push_back({&model, &experiments, what.start, rule_of_lags(fitted, model, what.prediction), fitted.solver});
  };
  Task const& from = subject(file, task);
  if (what.averages())
    for (PredictTask const& member : what.members) add(fit::of(task_at(file, member.fit)), member.input_errors, member.experiments);
  else if (kind_of(from) == TaskKind::select)
    for (std::size_t c = 0; c < select::of(from).fits.size(); ++c)
      add(select::of(from).fits[c], what.candidate_input_errors[c], what.candidate_experiments[c]);
  else
    add(fit::of(from), what.input_errors, what.experiments);
  return all;
}
std::string name(Session const& session, Task const& task) {
  Task const& from = subject(session.file, task);
  return task_row(from).name(session, from);
}
std::string digest(Session const& session, Task const& task) {
  std::string all;
  for (PredictTask const& member : of(task).members) all += fit::digest(session, task_at(session.file, member.fit));
  if (!all.empty()) return sha256(all);
  Task const& from = subject(session.file, task);
  return task_row(from).digest(session, from);
}
std::vector<int> needs(Task const& task) {
  std::vector<int> all;
  for (PredictTask const& member : of(task).members) all.push_back(member.fit);
  return all.empty() ? std::vector{of(task).fit} : all;
}

/// What a fit was, or will be, fitted to; nothing where its data are not there, as of a fit whose results are kept.
std::optional<std::vector<std::string>> samples_of(Session& session, FitTask const& what) {
  std::vector<std::string> digests;
  try {
    for (ExperimentData const& each : data_of_fit(session, what))
      digests.push_back(samples_digest(each.experiment, model_of(session.file, what.model)));
  } catch (IoError const&) {  // the fit says so itself
    return std::nullopt;
  } catch (UserError const&) {
    return std::nullopt;
  }
  std::sort(digests.begin(), digests.end());  // fits may name their records in any order
  return digests;
}
std::optional<Diagnostic> refused(Session& session, Task const& task) {
  PredictTask const& what = of(task);
  if (!what.averages() || what.weights == AverageWeights::equal) return std::nullopt;
  Task const& first = subject(session.file, task);
  auto const samples = samples_of(session, fit::of(first));
  for (PredictTask const& member : what.members) {
    Task const& other = task_at(session.file, member.fit);
    auto const own = samples_of(session, fit::of(other));
    if (!samples || !own || own == samples) continue;
    return Diagnostic{
        Severity::error,
        "E6705",
        fmt::format("`{}` and `{}` are fitted to different samples: no weights by {} can be computed", first.name, other.name,
                    title(what.weights)),
        Label{task.span, {}},
        {},
        fmt::format("fit both to the same rows, channels and units, such as `to {}`, and let the rows begin after the "
                    "longest lag of all models; or write `weights = equal`",
                    data_names(session.file, fit::of(first).experiments))};
  }
  return std::nullopt;
}

}  // namespace predict

}  // namespace

std::string predicted_names(CheckedFile const& file, PredictTask const& what) {
  std::string names = predict::task_at(file, what.fit).name;
  for (std::size_t k = 1; k < what.members.size(); ++k) names += ", " + predict::task_at(file, what.members[k].fit).name;
  return names;
}

std::span<TaskRow const> task_rows() {
  static constexpr TaskRow rows[] = {
      {.kind = TaskKind::simulate,
       .experiments = &simulate::experiments,
       .data = &simulate::data,
       .name = &simulate::name,
       .digest = &simulate::digest,
       .refusal = &never_refused,
       .needs = &needs_none},
      {.kind = TaskKind::fit,
       .experiments = &fit::experiments,
       .data = &fit::data,
       .name = &fit::name,
       .digest = &fit::digest,
       .refusal = &fit::refused,
       .needs = &fit::needs},
      {.kind = TaskKind::select,
       .experiments = &select::experiments,
       .data = &select::data,
       .name = &select::name,
       .digest = &select::digest,
       .refusal = &select::refused,
       .needs = &needs_none},
      {.kind = TaskKind::discover,
       .experiments = &discover::experiments,
       .data = &discover::data,
       .name = &discover::name,
       .digest = &discover::digest,
       .refusal = &discover::refused,
       .needs = &needs_none},
      {.kind = TaskKind::predict,
       .experiments = &predict::experiments,
       .data = &predict::data,
       .name = &predict::name,
       .digest = &predict::digest,
       .refusal = &predict::refused,
       .needs = &predict::needs},
  };
  return rows;
}

TaskRow const& task_row(Task const& task) { return row_for(task_rows(), kind_of(task)); }

}  // namespace sysid

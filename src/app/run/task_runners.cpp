// The table of runners.
#include "app/run/task_runners.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "app/average/predict_average.hpp"
#include "app/selection/select.hpp"
#include "app/session/results.hpp"
#include "app/task/tasks.hpp"

namespace sysid {
namespace {

ExitCode simulate(Session& session, int, Task const& task) {
  return run_simulate(session, task, std::get<SimulateTask>(task.what));
}
ExitCode fit(Session& session, int index, Task const& task) { return run_fit(session, index, task, std::get<FitTask>(task.what)); }
ExitCode select(Session& session, int index, Task const& task) {
  return run_select(session, index, task, std::get<SelectTask>(task.what));
}
ExitCode discover(Session& session, int, Task const& task) {
  return run_discover(session, task, std::get<DiscoverTask>(task.what));
}
ExitCode predict(Session& session, int, Task const& task) {
  PredictTask const& what = std::get<PredictTask>(task.what);
  if (what.averages()) return run_predict_average(session, task, what);
  bool const selection = kind_of(session.file.tasks[static_cast<std::size_t>(what.fit)]) == TaskKind::select;
  return (selection ? run_predict_selection : run_predict)(session, task, what);
}

bool has_record(Session const& session, Task const& task) {
  return std::filesystem::exists(session.result_folder(task) / std::get<SimulateTask>(task.what).file);
}
bool has_result(Session const& session, Task const& task) { return complete(session.result_folder(task)); }

/// The name of the first, else the fallback.
template <typename Items>
std::string first_name(Items const& items, std::string const& fallback) {
  return items.empty() ? fallback : items.front().name;
}
std::string model(CheckedFile const& file) { return first_name(file.models, "MODEL"); }
std::string data(CheckedFile const& file) { return first_name(file.data, "DATA"); }

/// With values of the parameters that have none and signals of the inputs, without which it would be refused.
std::string simulate_example(CheckedFile const& file) {
  std::string values, inputs;
  bool plain = true;  // no elements of vectors
  if (!file.models.empty()) {
    Model const& first = file.models.front();
    for (Parameter const& each : first.parameters) {
      if (each.value || each.coefficient) continue;
      plain = plain && each.name.find('[') == std::string::npos;
      values += fmt::format("{}{} = 1", values.empty() ? "" : ", ", each.name);
    }
    for (Quantity const& each : first.inputs) inputs += fmt::format("input {} = gaussian(sd = 1), ", each.name);
  }
  if (!values.empty()) values = fmt::format("values({}), ", plain ? values : "...");
  return fmt::format("truth = simulate {} with {}{}samples = 1000, rate = 1000 [Hz]", model(file), values, inputs);
}
std::string fit_example(CheckedFile const& file) {
  return fmt::format("posterior = fit {} to {} with mh", model(file), data(file));
}
std::string select_example(CheckedFile const& file) {
  return fmt::format("selection = select {} to {} with abc_smc", first_name(file.candidates, model(file)), data(file));
}
std::string discover_example(CheckedFile const& file) {
  return fmt::format("found = discover {} from {}", first_name(file.dictionaries, "DICTIONARY"), data(file));
}
std::string predict_example(CheckedFile const& file) { return fmt::format("forecast = predict posterior on {}", data(file)); }

}  // namespace

std::span<TaskRunner const> task_runners() {
  static constexpr TaskRunner rows[] = {
      {.kind = TaskKind::simulate, .run = &simulate, .complete = &has_record, .example = &simulate_example},
      {.kind = TaskKind::fit, .run = &fit, .complete = &has_result, .example = &fit_example},
      {.kind = TaskKind::select, .run = &select, .complete = &has_result, .example = &select_example},
      {.kind = TaskKind::discover, .run = &discover, .complete = &has_result, .example = &discover_example},
      {.kind = TaskKind::predict, .run = &predict, .complete = &has_result, .example = &predict_example},
  };
  return rows;
}

TaskRunner const& task_runner(TaskKind kind) { return row_for(task_runners(), kind); }

}  // namespace sysid

// Shared state of a run.
#include "app/session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <string>
#include <thread>

#include "core/ranks/ranks.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "model/input_errors.hpp"
#include "model/lags.hpp"

namespace sysid {

std::filesystem::path Session::result_folder(Task const& task) const {
  auto const found = found_in_.find(task.name);
  return found == found_in_.end() ? options.output / task.name : found->second;
}

void Session::find_results_in(std::filesystem::path folder, Task const& task) {
  found_in_[task.name] = std::move(folder);
  int const index = static_cast<int>(&task - file.tasks.data());
  fitted.erase(index);
  selected.erase(index);
}

// Random states are before each sample what the filter makes of those before it: lags stay as they were fitted. In continuous time
// there are none.
PredictionRule rule_of_lags(FitTask const& fit, Model const& model, PredictionRule asked) {
  bool const random = model.filtered() || !fit.input_errors.empty();
  bool const by_equations = model.dynamics == Dynamics::discrete && !random;
  return asked == PredictionRule::one_step && !by_equations ? fit.prediction : asked;
}

std::shared_ptr<CompiledModel const> Session::compiled(FitTask const& fit, bool free_start, std::string const& method,
                                                       PredictionRule prediction) {
  Model const& written = file.models[static_cast<std::size_t>(fit.model)];
  prediction = rule_of_lags(fit, written, prediction);
  auto& place = compiled_[{fit.model, free_start, method, prediction, fit.filter, fit.input_errors}];
  if (!place) {
    auto ruled = with_prediction(written, prediction);
    if (!ruled) throw InternalError("a prediction rule was let through that the model has no data for");
    auto whole = with_input_errors(std::move(*ruled), fit.input_errors);
    if (!std::holds_alternative<Model>(whole))
      throw InternalError("an error of an input was let through that the model cannot have");
    place = compile(std::get<Model>(std::move(whole)), free_start, method, fit.filter);
  }
  return place;
}

std::shared_ptr<CompiledModel const> Session::compiled(FitTask const& fit, std::string const& method) {
  return compiled(fit, fit.start.kind == StartRule::Kind::estimated, method, fit.prediction);
}

Record const& Session::record(int data, Model const& model) {
  auto const found = records_.find({data, &model});
  if (found != records_.end()) return found->second;
  Record read = load_record(file.data[static_cast<std::size_t>(data)], model, folder());
  return records_.emplace(std::pair(data, &model), std::move(read)).first->second;
}

void Session::replace_record(int data, Model const& model, Record record) {
  records_.insert_or_assign(std::pair(data, &model), std::move(record));
}

std::uint64_t Session::seed(Task const& task, std::optional<std::uint64_t> const& stated) {
  if (options.seed) return *options.seed;
  if (stated) return *stated;
  if (!drawn_seed_) {
    // Up to 2^53, so that the printed number may be written into a file as it stands.
    std::random_device device;
    std::uint64_t const drawn = ((static_cast<std::uint64_t>(device()) << 32) | device()) >> 11;
    drawn_seed_ = std::stoull(ranks::from_leader(std::to_string(drawn)));
    notices << fmt::format("{}: seed {} (drawn; repeat this run with --seed {})\n", task.name, *drawn_seed_, *drawn_seed_);
  }
  return *drawn_seed_;
}

std::string Session::describe(int model, Graph const& graph, NodeId node) const {
  return sysid::describe(file.models[static_cast<std::size_t>(model)], graph, node, source);
}

int Session::threads() const {
  return options.execution.threads > 0 ? options.execution.threads
                                       : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

bool Session::interrupted() {
  bool const now = options.interrupt_after != 0 && ++polls_ == options.interrupt_after;
  if (now) request_interrupt();
  return ranks::interrupted(now);
}

ExecutionOptions Session::interruptible() const {
  ExecutionOptions execution = options.execution;
  execution.stopped = &interrupt_requested;
  return execution;
}

ExecutionOptions Session::abandonable() const {
  ExecutionOptions execution = interruptible();
  execution.throws = true;
  return execution;
}

std::vector<ExperimentData> load_experiments(Session& session, std::vector<ExperimentUse> const& uses, Model const& model,
                                             StartRule start, PredictionRule prediction, SolverSettings const& solver) {
  Model const as_predicted = with_prediction(model, prediction).value_or(model);
  std::vector<ExperimentData> all;
  for (ExperimentUse const& use : uses) {
    Record const& record = session.record(use.data, model);
    DataBlock const& block = session.file.data[static_cast<std::size_t>(use.data)];
    all.push_back({use, record, cut(record, block, as_predicted, use.part, start)});
    require_exact_steps(all.back().experiment, block, as_predicted, solver);
  }
  return all;
}

}  // namespace sysid

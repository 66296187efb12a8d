// Reads and cuts the data of every task ahead of the work.
#include "app/readiness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "app/experiments.hpp"
#include "inference/backend.hpp"
#include "model/past.hpp"

namespace sysid {

std::vector<TaskData> data_of(CheckedFile const& file, Task const& task) {
  auto const of_fit = [](FitTask const& fit) { return TaskData{fit.model, &fit.experiments, fit.start, fit.prediction}; };
  std::vector<TaskData> all;
  if (auto const* fit = std::get_if<FitTask>(&task.what)) {
    all.push_back(of_fit(*fit));
  } else if (auto const* selection = std::get_if<SelectTask>(&task.what)) {
    for (FitTask const& fit : selection->fits) all.push_back(of_fit(fit));
  } else if (auto const* prediction = std::get_if<PredictTask>(&task.what)) {
    Task const& subject = file.tasks[static_cast<std::size_t>(prediction->fit)];
    auto const add = [&](int model, std::vector<ExperimentUse> const& experiments) {
      all.push_back({model, &experiments, prediction->start, prediction->prediction});
    };
    if (auto const* selection = std::get_if<SelectTask>(&subject.what))
      for (std::size_t c = 0; c < selection->fits.size(); ++c) add(selection->fits[c].model, prediction->candidate_experiments[c]);
    else
      add(std::get<FitTask>(subject.what).model, prediction->experiments);
  }
  return all;
}

std::optional<Diagnostic> refusal(Task const& task, FitTask const& what, Model const& model,
                                  std::vector<ExperimentData> const& data) {
  auto const refused = [&](std::string code, std::string message, std::string help) {
    return Diagnostic{Severity::error, std::move(code), std::move(message), Label{task.span, {}}, {}, std::move(help)};
  };
  BackendRow const& backend = *find_backend(what.backend);
  if (backend.refuse != nullptr)
    if (std::string const why = backend.refuse(what.settings); !why.empty())
      return refused("E6203", fmt::format("these settings of `{}` do not go together: {}", backend.name, why),
                     "change one of them");
  if (backend.needs.proper_prior)
    for (Parameter const& parameter : model.parameters)
      if (parameter.prior && !parameter.prior->row->proper)
        return refused("E6204",
                       fmt::format("`{}` needs priors that can be drawn from; that of `{}` is {}", backend.name, parameter.name,
                                   parameter.prior->row->name),
                       fmt::format("give `{}` a wide but proper prior, for example log_uniform or normal", parameter.name));
  if (parameter_space(model, what.experiments)->dimension() == 0)
    return refused("E6205", fmt::format("model `{}` has no parameter with a prior: there is nothing to fit", model.name),
                   "replace a fixed value by a prior: `parameter m ~ log_uniform(0.1, 10)`");
  for (ExperimentData const& each : data) {
    Experiment const& experiment = each.experiment;
    bool any = false;
    for (auto const& channel : experiment.measured)
      for (std::size_t i = 0; i < channel.size(); ++i) any = any || (experiment.scored[i] != 0 && !std::isnan(channel[i]));
    if (!any)
      return refused("E4202", fmt::format("there is no measured sample in `{}` to fit to", experiment.name),
                     "choose other rows or columns");
  }
  return std::nullopt;
}

void Readiness::require() const {
  if (diagnostics.all().empty()) return;
  if (unreadable) throw UnreadableData(diagnostics);
  throw UnusableData(diagnostics);
}

Task const* maker(Session const& session, DataBlock const& block) {
  auto const place = [](std::filesystem::path const& path) { return std::filesystem::absolute(path).lexically_normal(); };
  auto const wanted = place(session.folder() / block.path);
  for (Task const& task : session.file.tasks)
    if (auto const* made = std::get_if<SimulateTask>(&task.what);
        made != nullptr && place(session.result_folder(task) / made->file) == wanted)
      return &task;
  return nullptr;
}

Readiness check_readiness(Session& session, std::function<bool(Task const&)> const& wanted) {
  Readiness result;
  bool only_unreadable = true;
  std::set<std::pair<int, int>> left_out;  // data that a message has been said about
  std::set<std::string> said;
  auto const add = [&](Diagnostics const& more, bool unreadable) {
    for (Diagnostic const& each : more.all()) {
      std::string const place = each.primary ? fmt::format("{}:", each.primary->span.begin) : std::string();
      if (!said.insert(place + each.message).second) continue;
      result.diagnostics.add(each);
      only_unreadable = only_unreadable && unreadable;
    }
  };
  auto const add_one = [&](Diagnostic const& diagnostic) {
    Diagnostics one;
    one.add(diagnostic);
    add(one, false);
  };
  for (Task const& task : session.file.tasks) {
    bool complete = true;
    for (TaskData const& data : wanted(task) ? data_of(session.file, task) : std::vector<TaskData>()) {
      auto const as_predicted = with_prediction(session.file.models[static_cast<std::size_t>(data.model)], data.prediction);
      for (ExperimentUse const& use : *data.experiments) {
        DataBlock const& block = session.file.data[static_cast<std::size_t>(use.data)];
        Task const* made = maker(session, block);
        if (left_out.contains({use.data, data.model}) || (made != nullptr && wanted(*made))) {
          complete = false;
          continue;
        }
        try {
          cut(session.record(use.data, data.model), block, *as_predicted, use.part, data.start);
          continue;
        } catch (UnusableData const& error) {
          left_out.insert({use.data, data.model});
          add(error.diagnostics(), false);
        } catch (UnreadableData const& error) {
          left_out.insert({use.data, data.model});
          add(error.diagnostics(), true);
        } catch (UserError const& error) {
          add_one(error.diagnostic());
        }
        complete = false;
      }
    }
    auto const* fit = wanted(task) ? std::get_if<FitTask>(&task.what) : nullptr;
    if (fit == nullptr || !complete) continue;
    if (auto const why = refusal(task, *fit, session.file.models[static_cast<std::size_t>(fit->model)],
                                 load_experiments(session, fit->experiments, fit->model, fit->start, fit->prediction)))
      add_one(*why);
  }
  result.unreadable = only_unreadable;
  return result;
}

}  // namespace sysid

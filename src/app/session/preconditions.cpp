// Reads and cuts the data of every task before the first one runs.
#include "app/session/preconditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "data/record_rows.hpp"
#include "experiment/experiments.hpp"
#include "inference/table.hpp"
#include "likelihood/member_coordinate.hpp"
#include "load/same_on_ranks.hpp"
#include "model/lags.hpp"
#include "model/simulated_parameters.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "regression/column/signals.hpp"

namespace sysid {

namespace {

Diagnostic refused(Task const& task, std::string code, std::string message, std::string help, std::vector<std::string> names) {
  return {Severity::error, std::move(code), std::move(message), Label{task.span, {}}, {}, std::move(help), std::move(names)};
}

Diagnostic refused_settings(Task const& task, std::string_view backend, std::string const& why) {
  return refused(task, "E6203", fmt::format("these settings of `{}` conflict: {}", backend, why), "change one of them",
                 {std::string(backend)});
}

/// of: " of `model`" where there are several. Asked of parameters that have a prior in `model`.
std::optional<Diagnostic> improper_prior(Task const& task, std::string_view backend, Model const& model, std::string const& of) {
  Parameter const* improper = model.improper();
  if (improper == nullptr) return std::nullopt;
  return refused(task, "E6204",
                 fmt::format("`{}` needs proper priors, but the prior of `{}`{} is {}", backend, improper->name, of,
                             improper->prior->row->name),
                 fmt::format("give `{}` a wide but proper prior, for example log_uniform or normal", improper->name),
                 {improper->name, model.name});
}

/// The parameters that these nodes depend on.
std::set<int> parameters_read(Model const& model, std::vector<NodeId> const& nodes) {
  std::set<int> read;
  for (NodeId const id : model.graph.reachable(nodes))
    if (Node const& node = model.graph[id]; node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter)
      read.insert(node.index);
  return read;
}

/// Whether the scale of member `m` vanishes as a coordinate goes there.
bool vanishes(ParameterSpace const& space, std::size_t m, int coordinate, double there) {
  constexpr double small = 1e-6;
  LaneArray theta(space.dimension(), 2), scales(static_cast<int>(space.members().size()), 2);
  for (int p = 0; p < theta.rows(); ++p) theta(p, 0) = theta(p, 1) = 0;
  theta(coordinate, 1) = there;
  space.member_scales(theta, scales);
  auto const row = static_cast<int>(m);
  return std::fabs(scales(row, 1)) < small * std::fabs(scales(row, 0));
}

/// Where all members of a population are equal the likelihood is positive, so that a spread under 1/x, or one that goes to zero as
/// a parameter under `flat` goes to infinity, has no integral, whatever the data. Unless the likelihood vanishes there too: the
/// same parameter is the size of the noise, or goes to infinity in what is measured.                       Gelman 2006
std::optional<Diagnostic> improper_spread(Task const& task, ParameterSpace const& space) {
  constexpr double far_on_line = 500, far_of_logarithm = 55;
  Model const& model = space.model();
  std::vector<NodeId> measured, noise;
  for (State const& state : model.states) measured.insert(measured.end(), {state.derivative, state.initial});
  for (Channel const& channel : model.channels) {
    measured.insert(measured.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
    if (std::optional<NodeId> const scale = scale_argument(channel.noise))
      noise.push_back(*scale);
    else
      noise.insert(noise.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  }
  std::set<int> const by_measured = parameters_read(model, measured), by_noise = parameters_read(model, noise);
  for (std::size_t m = 0; m < space.members().size(); ++m)
    for (int const coordinate : space.members()[m].population) {
      ParameterInfo const& info = space.infos()[static_cast<std::size_t>(coordinate)];
      if (info.improper == Improper::no) continue;
      int const p = space.rows()[static_cast<std::size_t>(space.sampled()[static_cast<std::size_t>(coordinate)])].parameter;
      Parameter const& spread = model.parameters[static_cast<std::size_t>(p)];
      bool const line = info.improper == Improper::line, logarithm = spread.prior->row->name == "log_flat";
      double const far = line ? far_on_line : far_of_logarithm;
      bool const at_low = ((logarithm && !(info.lower > 0) && !by_noise.contains(p)) || (line && !by_measured.contains(p))) &&
                          vanishes(space, m, coordinate, -far);
      bool const open = line || logarithm ? !std::isfinite(info.upper) : true;
      bool const at_high = open && !by_measured.contains(p) && vanishes(space, m, coordinate, far);
      if (!at_low && !at_high) continue;
      return refused(
          task, "E6204",
          fmt::format("`{}` is the spread of a population, or sets it, and with a `{}` prior its posterior is improper: the "
                      "integral of the density is infinite as the spread goes to zero",
                      spread.name, spread.prior->row->name),
          fmt::format("give the spread itself the prior `flat(lower = 0)`, if there are three members or more, or give `{}` "
                      "a proper one such as half_normal",
                      spread.name),
          {spread.name, model.name});
    }
  return std::nullopt;
}

std::optional<Diagnostic> nothing_measured(Task const& task, std::vector<ExperimentData> const& data) {
  for (ExperimentData const& each : data) {
    Experiment const& experiment = each.experiment;
    bool any = false;
    for (auto const& channel : experiment.measured)
      for (std::size_t i = 0; i < channel.size(); ++i) any = any || (experiment.scored[i] != 0 && !std::isnan(channel[i]));
    if (!any)
      return refused(task, "E4202", fmt::format("there is no measured sample in `{}` to fit to", experiment.name),
                     "choose other rows or columns", {experiment.name});
  }
  return std::nullopt;
}

/// A single row has neither a derivative nor an input between two samples. In discrete time the rows before it count as well.
std::optional<Diagnostic> one_row(DiscoverTask const& what, CheckedFile const& file, std::vector<ExperimentData> const& data) {
  if (file.dictionaries[static_cast<std::size_t>(what.dictionary)].numbers.discrete) return std::nullopt;
  for (ExperimentData const& each : data) {
    if (each.use.part < 0 || each.experiment.time.size() > 1) continue;
    DataBlock const& block = file.data[static_cast<std::size_t>(each.use.data)];
    DataPart const& part = block.parts[static_cast<std::size_t>(each.use.part)];
    return Diagnostic{
        Severity::error,
        "E4201",
        fmt::format("range `{}` has 1 row, but a discovery needs at least 2 in each range, for the derivatives", part.name),
        Label{part.span, {}},
        {},
        "use more rows, or leave this range out of the task",
        {part.name}};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Diagnostic> refusal(Task const& task, FitTask const& what, Model const& model,
                                  std::vector<ExperimentData> const& data) {
  BackendRow const& backend = *find_backend(what.backend);
  if (backend.refuse != nullptr)
    if (std::string const why = backend.refuse(what.settings); !why.empty()) return refused_settings(task, backend.name, why);
  // Whether a posterior is proper is looked at far from its mode, where a process costs too much.
  if (backend.needs.proper_prior || !model.processes.empty())
    if (auto const found = improper_prior(task, backend.name, model, {})) return found;
  bool const evidence = what.evidence != EvidenceMethod::automatic && what.evidence != EvidenceMethod::none;
  if (evidence && backend.objective_kind != ObjectiveKind::likelihood)
    if (auto const found = improper_prior(task, fmt::format("evidence = {}", word(what.evidence)), model, {})) return found;
  std::shared_ptr<ParameterSpace const> const space = parameter_space(model, what.experiments);
  if (backend.objective_kind != ObjectiveKind::likelihood)
    if (auto const found = improper_spread(task, *space)) return found;
  if (space->dimension() == 0)
    return refused(task, "E6205", fmt::format("model `{}` has no parameter with a prior: there is nothing to fit", model.name),
                   "replace a fixed value by a prior: `parameter m ~ log_uniform(0.1, 10)`", {model.name});
  return nothing_measured(task, data);
}

std::optional<Diagnostic> refusal(Task const& task, SelectTask const& what, std::vector<Model> const& models,
                                  std::vector<std::vector<ExperimentData>> const& data) {
  SelectorRow const& selector = *find_selector(what.backend);
  if (std::string const why = selector.refuse(what.settings); !why.empty()) return refused_settings(task, selector.name, why);
  bool const by_distance = selector.run != nullptr;
  if (!by_distance && what.distance.stated)
    return refused(task, "E6203", fmt::format("`{}` compares models by their likelihoods and has no distance", selector.name),
                   "remove `distance` and `weights`, or use `abc_smc`", {std::string(selector.name)});
  // The noise has particles in no population, but the searches by likelihood start from draws of it.
  bool const with_noise = !by_distance || what.settings.flag("cross_check") || what.settings.flag("polish");
  for (std::size_t c = 0; c < what.fits.size(); ++c) {
    Model const& model = models[static_cast<std::size_t>(what.fits[c].model)];
    std::string const of = what.fits.size() > 1 ? " of `" + model.name + "`" : std::string();
    if (auto const found = improper_prior(task, selector.name, with_noise ? model : without_noise_parameters(model), of))
      return found;
    if (auto const found = nothing_measured(task, data[c])) return found;
  }
  return std::nullopt;
}

std::optional<Diagnostic> refusal(Task const& task, DiscoverTask const& what, CheckedFile const& file,
                                  std::vector<ExperimentData> const& data) {
  int const derivatives = derivatives_needed(file.dictionaries[static_cast<std::size_t>(what.dictionary)].numbers);
  if (std::string const why = regression::find_form(what.form)->refuse(what.form_settings, derivatives); !why.empty())
    return refused_settings(task, what.form, why);
  if (std::string const why = regression::find_selector(what.selector)->refuse(what.selector_settings); !why.empty())
    return refused_settings(task, what.selector, why);
  return one_row(what, file, data);
}

void Preconditions::require() const {
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

Preconditions check_preconditions(Session& session, std::function<bool(Task const&)> const& wanted) {
  Preconditions result;
  bool only_unreadable = true;
  std::map<int, std::string> digests;               // of the data that were read
  std::set<std::pair<int, Model const*>> reported;  // data that a message has been said about
  auto const add = [&](Diagnostics const& more, bool unreadable) {
    for (Diagnostic const& each : more.all()) {
      auto const& said = result.diagnostics.all();
      if (std::any_of(said.begin(), said.end(), [&](Diagnostic const& other) { return same_matter(other, each); })) continue;
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
    for (TaskData const& data : wanted(task) ? task_row(task).data(session.file, task) : std::vector<TaskData>()) {
      Model const as_predicted = with_prediction(*data.model, data.prediction).value_or(*data.model);
      for (ExperimentUse const& use : *data.experiments) {
        DataBlock const& block = session.file.data[static_cast<std::size_t>(use.data)];
        Task const* made = maker(session, block);
        if (reported.contains({use.data, data.model}) || (made != nullptr && wanted(*made))) {
          complete = false;
          continue;
        }
        try {
          Record const& record = session.record(use.data, *data.model);
          digests[use.data] = record.digest;
          for (DataPart const& part : block.parts)  // no task need read them for them to be wrong
            if (auto const wrong = check_rows(record, "range `" + part.name + "`", {part.first, part.last}, part.span))
              add_one(*wrong);
          cut(record, block, as_predicted, use.part, data.start);
          continue;
        } catch (UnusableData const& error) {
          reported.insert({use.data, data.model});
          add(error.diagnostics(), false);
        } catch (UnreadableData const& error) {
          reported.insert({use.data, data.model});
          add(error.diagnostics(), true);
        } catch (UserError const& error) {
          add_one(error.diagnostic());
        }
        complete = false;
      }
    }
    if (!wanted(task) || !complete) continue;
    if (auto const why = task_row(task).refusal(session, task)) add_one(*why);
  }
  result.unreadable = only_unreadable;
  if (result.diagnostics.all().empty()) require_same_data(session.file, digests);
  return result;
}

Preconditions check_preconditions(Session& session) {
  return check_preconditions(session, [&](Task const& task) {
    auto const* made = std::get_if<SimulateTask>(&task.what);
    return made == nullptr || !std::filesystem::exists(session.result_folder(task) / made->file);
  });
}

}  // namespace sysid

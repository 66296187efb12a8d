// Resolved settings as source text.
#include "app/session/resolved.hpp"
#include "data/start_rule.hpp"

#include <fmt/format.h>

#include <set>

#include "core/text/number.hpp"
#include "experiment/experiments.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
std::string settings_text(std::string const& backend, Settings const& settings) {
  std::string arguments;
  for (auto const& [name, value] : settings.all()) {
    auto const* list = std::get_if<std::vector<double>>(&value);
    if (list == nullptr || !list->empty())  // an empty list has no text
      arguments += fmt::format("{}{} = {}", arguments.empty() ? "" : ", ", name, setting_text(value));
  }
  return arguments.empty() ? backend : fmt::format("{}({})", backend, arguments);
}

std::string search_text(CheckedFile const& file, FitTask const& fit) {
  return fit.near ? fmt::format("near({})", file.tasks[static_cast<std::size_t>(*fit.near)].name) : std::string();
}

namespace {

// The fits, one before the other, near whose draws this one searched.
std::set<Span, bool (*)(Span, Span)> searched_near(CheckedFile const& file, FitTask const& fit) {
  std::set<Span, bool (*)(Span, Span)> spans([](Span a, Span b) { return a.begin < b.begin; });
  for (FitTask const* each = &fit; each->near;) {
    Task const& earlier = file.tasks[static_cast<std::size_t>(*each->near)];
    spans.insert(earlier.span);
    each = &std::get<FitTask>(earlier.what);
  }
  return spans;
}

// The file as written, without its tasks but for those that `fit` refers to.
std::string without_tasks(Session const& session, FitTask const* fit = nullptr) {
  Diagnostics ignored;
  auto tree = parse(session.source, ignored);
  if (!tree) throw InternalError("a checked file does not parse again");
  auto const kept = searched_near(session.file, fit == nullptr ? FitTask() : *fit);
  std::erase_if(tree->items, [&](ast::Item const& item) {
    auto const* task = std::get_if<ast::Task>(&item);
    return task != nullptr && !kept.contains(task->verb.span);
  });
  return unparse(*tree);
}

// A method whose accuracy the run chooses, with its work budget alone.
std::string without_accuracy(SolverSettings const& solver) {
  return solver.fixed_step() ? solver.method : fmt::format("{}(steps = {})", solver.method, solver.steps);
}

// What a fit says of its simulations.
std::string simulation_text(Model const& model, FitTask const& what, std::string const& solver) {
  return fmt::format("start = {}{}{}", start_text(what.start), model.integrated() ? ", solver = " + solver : std::string(),
                     what.prediction == PredictionRule::as_written
                         ? std::string()
                         : fmt::format(", prediction = {}", prediction_name(what.prediction)));
}

}  // namespace

std::string resolved_fit(Session const& session, Task const& task, FitTask const& what, Settings const& settings,
                         SolverSettings const& solver, std::uint64_t seed) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  return fmt::format(
      "# every setting of `{}` spelt out; paths are relative to the folder of the original file\n{}\n{} = fit {} to {} with {}, "
      "{}{}, seed = {}\n",
      task.name, without_tasks(session, &what), task.name, model.name, data_names(session.file, what.experiments),
      settings_text(what.backend, settings), simulation_text(model, what, solver.text()),
      what.near ? ", search = " + search_text(session.file, what) : std::string(), seed);
}

std::string resolved_select(Session const& session, Task const& task, SelectTask const& what, std::uint64_t seed) {
  FitTask const& first = what.fits.front();
  std::string weights;
  for (std::size_t c = 0; c < what.distance.channels.size(); ++c)
    weights += fmt::format("{}{} = {}", c == 0 ? "" : ", ", what.distance.channels[c], what.distance.weights[c]);
  return fmt::format(
      "# every setting of `{}` spelt out; paths are relative to the folder of the original file\n{}\n{} = select {} to {} with {}, "
      "distance = {}, weights({}), {}, seed = {}\n",
      task.name, without_tasks(session), task.name, session.file.candidates[static_cast<std::size_t>(what.candidates)].name,
      data_names(session.file, first.experiments), settings_text(what.backend, what.settings), what.distance.text, weights,
      simulation_text(session.file.models[static_cast<std::size_t>(first.model)], first,
                      first.refine_solver ? without_accuracy(first.solver) : first.solver.text()),
      seed);
}

std::string resolved_discover(Session const& session, Task const& task, DiscoverTask const& what, std::uint64_t seed) {
  std::string selector = settings_text(what.selector, what.selector_settings);
  std::string const derivatives = "derivatives = " + settings_text(what.form, what.form_settings);
  if (selector.ends_with(')'))
    selector.insert(selector.size() - 1, ", " + derivatives);
  else
    selector += "(" + derivatives + ")";
  CheckedDictionary const& dictionary = session.file.dictionaries[static_cast<std::size_t>(what.dictionary)];
  std::string noise;
  for (std::size_t c = 0; c < what.noise.size(); ++c) {
    if (!what.noise[c]) continue;
    Channel const& channel = dictionary.measured.channels[c];
    noise += fmt::format("{}{} = {}{}", noise.empty() ? "" : ", ", channel.name, shortest(channel.from_si(*what.noise[c])),
                         channel.unit ? fmt::format(" [{}]", channel.unit->text) : "");
  }
  return fmt::format(
      "# every setting of `{}` spelt out; paths are relative to the folder of the original file\n{}\n{} = discover {} from {} with "
      "{}, {}top = {}, candidates = {}, refit = {}, seed = {}\n",
      task.name, without_tasks(session), task.name, dictionary.name, data_names(session.file, what.experiments), selector,
      noise.empty() ? "" : fmt::format("noise({}), ", noise), what.top, what.candidates ? "yes" : "no", what.refit ? "yes" : "no",
      seed);
}

}  // namespace sysid

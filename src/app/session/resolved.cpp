// Resolved settings as source text.
#include "app/session/resolved.hpp"
#include "data/start_rule.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>

#include "check/task/select_options.hpp"
#include "core/text/number.hpp"
#include "experiment/experiments.hpp"
#include "inference/table.hpp"
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
  return fmt::format("start = {}{}{}{}", start_text(what.start), model.integrated() ? ", solver = " + solver : std::string(),
                     what.prediction == PredictionRule::as_written
                         ? std::string()
                         : fmt::format(", prediction = {}", prediction_name(what.prediction)),
                     what.filter == FilterRule::automatic
                         ? std::string()
                         : fmt::format(", filter = {}{}", filter_name(what.filter),
                                       what.particles > 0 ? fmt::format(", particles = {}", what.particles) : ""));
}

}  // namespace

std::string resolved_fit(Session const& session, Task const& task, FitTask const& what, Settings const& settings,
                         SolverSettings const& solver, std::uint64_t seed) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  // An accuracy that the run chose is chosen again: a search with it from the beginning would end some digits away.
  std::string const solver_words = what.refine_solver ? without_accuracy(what.solver) : solver.text();
  return fmt::format(
      "# all settings of `{}`, defaults included; paths are relative to the folder of the original file\n{}\n{} = fit {} to {} "
      "with {}, "
      "{}{}{}, seed = {}\n",
      task.name, without_tasks(session, &what), task.name, model.name, data_names(session.file, what.experiments),
      settings_text(what.backend, settings), simulation_text(model, what, solver_words),
      what.near ? ", search = " + search_text(session.file, what) : std::string(),
      what.evidence == EvidenceMethod::automatic ? std::string() : fmt::format(", evidence = {}", word(what.evidence)), seed);
}

std::string resolved_select(Session const& session, Task const& task, SelectTask const& what, std::uint64_t seed) {
  FitTask const& first = what.fits.front();
  return fmt::format(
      "# all settings of `{}`, defaults included; paths are relative to the folder of the original file\n{}\n{} = select {} to {} "
      "with {}, "
      "{}{}, seed = {}\n",
      task.name, without_tasks(session), task.name, session.file.candidates[static_cast<std::size_t>(what.candidates)].name,
      data_names(session.file, first.experiments), settings_text(what.backend, what.settings),
      find_selector(what.backend)->run == nullptr ? std::string() : select_options_text(what) + ", ",
      simulation_text(session.file.models[static_cast<std::size_t>(first.model)], first,
                      first.refine_solver ? without_accuracy(first.solver) : first.solver.text()),
      seed);
}

std::string method_text(CheckedDictionary const& dictionary, DiscoverTask const& what) {
  return dictionary.numbers.discrete ? what.selector : fmt::format("{}, derivatives = {}", what.selector, what.form);
}

std::string resolved_discover(Session const& session, Task const& task, DiscoverTask const& what, std::uint64_t seed) {
  CheckedDictionary const& dictionary = session.file.dictionaries[static_cast<std::size_t>(what.dictionary)];
  std::string selector = settings_text(what.selector, what.selector_settings);
  std::string derivatives = "derivatives = " + settings_text(what.form, what.form_settings);
  if (dictionary.numbers.discrete) {  // settings of the noise stand among those of the selector
    std::string const own = settings_text(what.form, what.form_settings);
    derivatives = own.substr(what.form.size() + 1, own.size() - what.form.size() - 2);
  }
  if (selector.ends_with(')'))
    selector.insert(selector.size() - 1, ", " + derivatives);
  else
    selector += "(" + derivatives + ")";
  std::string noise;
  for (std::size_t c = 0; c < what.noise.size(); ++c) {
    if (!what.noise[c]) continue;
    Channel const& channel = dictionary.measured.channels[c];
    noise += fmt::format("{}{} = {}{}", noise.empty() ? "" : ", ", channel.name, shortest(channel.from_si(*what.noise[c])),
                         channel.unit ? fmt::format(" [{}]", channel.unit->text) : "");
  }
  return fmt::format(
      "# all settings of `{}`, defaults included; paths are relative to the folder of the original file\n{}\n{} = discover {} from "
      "{} with "
      "{}, {}top = {}, candidates = {}, refit = {}, seed = {}\n",
      task.name, without_tasks(session), task.name, dictionary.name, data_names(session.file, what.experiments), selector,
      noise.empty() ? "" : fmt::format("noise({}), ", noise), what.top, what.candidates ? "yes" : "no", what.refit ? "yes" : "no",
      seed);
}

namespace {

namespace fs = std::filesystem;

// How the file at `path` is called from `folder`, which need not be there yet.
std::string path_from(fs::path const& folder, fs::path const& path) {
  return fs::proximate(fs::weakly_canonical(fs::absolute(path)), fs::weakly_canonical(fs::absolute(folder))).generic_string();
}

// The name of the module of each file that the source took in from beside the user's, by the number of the file.
std::map<std::string, int> modules_beside(Source const& source) {
  std::map<std::string, int> found;
  std::string const folder = fs::path(source.name()).parent_path().string();
  for (int f = 1; f < source.files(); ++f)
    if (fs::path const path = source.name(f); path.parent_path().string() == folder && fs::exists(path))
      found.emplace(path.stem().string(), f);
  return found;
}

std::string resolved_module(std::string const& name) { return name.starts_with("resolved_") ? name : "resolved_" + name; }

// A text of the language with data named from `folder`, and modules by the names that they have there.
std::string relocated(std::string const& text, Session const& session, fs::path const& folder,
                      std::map<std::string, int> const& beside) {
  Diagnostics ignored;
  auto tree = parse(Source(session.source.name(), text), ignored);
  if (!tree) throw InternalError("a resolved file does not parse");
  for (ast::Item& item : tree->items) {
    if (auto* use = std::get_if<ast::Use>(&item); use != nullptr && beside.contains(use->module.text))
      use->module.text = resolved_module(use->module.text);
    if (auto* data = std::get_if<ast::Data>(&item))
      for (ast::DataStatement& statement : data->statements)
        if (auto* file = std::get_if<ast::DataFile>(&statement))
          if (fs::path const path = file->path.value; path.is_relative())
            file->path.value = path_from(folder, session.folder() / path);
  }
  return unparse(*tree);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> resolved_files(Session const& session, Task const& task,
                                                                std::string const& resolved) {
  fs::path const folder = session.result_folder(task);
  std::map<std::string, int> const beside = modules_beside(session.source);
  std::string const head =
      fmt::format("# all settings of `{}`, defaults included; paths of data files are relative to this folder\n", task.name);
  std::vector<std::pair<std::string, std::string>> files = {
      {"resolved.sysid", head + relocated(resolved, session, folder, beside)}};
  for (auto const& [name, file] : beside)
    files.emplace_back(resolved_module(name) + ".sysid",
                       relocated(std::string(session.source.text(file)), session, folder, beside));
  return files;
}

}  // namespace sysid

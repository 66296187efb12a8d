// Resolved settings as source text.
#include "app/resolved.hpp"

#include <fmt/format.h>

#include "app/experiments.hpp"
#include "report/number.hpp"
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

std::string start_text(StartRule start) {
  switch (start.kind) {
    case StartRule::Kind::record:
      return "record";
    case StartRule::Kind::rest:
      return "rest";
    case StartRule::Kind::estimated:
      return fmt::format("estimated(rows = {})", start.rows);
  }
  return "?";
}

std::string resolved_fit(Session const& session, Task const& task, FitTask const& what, Settings const& settings,
                         SolverSettings const& solver, std::uint64_t seed) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  Diagnostics ignored;
  auto tree = parse(session.source, ignored);
  if (!tree) throw InternalError("a checked file does not parse again");
  std::erase_if(tree->items, [](ast::Item const& item) { return std::holds_alternative<ast::Task>(item); });
  return fmt::format(
      "# every setting of `{}` spelt out; paths are relative to the folder of the original file\n{}\n{} = fit {} to {} with {}, "
      "start = {}{}{}, seed = {}\n",
      task.name, unparse(*tree), task.name, model.name, data_names(session.file, what.experiments),
      settings_text(what.backend, settings), start_text(what.start),
      model.integrated() ? ", solver = " + solver.text() : std::string(),
      what.prediction == PredictionRule::as_written ? std::string()
                                                    : fmt::format(", prediction = {}", prediction_name(what.prediction)),
      seed);
}

}  // namespace sysid

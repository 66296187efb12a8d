// Provenance: the user's text goes into the report as it stands.
#include "app/session/reporting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/session/made_from.hpp"
#include "app/session/repetition.hpp"
#include "app/session/resolved.hpp"
#include "app/session/results.hpp"
#include "app/session/task_rows.hpp"
#include "app/session/written_model.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "experiment/experiments.hpp"
#include "experiment/prior_density.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/task_folder.hpp"
#include "report/page/terminal.hpp"
#include "syntax/find_model.hpp"
#include "syntax/inserted.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"
#include "typeset/fixed_values.hpp"
#include "typeset/typeset.hpp"

namespace sysid {
namespace {

bool within(Span inner, Span outer) { return inner.begin >= outer.begin && inner.end <= outer.end; }

/// The parameters of the model that are not estimated.
std::vector<FixedValue> fixed_parameters(Report const& report) {
  if (report.selection || report.discovery) return {};
  std::vector<std::string> records;
  for (DataInfo const& each : report.data) records.push_back(each.name.substr(0, each.name.find('.')));
  // The file as it ran has the records too; a prediction has the model alone.
  std::string const& text = report.resolved_text.empty() ? report.model_text : report.resolved_text;
  return fixed_values(text, report.model_name, records);
}

}  // namespace

std::string quoted_for_shell(std::string const& word) {
  bool const plain = !word.empty() && word.front() != '-' && std::all_of(word.begin(), word.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_-./=,+@%:").find(c) != std::string_view::npos;
  });
  if (plain) return word;
  std::string out = word.starts_with('-') ? "'./" : "'";
  for (char const c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string task_digest(Session const& session, Task const& task) { return task_row(task).digest(session, task); }

std::string statement_digest(Session const& session, Task const& task) {
  std::vector<ExperimentUse> const experiments = task_row(task).experiments(task);
  std::string text;
  for (ast::Item const& item : session.file.tree.items) {
    if (auto const* statement = std::get_if<ast::Task>(&item); statement != nullptr && statement->verb.span == task.span)
      text += unparse(ast::File{{*statement}});
    auto const* data = std::get_if<ast::Data>(&item);
    if (data == nullptr) continue;
    for (ExperimentUse const& use : experiments) {
      DataBlock const& block = session.file.data[static_cast<std::size_t>(use.data)];
      if (block.name != data->name.text) continue;
      ast::Data used = *data;
      for (ast::DataStatement& each : used.statements)
        if (auto* split = std::get_if<ast::DataSplit>(&each))
          std::erase_if(split->parts, [&](ast::SplitPart const& part) {
            return use.part < 0 || block.parts[static_cast<std::size_t>(use.part)].name != part.name.text;
          });
      text += unparse(ast::File{{used}});
    }
  }
  return sha256(text);
}

std::string folder_of_repetition(RunOptions const& options) {
  auto again = options.temporary_output ? RunOptions().output : options.output;
  if (!again.has_filename()) again = again.parent_path();
  return quoted_for_shell(again.string() + "_again");
}

void add_repetition(Session const& session, Task const& task, Report& report, Repetition const& repetition) {
  report.place = static_cast<int>(&task - session.file.tasks.data());
  RunOptions const& options = session.options;
  report.command = fmt::format("sysid {} {}{}", repetition.verb, quoted_for_shell(session.source.name()), repetition.options);
  report.unseeded.clear();
  auto const stated = [](Task const& each) { return stated_seed(each).has_value(); };
  std::vector<Task const*> needed = {&task};  // with those whose draws it is made from
  for (std::size_t i = 0; i < needed.size(); ++i)
    for (int const index : task_row(*needed[i]).needs(*needed[i]))
      needed.push_back(&session.file.tasks[static_cast<std::size_t>(index)]);
  bool const all_drawn = std::none_of(needed.begin(), needed.end(), [&](Task const* each) { return stated(*each); });
  if (options.seed || all_drawn) report.command += fmt::format(" --seed {}", report.seed);
  if (!options.seed && !all_drawn)
    for (Task const* each : needed)
      if (!stated(*each)) report.unseeded.push_back(each->name);
  report.command += " -o " + folder_of_repetition(options);
}

Report begin_report(Session const& session, Task const& task, int model_index, std::string what, std::uint64_t seed) {
  Report report;
  report.version = SYSID_VERSION;
  report.task = task.name;
  report.what = std::move(what);
  report.verb = verb_of(task);
  report.seed = seed;
  add_repetition(session, task, report);
  report.timing = {{"file", std::filesystem::absolute(session.source.name()).lexically_normal().string()}};
  Model const& model = session.file.models[static_cast<std::size_t>(model_index)];
  report.model_name = model.name;
  report.model_title = model.title;
  report.versions = {{"sysid", std::string(SYSID_VERSION)},
                     {"random_numbers", std::string("Philox4x64-10")},
                     {"model_sha256", task_digest(session, task)},
                     {"statement_sha256", statement_digest(session, task)}};
  Facts const source = made_from(session, task);
  report.versions.insert(report.versions.end(), source.begin(), source.end());
  ast::Model const* flat = find_model(session.file.tree, model.name);
  if (flat == nullptr) return report;
  report.model_text = std::string(session.source.text(flat->span));
  Diagnostics ignored;
  auto const tree = parse(session.source, ignored);
  ast::Model const* written = tree ? as_written(*tree, flat->span) : nullptr;
  // The user's own statements as they stand there, those of parts with their names in the whole. Parameters have a table.
  auto const add = [&](ast::ModelStatement const& statement) {
    if (has_formula(statement) && !std::holds_alternative<ast::ParameterDeclaration>(statement))
      report.equations.push_back(unparse(statement));
  };
  auto const place = [](ast::ModelStatement const& statement) {
    return std::visit([](auto const& each) { return each.span; }, statement);
  };
  // Of a model with arguments the one that ran, in their numbers; vectors written out are more than a reader can read.
  bool const of_arguments =
      written != nullptr && !written->arguments.empty() && flat->statements.size() <= written->statements.size();
  if (of_arguments) {
    for (ast::ModelStatement const& statement : flat->statements) add(without_idle_terms(statement));
    report.priors = declared_priors(session, model_index);
    return report;
  }
  if (written != nullptr) std::for_each(written->statements.begin(), written->statements.end(), add);
  for (ast::ModelStatement const& statement : flat->statements)
    if (written == nullptr || !within(place(statement), flat->span)) add(statement);
  report.priors = declared_priors(session, model_index);
  return report;
}

void add_prediction_rule(Model const& model, PredictionRule rule, Report& report) {
  report.lags = data_lag(model);
  if (model.dynamics != Dynamics::discrete) return;
  report.prediction_rule = prediction_name(rule);
  report.measured_past = predicts_from_data(model);
}

void add_predicted_rule(Model const& model, PredictionRule rule, Report& report) {
  add_prediction_rule(model, rule, report);
  if (model.dynamics != Dynamics::discrete && model.filtered())
    report.prediction_rule = prediction_name(rule == PredictionRule::one_step ? rule : PredictionRule::free_run);
}

std::vector<PriorInfo> declared_priors(Session const& session, int model_index) {
  Model const& model = session.file.models[static_cast<std::size_t>(model_index)];
  std::vector<PriorInfo> priors;
  ast::Model const* flat = find_model(session.file.tree, model.name);
  if (flat == nullptr) return priors;
  for (ast::ModelStatement const& statement : flat->statements) {
    auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement);
    if (parameter == nullptr || !parameter->prior) continue;
    for (Parameter const& checked : model.parameters)
      if (checked.name == parameter->name.name.text)
        priors.push_back({checked.name,
                          checked.unit_text(),
                          unparse(ast::Expression{{}, ast::Box<ast::Call>(*parameter->prior)}),
                          {},
                          prior_numbers(checked, model)});
  }
  for (PriorInfo& prior : priors) add_density(prior);
  return priors;
}

void keep_result(Session& session, Task const& task, Report& report, std::vector<std::string> const& written) {
  report.formulas = formulas(report.equations);
  report.fixed = fixed_parameters(report);
  if (!report.resolved_text.empty()) report.resolved_files = resolved_files(session, task, report.resolved_text);
  if (files_are_left()) return;
  if (ranks::size() > 1) {
    report.timing.emplace_back("ranks", static_cast<std::int64_t>(ranks::size()));
    report.timing.emplace_back("exchanges", static_cast<std::int64_t>(ranks::exchanges()));
    report.timing.emplace_back("exchange_seconds", ranks::exchange_seconds());
  }
  std::vector<std::string> const undrawn = write_result(report, session.result_folder(task), session.options.pictures(), written);
  session.out << terminal_summary(report, session.options.surface);
  if (!undrawn.empty()) session.notices << fmt::format("{}: {}\n", task.name, undrawn_words(undrawn));
}

std::string model_digest(Session const& session, std::string const& model) {
  ast::Model const* flat = find_model(session.file.tree, model);
  if (flat == nullptr) return {};
  std::string text(session.source.text(flat->span));
  // What the text alone does not say: arguments, parts, modules.
  Diagnostics ignored;
  auto const tree = parse(session.source, ignored);
  ast::Model const* written = tree ? as_written(*tree, flat->span) : nullptr;
  if (written == nullptr || !(*written == *flat)) text += unparse(ast::File{{*flat}});
  return sha256(text);
}

namespace {

std::optional<Diagnostic> otherwise(Session const& session, Task const& task, std::optional<std::uint64_t> seed,
                                    std::string const& verb, nlohmann::json const& summary) {
  auto const folder = session.result_folder(task);
  auto const refuse = [&](std::string const& what) {
    Help help = run_again();
    help.command_line += ", or write elsewhere with -o";
    help.prompt += " or another -o";
    return result_error("E6208", fmt::format("the results in `{}` were computed with another {}", folder.string(), what),
                        std::move(help));
  };
  if (summary.value("verb", "") != verb) return refuse("command");
  if (summary.at("versions").value("model_sha256", "") != task_digest(session, task))
    return refuse("text of " + task_row(task).name(session, task));
  std::vector<ExperimentUse> const experiments = task_row(task).experiments(task);
  auto const stored = summary.value("data", nlohmann::json::array());
  if (stored.size() != experiments.size()) return refuse("set of experiments");
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    DataBlock const& block = session.file.data[static_cast<std::size_t>(experiments[e].data)];
    if (stored[e].value("name", "") != data_name(block, experiments[e].part)) return refuse("set of experiments");
    auto const path = session.folder() / block.path;
    if (std::filesystem::exists(path) && stored[e].value("sha256", "") != sha256(read_regular_file(path)))
      return refuse("content of `" + block.mention() + "`");
  }
  if (seed && summary.value("seed", std::uint64_t{0}) != *seed) return refuse("seed");
  if (summary.at("versions").value("statement_sha256", "") != statement_digest(session, task))
    return refuse("statement, or with other rows");
  return std::nullopt;
}

}  // namespace

std::optional<Diagnostic> stored_otherwise(Session const& session, Task const& task, std::optional<std::uint64_t> seed,
                                           std::string const& verb) {
  auto const folder = session.result_folder(task);
  auto const summary = nlohmann::json::parse(read_whole_summary(folder));
  return interpreted(folder / "summary.json",
                     [&] { return otherwise(session, task, seed, verb.empty() ? verb_of(task) : verb, summary); });
}

void add_timing(Session const& session, std::chrono::steady_clock::time_point began, Report& report) {
  std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began;
  report.timing.emplace_back("wall_seconds", wall.count());
  report.timing.emplace_back("threads", static_cast<std::int64_t>(session.threads()));
  report.timing.emplace_back("lanes", static_cast<std::int64_t>(session.options.execution.lanes));
  report.timing.emplace_back("executor", std::string(name(session.options.execution.executor)));
}

ExitCode keep_complete(Session& session, Task const& task) {
  auto const folder = session.result_folder(task);
  auto verdict = nlohmann::json::object();  // a plain simulation has none
  if (std::filesystem::exists(folder / "summary.json")) {
    auto const summary = nlohmann::json::parse(read_summary(folder));
    verdict = interpreted(folder / "summary.json", [&] { return summary.value("verdict", nlohmann::json::object()); });
  }
  std::string const text = verdict.value("text", std::string());
  session.notices << fmt::format("{}: complete, kept{}{}\n", task.name, text.empty() ? "" : ": ", text);
  return verdict.value("pass", true) ? ExitCode::success : ExitCode::doubtful;
}

}  // namespace sysid

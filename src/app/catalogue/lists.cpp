// Writes the tables of `sysid list` as text.
#include "app/catalogue/lists.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/catalogue/module_page.hpp"
#include "check/dictionary/generators.hpp"
#include "check/elaborate/array_functions.hpp"
#include "core/setting/table.hpp"
#include "data/table/reading_rules.hpp"
#include "distribution/distribution.hpp"
#include "function/table.hpp"
#include "gaussian_process/kernel.hpp"
#include "inference/table.hpp"
#include "load/modules.hpp"
#include "model/disturbance_law.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "solver/solver.hpp"

namespace sysid {
namespace {

std::string signature(DistributionRow const& row) {
  std::string text;
  for (ArgumentRow const& argument : row.arguments) {
    text += text.empty() ? "" : ", ";
    for (std::size_t i = 0; i < argument.spellings.size(); ++i)
      text += fmt::format("{}{}", i == 0 ? "" : "|", argument.spellings[i].name);
  }
  return fmt::format("{}({})", row.name, text);
}

std::string with_settings(std::string_view name, std::string_view summary, std::span<SettingRow const> settings) {
  std::string text = fmt::format("{}: {}\n", name, summary);
  std::size_t width = 10;
  for (SettingRow const& setting : settings) width = std::max(width, setting.name.size());
  for (SettingRow const& setting : settings)
    text += fmt::format("  {:<{}} {:<10} {}\n", setting.name, width, setting.fallback, setting.summary);
  return text;
}

std::string signature(gaussian_process::KernelRow const& row) {
  std::string text;
  for (auto const& each : row.hyper_parameters) text += fmt::format("{}{} = ...", text.empty() ? "" : ", ", each.name);
  return fmt::format("{}({})", row.name, text);
}

std::string list_functions() {
  std::string text;
  for (FunctionRow const& row : functions()) text += fmt::format("{:<12} {}\n", row.name, row.summary);
  for (ArrayFunctionRow const& row : array_functions()) text += fmt::format("{:<12} {}: {}\n", row.name, row.usage, row.summary);
  return text;
}

std::string list_distributions() {
  std::string text;
  for (DistributionRow const& row : distributions())
    text += fmt::format("{:<68} {}{}\n", signature(row), row.summary, row.noise && !row.discrete ? "; also as noise" : "");
  return text;
}

std::string list_disturbances() {
  std::string text;
  for (DisturbanceLawRow const& row : disturbance_laws()) text += fmt::format("{:<38} {}\n", row.usage, row.summary);
  return text + fmt::format("{:<38} {}\n", "normal(0, sd = s)", "in discrete time: samples that are independent of each other");
}

std::string list_kernels() {
  std::string text;
  for (auto const& row : gaussian_process::kernels()) text += fmt::format("{:<68} {}\n", signature(row), row.summary);
  return text;
}

std::string list_backends() {
  std::string text;
  for (BackendRow const& row : backends()) text += with_settings(row.name, row.summary, row.settings);
  for (SelectorRow const& row : selectors()) text += with_settings(row.name, row.summary, row.settings);
  return text;
}

std::string list_discovery() {
  std::string text = "selectors of terms\n\n";
  for (auto const& row : regression::selectors()) text += with_settings(row.name, row.summary, row.settings);
  text += "\nforms of derivatives\n\n";
  for (auto const& row : regression::forms()) text += with_settings(row.name, row.summary, row.settings);
  regression::Form const& samples = regression::form_of_samples();
  text +=
      "\nin discrete time (its setting is written among those of the selector)\n\n" +
      with_settings(samples.name, samples.summary, samples.settings);
  text += "\nfamilies of terms\n\n";
  for (GeneratorRow const& row : generators())
    text += fmt::format("{:<14} {}\n{:<14} {}\n", row.name, row.summary, "", row.option.example);
  return text;
}

std::string list_solvers() {
  std::string text;
  for (SolverRow const& row : solvers()) text += with_settings(row.name, row.summary, row.settings);
  return text;
}

std::string list_reading() {
  std::string text;
  for (ReadingRow const& row : reading_rows())
    text += fmt::format("{:<14} {}\n{:<14} read {}\n", row.name, row.summary, "", row.usage);
  return text;
}

std::string list_modules() {
  std::string text;
  for (LibraryModule const& module : library_modules()) text += fmt::format("{:<14} {}\n", module.name, module_summary(module));
  return text;
}

constexpr ListRow lists_by_topic[] = {{"functions", &list_functions},
                                      {"distributions", &list_distributions},
                                      {"disturbances", &list_disturbances},
                                      {"kernels", &list_kernels},
                                      {"backends", &list_backends},
                                      {"discovery", &list_discovery},
                                      {"solvers", &list_solvers},
                                      {"reading", &list_reading},
                                      {"modules", &list_modules}};

}  // namespace

std::span<ListRow const> lists() { return lists_by_topic; }

ListRow const* find_list(std::string_view topic) { return row_named(lists_by_topic, topic); }

std::string list_topics() {
  std::string text;
  for (ListRow const& row : lists_by_topic)
    text += fmt::format("{}{}", &row == lists_by_topic ? "" : &row == std::end(lists_by_topic) - 1 ? " or " : ", ", row.name);
  return text;
}

}  // namespace sysid

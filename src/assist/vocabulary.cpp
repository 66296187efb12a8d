// Rows of the compiler's tables as words with a signature and a summary.
#include "assist/vocabulary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <sstream>

#include "check/dictionary/generators.hpp"
#include "check/elaborate/array_functions.hpp"
#include "check/task/signal_generators.hpp"
#include "check/task/task_options.hpp"
#include "data/input_rule.hpp"
#include "data/table/reading_rules.hpp"
#include "distribution/distribution.hpp"
#include "function/table.hpp"
#include "gaussian_process/kernel.hpp"
#include "inference/table.hpp"
#include "model/disturbance_law.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "solver/solver.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

using Words = std::vector<Word>;

std::string argument_letters(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{}{}", i == 0 ? "" : ", ", static_cast<char>(count == 1 ? 'x' : 'a' + i));
  return text;
}

Words function_words() {
  Words all;
  for (FunctionRow const& row : functions()) {
    std::string const rest = row.maximum_arguments == std::numeric_limits<int>::max() ? ", ..." : "";
    all.push_back({WordKind::function, std::string(row.name),
                   fmt::format("{}({}{})", row.name, argument_letters(row.minimum_arguments), rest), std::string(row.summary)});
  }
  for (ArrayFunctionRow const& row : array_functions())
    all.push_back({WordKind::function, std::string(row.name), std::string(row.usage), std::string(row.summary)});
  // Not in a table: they are leaves of the graph, not functions of values (check/expression/lags.cpp).
  for (auto const& [name, usage, summary] :
       {std::tuple{"lag", "lag(e, k)", "the value of e, k samples earlier, in discrete time"},
        {"lags", "lags(e, 1..10)", "past samples, as inputs of an unknown function"},
        {"measured", "measured(channel)", "measured samples of the channel"},
        {"predicted", "predicted(channel)", "prediction of the channel"},
        {"residual", "residual(channel)", "measured minus predicted"},
        {"since_last", "since_last(e)", "change of e since the previous row, in continuous time"}})
    all.push_back({WordKind::function, name, usage, summary});
  return all;
}

std::string spellings(ArgumentRow const& argument) {
  std::string text;
  for (Spelling const& spelling : argument.spellings) text += fmt::format("{}{}", text.empty() ? "" : "|", spelling.name);
  return text;
}

Words distribution_words() {
  Words all;
  for (DistributionRow const& row : distributions()) {
    std::string arguments;
    for (ArgumentRow const& argument : row.arguments)
      arguments += fmt::format("{}{}", arguments.empty() ? "" : ", ", spellings(argument));
    all.push_back({WordKind::distribution, std::string(row.name), fmt::format("{}({})", row.name, arguments),
                   std::string(row.summary) + (row.noise && !row.discrete ? "; also as noise" : "")});
  }
  return all;
}

Words kernel_words() {
  Words all;
  for (auto const& row : gaussian_process::kernels()) {
    std::string arguments;
    for (auto const& each : row.hyper_parameters) arguments += fmt::format("{}{} = ...", arguments.empty() ? "" : ", ", each.name);
    all.push_back({WordKind::kernel, std::string(row.name), fmt::format("{}({})", row.name, arguments), std::string(row.summary)});
  }
  return all;
}

Words law_words() {
  Words all;
  for (DisturbanceLawRow const& row : disturbance_laws())
    all.push_back({WordKind::law, std::string(row.name), std::string(row.usage), std::string(row.summary)});
  return all;
}

Words family_words() {
  Words all;
  for (GeneratorRow const& row : generators())
    all.push_back({WordKind::family, std::string(row.name), std::string(row.option.example), std::string(row.summary)});
  return all;
}

Words signal_words() {
  Words all;
  for (std::string const& name : signal_names())
    all.push_back({WordKind::signal, name, fmt::format("{}({})", name, fmt::join(signal_arguments(name), ", ")),
                   "a signal that `simulate` generates for an input"});
  return all;
}

template <class Rows>
Words method_words(WordKind kind, Rows const& rows) {
  Words all;
  for (auto const& row : rows) {
    std::string settings;
    for (SettingRow const& setting : row.settings)
      settings +=
          fmt::format("{}{} = {}", settings.empty() ? "" : ", ", setting.name, setting.fallback.empty() ? "..." : setting.fallback);
    all.push_back({kind, std::string(row.name), fmt::format("{}({})", row.name, settings), std::string(row.summary)});
  }
  return all;
}

Word setting_word(SettingRow const& row) {
  std::string kind = row.kind == SettingKind::word ? std::string(row.choices) : row.kind == SettingKind::flag ? "yes no" : "";
  std::replace(kind.begin(), kind.end(), ' ', '|');
  std::string const fallback = row.fallback.empty() ? "" : fmt::format(", by default {}", row.fallback);
  return {WordKind::setting, std::string(row.name), fmt::format("{} = {}", row.name, kind.empty() ? row.fallback : kind),
          std::string(row.summary) + fallback};
}

/// The settings of a back end, selector of terms, form of derivatives or solver; of a name that models and terms share, both, each
/// once.
std::vector<SettingRow> setting_rows(std::string_view owner) {
  std::vector<SettingRow> all;
  auto const add = [&](auto const* row) {
    if (row == nullptr) return;
    for (SettingRow const& setting : row->settings)
      if (find_setting(all, setting.name) == nullptr) all.push_back(setting);
  };
  add(find_backend(owner));
  add(find_selector(owner));
  add(regression::find_selector(owner));
  add(regression::find_form(owner));
  add(find_solver(owner));
  return all;
}

Words as_choices(std::string_view text) {
  Words all;
  std::istringstream stream{std::string(text)};
  for (std::string choice; stream >> choice;) all.push_back({WordKind::choice, choice, {}, {}});
  return all;
}

}  // namespace

std::vector<Word> const& words_of(WordKind kind) {
  static std::map<WordKind, Words> const all = {
      {WordKind::function, function_words()},
      {WordKind::distribution, distribution_words()},
      {WordKind::kernel, kernel_words()},
      {WordKind::law, law_words()},
      {WordKind::family, family_words()},
      {WordKind::signal, signal_words()},
      {WordKind::fitting, method_words(WordKind::fitting, backends())},
      {WordKind::selecting, method_words(WordKind::selecting, selectors())},
      {WordKind::discovering, method_words(WordKind::discovering, regression::selectors())},
      {WordKind::derivative, method_words(WordKind::derivative, regression::forms())},
      {WordKind::solver, method_words(WordKind::solver, solvers())}};
  static Words const none;
  auto const found = all.find(kind);
  return found == all.end() ? none : found->second;
}

std::vector<Word> settings_of(std::string_view owner) {
  Words all;
  for (SettingRow const& row : setting_rows(owner)) all.push_back(setting_word(row));
  if (regression::find_selector(owner) != nullptr) {
    all.push_back({WordKind::setting, "derivatives", "derivatives = weak", "how derivatives of the record are formed"});
    for (SettingRow const& row : regression::form_of_samples().settings) all.push_back(setting_word(row));
  }
  if (!all.empty()) return all;
  if (DistributionRow const* row = find_distribution(owner)) {
    for (ArgumentRow const& argument : row->arguments)
      for (Spelling const& spelling : argument.spellings)
        all.push_back({WordKind::setting, std::string(spelling.name), fmt::format("{} = ...", spelling.name),
                       fmt::format("argument of {}", owner)});
    for (char const* bound : {"lower", "upper"})
      all.push_back({WordKind::setting, bound, fmt::format("{} = ...", bound), "bound of a prior, which is then normalised"});
  } else if (auto const* kernel = gaussian_process::find_kernel(owner)) {
    for (auto const& each : kernel->hyper_parameters)
      all.push_back({WordKind::setting, std::string(each.name), fmt::format("{} = ...", each.name),
                     each.per_input ? "hyper-parameter, one for each input" : "hyper-parameter"});
  } else if (DisturbanceLawRow const* law = find_disturbance_law(owner)) {
    for (DisturbanceArgumentRow const& each : law->arguments)
      all.push_back(
          {WordKind::setting, std::string(each.name), fmt::format("{} = ...", each.name), fmt::format("argument of {}", owner)});
  } else if (GeneratorRow const* family = find_generator(owner); family != nullptr && !family->option.name.empty()) {
    all.push_back({WordKind::setting, std::string(family->option.name), std::string(family->option.example), {}});
  } else {
    for (std::string const& name : signal_arguments(owner)) all.push_back({WordKind::setting, name, name + " = ...", {}});
    if (owner == "estimated")
      all.push_back({WordKind::setting, "rows", "rows = 50", "number of rows used to estimate the initial state"});
  }
  return all;
}

WordKind backends_of(std::string_view verb) {
  auto const kind = words::task_kind(verb);
  return kind == TaskKind::select ? WordKind::selecting : kind == TaskKind::discover ? WordKind::discovering : WordKind::fitting;
}

std::vector<Word> options_of(std::string_view verb) {
  Words all;
  for (TaskOptionRow const& row : task_options(verb))
    all.push_back({WordKind::option, std::string(row.name), std::string(row.usage), std::string(row.summary)});
  return all;
}

std::vector<Word> reading_settings() {
  Words all;
  for (ReadingRow const& row : reading_rows())
    all.push_back({WordKind::setting, std::string(row.name), std::string(row.usage), std::string(row.summary)});
  return all;
}

std::vector<Word> choices_of(std::string_view owner, std::string_view setting) {
  if (owner == "read") {
    ReadingRow const* const row = find_reading(setting);
    return row == nullptr ? Words() : as_choices(row->choices);
  }
  if (setting == "hold") {
    Words all;
    for (InputRuleRow const& row : input_rules()) all.push_back({WordKind::choice, std::string(row.name), {}, {}});
    return all;
  }
  if (setting == "derivatives") return words_of(WordKind::derivative);
  std::vector<SettingRow> const rows = setting_rows(owner);
  if (SettingRow const* row = find_setting(rows, setting))
    return as_choices(row->kind == SettingKind::flag ? "yes no" : row->choices);
  if (setting == "solver") return words_of(WordKind::solver);
  for (TaskOptionRow const& row : task_options(owner))
    if (row.name == setting) return as_choices(row.choices);
  return {};
}

Word const* find_word(WordKind kind, std::string_view name) {
  for (Word const& word : words_of(kind))
    if (word.name == name) return &word;
  return nullptr;
}

}  // namespace sysid::assist

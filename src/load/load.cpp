// parse, modules, elaborate, check: one line each.
#include "load/load.hpp"

#include <algorithm>

#include "check/independent.hpp"
#include "inference/table.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "syntax/parse.hpp"

namespace sysid {
namespace {

template <class Rows>
std::vector<BackendSettings> settings_of(Rows const& all) {
  std::vector<BackendSettings> rows;
  for (auto const& row : all) rows.push_back({.name = row.name, .settings = row.settings});
  return rows;
}

std::vector<BackendSettings> fitting_backends() {
  std::vector<BackendSettings> rows;
  for (BackendRow const& row : backends())
    rows.push_back({.name = row.name,
                    .settings = row.settings,
                    .optimum = row.objective_kind != ObjectiveKind::posterior,
                    .prior = row.objective_kind != ObjectiveKind::likelihood,
                    .estimates = !row.needs.exact_likelihood});
  return rows;
}

std::vector<BackendSettings> selecting_backends() {
  std::vector<BackendSettings> rows;
  for (SelectorRow const& row : selectors())
    rows.push_back({.name = row.name, .settings = row.settings, .distances = row.run != nullptr});
  return rows;
}

/// As though each of these blocks had a `file` line.
void add_file_lines(ast::File& tree, DataAtHand const& at_hand) {
  for (ast::Item& item : tree.items) {
    auto* const data = std::get_if<ast::Data>(&item);
    if (data == nullptr || !at_hand(data->name.text)) continue;
    bool const named = std::any_of(data->statements.begin(), data->statements.end(),
                                   [](ast::DataStatement const& each) { return std::holds_alternative<ast::DataFile>(each); });
    if (!named) data->statements.emplace_back(ast::DataFile{{data->name.span}, {{data->name.span}, {}}});
  }
}

}  // namespace

std::optional<CheckedFile> load(Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved, DataAtHand const& at_hand) {
  ReadableFile read = parse_readable(source, diagnostics);
  if (!read.tree) return std::nullopt;
  if (at_hand) add_file_lines(*read.tree, at_hand);
  bool const complete = !diagnostics.has_errors();
  Diagnostics found;  // behind the syntax
  auto const modules = load_modules(*read.tree, source, found, unsaved);
  auto const fitting = fitting_backends(), selecting = selecting_backends();
  auto const discovering = settings_of(regression::selectors()), derivatives = settings_of(regression::forms());
  regression::Form const& samples = regression::form_of_samples();
  std::optional<CheckedFile> file;
  if (!found.has_errors())
    file = check(elaborate(*read.tree, modules, found),
                 {fitting, selecting, discovering, derivatives, {.name = samples.name, .settings = samples.settings}}, found);
  if (!complete) keep_independent(*read.tree, read.unread, source, found);
  for (Diagnostic const& each : found.all()) diagnostics.add(each);
  return complete ? std::move(file) : std::nullopt;
}

}  // namespace sysid

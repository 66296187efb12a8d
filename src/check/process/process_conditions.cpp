// Reads the points of `zero_at` and `flat_at`, with their units.
#include "check/process/process_conditions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "check/expression/leaves.hpp"
#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "check/units/units.hpp"

namespace sysid {
namespace {

ast::List const* as_list(ast::Expression const& tree) {
  auto const* list = std::get_if<ast::Box<ast::List>>(&tree.node);
  return list == nullptr ? nullptr : &**list;
}

class PointReader {
 public:
  PointReader(Scope& scope, ast::ProcessDefinition const& definition, std::string name,
              std::vector<std::vector<int>> const& columns, Process const& process)
      : scope_(scope), definition_(definition), name_(std::move(name)), columns_(columns), process_(process) {}

  /// False after a diagnostic.
  bool points(ast::Expression const& tree) {
    ast::List const* const list = as_list(tree);
    bool const several =
        list != nullptr && !list->items.empty() && (columns_.size() == 1 || as_list(list->items.front()) != nullptr);
    if (!several) return point(tree);
    return std::all_of(list->items.begin(), list->items.end(), [&](ast::Expression const& item) { return point(item); });
  }
  std::vector<std::vector<double>> const& found() const { return found_; }

 private:
  bool refuse(Diagnostic diagnostic) {
    scope_.diagnostics().add(std::move(diagnostic));
    return false;
  }

  bool point(ast::Expression const& tree) {
    found_.emplace_back(process_.inputs.size());
    if (columns_.size() == 1) return coordinates(columns_.front(), tree);
    ast::List const* const list = as_list(tree);
    std::size_t const given = list == nullptr ? 1 : list->items.size();
    if (given != columns_.size())
      return refuse(errors::condition_count(tree.span, name_, definition_.name.text, given, columns_.size()));
    for (std::size_t i = 0; i < given; ++i)
      if (!coordinates(columns_[i], list->items[i])) return false;
    return true;
  }

  /// Of one declared input.
  bool coordinates(std::vector<int> const& columns, ast::Expression const& tree) {
    ast::List const* const list = as_list(tree);
    if (list != nullptr && list->items.size() != columns.size())
      return refuse(errors::condition_count(tree.span, name_, definition_.name.text, list->items.size(), columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (!coordinate(static_cast<std::size_t>(columns[k]), list == nullptr ? tree : list->items[k])) return false;
    return true;
  }

  bool coordinate(std::size_t column, ast::Expression const& tree) {
    auto const value = scope_.expression(tree);
    if (!value || value->kind == Typed::Kind::wrong) return false;
    std::optional<Unit> const& wanted = process_.inputs[column].unit;
    if (value->kind == Typed::Kind::known && wanted)
      if (auto wrong = refuse_number(tree.span, errors::named(name_), value->unit, *wanted)) return refuse(std::move(*wrong));
    Graph& graph = scope_.graph();
    auto const number = graph.constant_value(adapt(graph, with_own_unit(*value), wanted));
    if (!number) {
      std::string const what = moving_part(graph, value->node);
      return refuse(errors::condition_moves(tree.span, name_, what.empty() ? "a parameter" : what));
    }
    if (!std::isfinite(*number)) return refuse(errors::condition_moves(tree.span, name_, "a number that is not finite"));
    found_.back()[column] = *number;
    return true;
  }

  Scope& scope_;
  ast::ProcessDefinition const& definition_;
  std::string name_;
  std::vector<std::vector<int>> const& columns_;
  Process const& process_;
  std::vector<std::vector<double>> found_;
};

}  // namespace

bool read_conditions(Scope& scope, ast::ProcessDefinition const& definition, ProcessArguments const& arguments,
                     std::vector<std::vector<int>> const& columns, Process& process) {
  for (auto const& [name, argument] : arguments.named) {
    bool const slope = name == "flat_at";
    if (!slope && name != "zero_at") continue;
    if (slope)
      for (KernelUse const& kernel : process.kernels)
        if (!kernel.row->differentiable) {
          scope.diagnostics().add(errors::condition_without_derivative(argument->span, std::string(kernel.row->name)));
          return false;
        }
    PointReader reader(scope, definition, name, columns, process);
    if (!reader.points(argument->value)) return false;
    for (std::vector<double> const& point : reader.found()) {
      if (!slope) process.conditions.push_back({point, -1});
      for (int d = 0; slope && d < static_cast<int>(point.size()); ++d) process.conditions.push_back({point, d});
    }
  }
  return true;
}

}  // namespace sysid

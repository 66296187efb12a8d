// Expressions over results: a parameter is its draws, a channel its samples, and what is made of them is computed draw by draw or
// sample by sample, with the language's own functions and units.
#pragma once
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/numeric/unit.hpp"
#include "core/text/diagnostic.hpp"
#include "repl/result.hpp"
#include "syntax/ast.hpp"

namespace sysid::repl {

struct Quantity {
  enum class Kind { number, draws, rows };
  Kind kind = Kind::number;
  std::vector<double> values;            // SI; of a number one
  std::optional<Unit> unit;              // in which it is shown; absent: unknown
  std::string label;                     // "k/m"
  std::string of;                        // the task whose draws, or task and experiment whose rows they are
  std::vector<std::size_t> chains;       // draws of each chain
  std::optional<double> sd;              // SI: Laplace's, of the one draw of an optimum
  RecordSeries const* record = nullptr;  // of rows

  /// In `unit`.
  double shown(double si) const { return unit ? si / unit->scale : si; }
  std::vector<double> all_shown() const;
  std::string unit_text() const;
};

/// Why two quantities of several values do not go together one by one: only draws of one fit do, and samples of one record.
std::optional<std::string> unpaired(Quantity const& a, Quantity const& b);

/// Message and help about a quantity of one value that is asked for its scatter.
std::pair<std::string, std::string> without_draws(Quantity const& quantity);

class Evaluator {
 public:
  /// results: the oldest first; a plain name is looked for in the newest that has it, `first.k` in that of the task. functions: of
  /// the file.
  Evaluator(std::deque<Result> const& results, std::vector<ast::FunctionDefinition const*> functions, Diagnostics& diagnostics)
      : results_(results), functions_(std::move(functions)), diagnostics_(diagnostics) {}

  /// Nothing when a diagnostic was added.
  std::optional<Quantity> value(ast::Expression const& tree);
  /// The result of a task; null for any other name.
  Result const* result(std::string_view task) const;

 private:
  std::optional<Quantity> named(ast::Reference const& reference);
  std::optional<Quantity> series(ast::Call const& call);
  std::optional<Quantity> statistic(ast::Call const& call);
  /// The channel or quantity of that name along a record, newest first, or of the task before the dot.
  std::pair<RecordSeries const*, SeriesColumn const*> along_record(std::string const& path, std::string* of) const;
  /// Calls and names that only the prompt knows replaced by names of `found`.
  bool resolve(ast::Expression& tree, std::vector<Quantity>& found);
  /// A name that no result has.
  void refuse_unknown(ast::Reference const& reference, Span span);
  std::optional<Unit> unit(std::string const& text) const;
  std::vector<std::string> known_names() const;
  void refuse(Span span, std::string message, std::string help = {});

  std::deque<Result> const& results_;
  std::vector<ast::FunctionDefinition const*> functions_;
  Diagnostics& diagnostics_;
};

}  // namespace sysid::repl

// The same regression under other inputs; only its residual is looked at.
#include "regression/input_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "linear_algebra/decompositions.hpp"
#include "regression/column/signals.hpp"

namespace sysid::regression {
namespace {

constexpr double clearly_less = 0.8;
constexpr Eigen::Index parts = 16;  // of the rows
constexpr double steady = 3.2;      // t with 15 degrees of freedom

/// Of least squares on these terms; empty where the columns have rows or numbers that it cannot use.
Eigen::VectorXd residual_of(Columns const& columns, std::vector<int> const& terms) {
  Eigen::MatrixXd chosen(columns.terms.rows(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t k = 0; k < terms.size(); ++k) {
    auto const column = columns.terms.col(terms[k]);
    double const length = column.norm();
    if (!(length > 0) || !std::isfinite(length)) return {};
    chosen.col(static_cast<Eigen::Index>(k)) = column / length;
  }
  if (chosen.rows() < chosen.cols() || !columns.known.allFinite()) return {};
  return columns.known - chosen * OrthogonalTriangular(chosen).solve(columns.known);
}

/// Whether the squares fall in all parts of the record.
bool everywhere(Eigen::VectorXd const& before, Eigen::VectorXd const& after) {
  Eigen::VectorXd fall = Eigen::VectorXd::Zero(parts);
  for (Eigen::Index r = 0; r < before.size(); ++r) fall(r * parts / before.size()) += before(r) * before(r) - after(r) * after(r);
  double const mean = fall.mean();
  return mean > steady * std::sqrt((fall.array() - mean).square().sum() / static_cast<double>(parts * (parts - 1)));
}

struct InputsRead {
  std::set<int> any, rates;
};

InputsRead inputs_of(Dictionary const& dictionary, Equation const& equation) {
  std::vector<NodeId> roots = {equation.known};
  for (Term const& term : equation.terms) roots.push_back(term.expression);
  InputsRead read;
  for (Symbol const& symbol : symbols_below(dictionary, roots)) {
    if (symbol.kind != Symbol::Kind::input) continue;
    read.any.insert(symbol.index);
    if (symbol.order > 0) read.rates.insert(symbol.index);
  }
  return read;
}

/// The experiments with one input under another rule; nothing where none changes or one cannot.
std::optional<std::vector<Experiment>> under(std::span<Experiment const> experiments, int input, InputRule rule) {
  std::vector<Experiment> changed(experiments.begin(), experiments.end());
  bool any = false;
  for (Experiment& each : changed) {
    InputSignal& signal = each.inputs[static_cast<std::size_t>(input)];
    if (signal.rule() == rule) continue;
    auto other = signal.under(rule);
    if (!other) return std::nullopt;
    signal = std::move(*other);
    any = true;
  }
  return any ? std::optional(std::move(changed)) : std::nullopt;
}

/// The first that an experiment has in place of `rule`.
std::optional<InputRule> another_rule(std::span<Experiment const> experiments, int input, InputRule rule) {
  for (Experiment const& each : experiments)
    if (InputRule const own = each.inputs[static_cast<std::size_t>(input)].rule(); own != rule) return own;
  return std::nullopt;
}

Concern concern_of(int input, InputRule stated, InputRule rule, double ratio) {
  Concern concern{.kind = Concern::Kind::other_rule, .value = ratio};
  concern.input = input;
  concern.rule = rule;
  concern.clause = fmt::format("with `hold {}` in place of `hold {}` the residual of all terms is {:.2g} times smaller",
                               rule_name(rule), rule_name(stated), 1 / std::sqrt(ratio));
  return concern;
}

}  // namespace

std::optional<Concern> better_rule(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                                   int equation, Columns const& columns, FoundEquation const& found) {
  Equation const& stated = dictionary.equations[static_cast<std::size_t>(equation)];
  std::vector<int> used;
  for (std::size_t j = 0; j < found.terms.size(); ++j)
    if (!found.terms[j].excluded) used.push_back(static_cast<int>(j));
  Dictionary alone = dictionary;  // the other equations need not be projected again
  alone.equations = {stated};
  auto const residual = [&](std::span<Experiment const> on) {
    std::unique_ptr<Projection> const projection = method.form->project(alone, on, method.form_settings);
    return any_fatal(projection->concerns(0)) ? Eigen::VectorXd() : residual_of(projection->columns(0), used);
  };
  InputsRead const read = inputs_of(dictionary, stated);
  if (read.any.empty()) return std::nullopt;
  Eigen::VectorXd const before = residual_of(columns, used);
  double least = clearly_less;
  std::optional<Concern> best;
  for (int const input : read.any)
    for (InputRuleRow const& row : input_rules()) {
      if (!row.has_rate && read.rates.contains(input)) continue;
      auto const changed = under(experiments, input, row.rule);
      if (!changed) continue;
      Eigen::VectorXd const after = residual(*changed);
      if (after.size() != before.size() || before.size() < 2 * parts) continue;
      double const ratio = after.squaredNorm() / before.squaredNorm();
      if (!(ratio < least) || !everywhere(before, after)) continue;
      least = ratio * clearly_less;  // of rules that are as good, the simpler
      best = concern_of(input, *another_rule(experiments, input, row.rule), row.rule, ratio);
    }
  return best;
}

}  // namespace sysid::regression

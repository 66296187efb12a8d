// Names to columns; statistics by hand, everything else by the checker's expressions.
#include "repl/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "check/scope.hpp"
#include "check/walk.hpp"
#include "inference/convergence.hpp"
#include "repl/workbench.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid::repl {
namespace {

constexpr PromptFunction statistic_rows[] = {
    {"mean", "mean(k)", "mean over draws, or over the samples of a record"},
    {"sd", "sd(k)", "standard deviation; of an optimum Laplace's"},
    {"median", "median(k)", "the value that half of the draws lie below"},
    {"quantile", "quantile(k, 0.95)", "the value below which that part of the draws lies"},
    {"min", "min(k)", "the smallest draw or sample"},
    {"max", "max(k)", "the largest draw or sample"},
    {"rms", "rms(residual(output))", "root of the mean square"},
    {"corr", "corr(k, k3)", "correlation of two quantities, draw by draw or sample by sample"},
    {"probability", "probability(k3 > 0)", "the part of the draws for which a comparison holds"},
    {"count", "count(k)", "how many draws or samples there are"},
};

constexpr PromptFunction series_rows[] = {
    {"measured", "measured(output)", "the samples of a channel on the rows that were fitted or predicted"},
    {"predicted", "predicted(output)", "the mean prediction of a channel there, without noise"},
    {"residual", "residual(output)", "what was measured less what was predicted"},
};

PromptFunction const* find(std::span<PromptFunction const> rows, std::string_view name) {
  auto const place = std::find_if(rows.begin(), rows.end(), [&](PromptFunction const& each) { return each.name == name; });
  return place == rows.end() ? nullptr : &*place;
}

/// `min(a)` is a statistic, `min(a, b)` the language's.
bool is_statistic(ast::Call const& call) {
  if (find(statistic_rows, call.function.text) == nullptr) return false;
  return (call.function.text != "min" && call.function.text != "max") || call.arguments.size() == 1;
}

std::string path_of(ast::Reference const& reference) {
  std::string path = reference.name.text;
  if (!reference.index.empty()) {
    path += '[';
    for (std::size_t i = 0; i < reference.index.size(); ++i) path += (i == 0 ? "" : ",") + unparse(reference.index[i]);
    path += ']';
  }
  return path + std::string(static_cast<std::size_t>(reference.primes), '\'');
}

std::vector<double> finite(std::vector<double> const& values) {
  std::vector<double> kept;
  std::copy_if(values.begin(), values.end(), std::back_inserter(kept), [](double each) { return std::isfinite(each); });
  return kept;
}

double mean(std::vector<double> const& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double sum_of_products(std::vector<double> const& a, std::vector<double> const& b) {
  double const mean_a = mean(a), mean_b = mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum;
}

std::string article(Quantity::Kind kind) { return kind == Quantity::Kind::draws ? "draws" : "rows of a record"; }

}  // namespace

std::span<PromptFunction const> statistics() { return statistic_rows; }
std::span<PromptFunction const> series_functions() { return series_rows; }

std::vector<double> Quantity::all_shown() const {
  std::vector<double> result;
  for (double const each : values) result.push_back(shown(each));
  return result;
}

std::string Quantity::unit_text() const {
  if (!unit || (unit->dimensionless() && unit->scale == 1)) return "";
  return unit->text.empty() ? format_dimension(unit->dimension) : unit->text;
}

void Evaluator::refuse(Span span, std::string message, std::string help) {
  diagnostics_.add({Severity::error, "", std::move(message), Label{span, {}}, {}, std::move(help)});
}

Result const* Evaluator::result(std::string_view task) const {
  for (Result const& each : results_)
    if (each.task == task) return &each;
  return nullptr;
}

std::optional<Unit> Evaluator::unit(std::string const& text) const {
  if (text.empty()) return std::nullopt;
  Diagnostics ignored;
  auto const tree = parse_expression(Source("", "1 [" + text + "]"), ignored);
  auto const* number = tree ? std::get_if<ast::Number>(&tree->node) : nullptr;
  return number != nullptr && number->unit ? check_unit(*number->unit, ignored) : std::nullopt;
}

std::vector<std::string> Evaluator::known_names() const {
  std::vector<std::string> names;
  for (Result const& each : results_) {
    names.push_back(each.task);
    for (DrawColumn const& column : each.draws) names.push_back(column.name);
    for (RecordSeries const& record : each.records)
      for (SeriesColumn const& column : record.quantities) names.push_back(column.name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::pair<RecordSeries const*, SeriesColumn const*> Evaluator::along_record(std::string const& path, std::string* of) const {
  auto const look = [&](Result const& result, std::string_view name) -> std::pair<RecordSeries const*, SeriesColumn const*> {
    for (RecordSeries const& record : result.records)
      for (SeriesColumn const& column : record.quantities)
        if (column.name == name) {
          if (of != nullptr) *of = result.task + " " + record.experiment;
          return {&record, &column};
        }
    return {};
  };
  auto const dot = path.find('.');
  if (dot != std::string::npos)
    if (Result const* result = this->result(path.substr(0, dot))) return look(*result, path.substr(dot + 1));
  for (auto each = results_.rbegin(); each != results_.rend(); ++each)
    if (auto const found = look(*each, path); found.first != nullptr) return found;
  return {};
}

std::optional<Quantity> Evaluator::named(ast::Reference const& reference) {
  std::string const path = path_of(reference);
  auto const draws_of = [&](Result const& result, std::string_view name) -> std::optional<Quantity> {
    DrawColumn const* column = result.find_draws(name);
    if (column == nullptr || column->values.empty()) return std::nullopt;
    Quantity quantity{Quantity::Kind::draws, {}, unit(column->unit), path, result.task, result.chains, {}, nullptr};
    double const scale = quantity.unit ? quantity.unit->scale : 1;
    for (double const each : column->values) quantity.values.push_back(each * scale);
    if (column->sd) quantity.sd = *column->sd * scale;
    return quantity;
  };
  auto const dot = path.find('.');
  if (dot != std::string::npos)
    if (Result const* result = this->result(path.substr(0, dot)))
      if (auto found = draws_of(*result, path.substr(dot + 1))) return found;
  for (auto each = results_.rbegin(); each != results_.rend(); ++each)
    if (auto found = draws_of(*each, path)) return found;
  std::string of;
  if (auto const [record, column] = along_record(path, &of); record != nullptr) {
    Quantity quantity{Quantity::Kind::rows, {}, unit(column->unit), path, of, {}, {}, record};
    for (double const each : column->mean) quantity.values.push_back(each * (quantity.unit ? quantity.unit->scale : 1));
    return quantity;
  }
  if (path == "t" || path == "time")
    for (auto each = results_.rbegin(); each != results_.rend(); ++each)
      if (!each->records.empty()) {
        RecordSeries const& record = each->records.front();
        return Quantity{
            Quantity::Kind::rows, record.time, unit(record.unit), path, each->task + " " + record.experiment, {}, {}, &record};
      }
  return std::nullopt;
}

std::optional<Quantity> Evaluator::series(ast::Call const& call) {
  auto const* channel = call.arguments.size() == 1 ? std::get_if<ast::Reference>(&call.arguments[0].value.node) : nullptr;
  std::string const& what = call.function.text;
  if (channel == nullptr) {
    refuse(call.span, fmt::format("`{}` takes the name of a channel", what),
           fmt::format("for example `{}`", find(series_rows, what)->usage));
    return std::nullopt;
  }
  std::string const path = path_of(*channel);
  std::string of;
  auto const [record, column] = along_record(path, &of);
  if (record == nullptr) {
    refuse(channel->span, fmt::format("no result has a channel `{}`", path), did_you_mean(path, known_names()));
    return std::nullopt;
  }
  if (column->measured.empty() && what != "predicted") {
    refuse(channel->span, fmt::format("`{}` is not measured", path),
           "the states of a model and its derived quantities are predicted alone");
    return std::nullopt;
  }
  Quantity quantity{Quantity::Kind::rows, {}, unit(column->unit), fmt::format("{}({})", what, path), of, {}, {}, record};
  double const scale = quantity.unit ? quantity.unit->scale : 1;
  for (std::size_t i = 0; i < record->time.size(); ++i) {
    bool const scored = i < record->scored.size() && record->scored[i] != 0;
    double const each = what == "measured"    ? column->measured[i]
                        : what == "predicted" ? column->mean[i]
                                              : column->measured[i] - column->mean[i];
    // Rows before the scored ones bring the model into the record's state.
    quantity.values.push_back(scored ? each * scale : std::nan(""));
  }
  return quantity;
}

std::optional<Quantity> Evaluator::statistic(ast::Call const& call) {
  std::string const& name = call.function.text;
  std::size_t const wanted = name == "corr" || name == "quantile" ? 2 : 1;
  if (call.arguments.size() != wanted ||
      std::any_of(call.arguments.begin(), call.arguments.end(), [](auto const& each) { return each.name; })) {
    refuse(call.span, fmt::format("`{}` takes {}", name, wanted == 1 ? "one argument" : "two arguments"),
           fmt::format("for example `{}`", find(statistic_rows, name)->usage));
    return std::nullopt;
  }
  auto const of = value(call.arguments[0].value);
  if (!of) return std::nullopt;
  Quantity result{Quantity::Kind::number, {}, of->unit, "", of->of, {}, {}, nullptr};
  std::vector<double> values = finite(of->values);
  if (values.empty()) {
    refuse(call.arguments[0].span, "there is no number in this");
    return std::nullopt;
  }
  Span const where = call.arguments[0].span;
  bool const one_draw = of->kind != Quantity::Kind::rows && of->values.size() == 1;
  auto const needs_draws = [&] {
    if (!one_draw) return false;
    refuse(where,
           of->kind == Quantity::Kind::number ? "this is one number"
                                              : fmt::format("`{}` is an optimum, one point: it has no draws", of->of),
           of->kind == Quantity::Kind::number ? "" : "fit with mh for draws");
    return true;
  };
  if (name == "mean") {
    result.values = {mean(values)};
  } else if (name == "sd") {
    if (!of->sd && needs_draws()) return std::nullopt;
    result.values = {
        of->sd ? *of->sd
               : std::sqrt(sum_of_products(values, values) / static_cast<double>(std::max<std::size_t>(values.size() - 1, 1)))};
  } else if (name == "median") {
    result.values = {quantile(values, 0.5)};
  } else if (name == "quantile") {
    auto const p = value(call.arguments[1].value);
    if (!p || needs_draws()) return std::nullopt;
    if (p->values.size() != 1 || !(p->values[0] >= 0 && p->values[0] <= 1)) {
      refuse(call.arguments[1].span, "a quantile is asked for by a part between 0 and 1", "for example `quantile(k, 0.95)`");
      return std::nullopt;
    }
    result.values = {quantile(values, p->values[0])};
  } else if (name == "min" || name == "max") {
    result.values = {name == "min" ? *std::min_element(values.begin(), values.end())
                                   : *std::max_element(values.begin(), values.end())};
  } else if (name == "rms") {
    double sum = 0;
    for (double const each : values) sum += each * each;
    result.values = {std::sqrt(sum / static_cast<double>(values.size()))};
  } else if (name == "corr") {
    auto const other = value(call.arguments[1].value);
    if (!other || needs_draws()) return std::nullopt;
    if (other->values.size() != of->values.size() || other->kind != of->kind) {
      refuse(call.span,
             fmt::format("`{}` has {} {}, `{}` has {}", of->label, of->values.size(), article(of->kind), other->label,
                         other->values.size()),
             "correlation pairs draws of one fit, or samples of one record");
      return std::nullopt;
    }
    std::vector<double> a, b;
    for (std::size_t i = 0; i < of->values.size(); ++i)
      if (std::isfinite(of->values[i]) && std::isfinite(other->values[i]))
        a.push_back(of->values[i]), b.push_back(other->values[i]);
    result.values = {sum_of_products(a, b) / std::sqrt(sum_of_products(a, a) * sum_of_products(b, b))};
    result.unit = Unit{};
  } else if (name == "probability") {
    if (needs_draws()) return std::nullopt;
    if (std::any_of(values.begin(), values.end(), [](double each) { return each != 0 && each != 1; })) {
      refuse(where, "a probability is that of a comparison", "for example `probability(k3 > 0)`");
      return std::nullopt;
    }
    result.values = {mean(values)};
    result.unit = Unit{};
  } else {
    result.values = {static_cast<double>(values.size())};
    result.unit = Unit{};
  }
  return result;
}

bool Evaluator::resolve(ast::Expression& tree, std::vector<Quantity>& found) {
  auto const put = [&](Quantity quantity) {
    quantity.label = unparse(tree);
    ast::Reference reference;
    reference.span = tree.span;
    reference.name.span = tree.span;
    // Of two places that read alike one stands for both.
    reference.name.text = quantity.label;
    auto const same = std::find_if(found.begin(), found.end(), [&](Quantity const& each) { return each.label == quantity.label; });
    if (same == found.end()) found.push_back(std::move(quantity));
    tree.node = std::move(reference);
  };
  if (auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) {
    bool const along = find(series_rows, (*call)->function.text) != nullptr;
    if (along || is_statistic(**call)) {
      auto quantity = along ? series(**call) : statistic(**call);
      if (quantity) put(std::move(*quantity));
      return quantity.has_value();
    }
  }
  if (auto const* reference = std::get_if<ast::Reference>(&tree.node)) {
    if (reference->name.text == "pi" || reference->name.text == "inf") return true;
    if (auto quantity = named(*reference)) {
      put(std::move(*quantity));
      return true;
    }
    std::string const path = path_of(*reference);
    std::vector<std::string> names = known_names();
    for (CommandRow const& row : commands()) names.emplace_back(row.name);  // a command misspelt reads like a quantity
    std::string const near = did_you_mean(path, names);
    if (results_.empty())
      refuse(tree.span, fmt::format("there is no `{}`: no task has been run yet", path),
             !near.empty() ? near : "expressions at the prompt are over results; run a fit first");
    else if (result(path) != nullptr)
      refuse(tree.span, fmt::format("`{}` is a task, not a number", path),
             fmt::format("`{}.NAME` is one of its quantities, `show {}` all of it", path, path));
    else
      refuse(tree.span, fmt::format("no result has a `{}`", path), near);
    return false;
  }
  bool sound = true;
  std::visit(
      [&](auto& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          sound = resolve(*node->operand, found);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          sound = resolve(*node->left, found);
          sound = resolve(*node->right, found) && sound;
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          for (ast::Argument& argument : node->arguments) sound = resolve(argument.value, found) && sound;
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          sound = resolve(*node->condition, found);
          sound = resolve(*node->then, found) && sound;
          sound = resolve(*node->otherwise, found) && sound;
        }
      },
      tree.node);
  return sound;
}

std::optional<Quantity> Evaluator::value(ast::Expression const& tree) {
  ast::Expression resolved = tree;
  std::vector<Quantity> found;
  if (!resolve(resolved, found)) return std::nullopt;
  std::string const label = unparse(tree);
  if (found.size() == 1 && std::holds_alternative<ast::Reference>(resolved.node)) return found.front();
  Quantity result;
  result.values.resize(1);
  for (Quantity const& each : found) {
    if (each.kind == Quantity::Kind::number || each.values.size() == 1) {
      if (result.kind == Quantity::Kind::number && each.kind == Quantity::Kind::draws)
        result.kind = each.kind, result.chains = each.chains;
      continue;
    }
    bool const first = result.values.size() == 1;
    if (!first && (each.kind != result.kind || each.values.size() != result.values.size())) {
      refuse(tree.span,
             fmt::format("{} of {} and {} of {} do not go together one by one", article(result.kind), result.of, article(each.kind),
                         each.of),
             "take `mean`, `sd` or another number of each");
      return std::nullopt;
    }
    if (!first) continue;
    result.kind = each.kind;
    result.of = each.of;
    result.chains = each.chains;
    result.record = each.record;
    result.values.resize(each.values.size());
  }
  std::size_t const before = diagnostics_.all().size();
  Graph graph;
  Scope scope(graph, diagnostics_, functions_);
  for (std::size_t i = 0; i < found.size(); ++i)
    scope.declare({{tree.span}, found[i].label}, {ParameterSymbol{static_cast<int>(i)}, found[i].unit, tree.span});
  auto const typed = scope.expression(resolved);
  if (!typed || diagnostics_.has_errors(before)) return std::nullopt;
  for (std::size_t j = 0; j < result.values.size(); ++j)
    result.values[j] = graph.evaluate(typed->node, [&](NodeId leaf) {
      std::vector<double> const& values = found[static_cast<std::size_t>(graph[leaf].index)].values;
      return values.size() == 1 ? values[0] : values[j];
    });
  result.label = label;
  if (typed->kind == Typed::Kind::known) result.unit = typed->unit;
  if (typed->kind == Typed::Kind::literal) result.unit = Unit{};
  // A unit without a name is shown in the SI.
  if (result.unit && result.unit->text.empty()) result.unit->scale = 1;
  return result;
}

}  // namespace sysid::repl

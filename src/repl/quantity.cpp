// Names to columns; statistics by their table, everything else by the checker's expressions.
#include "repl/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/expression/scope.hpp"
#include "repl/commands.hpp"
#include "repl/statistics.hpp"
#include "repl/workbench.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid::repl {
namespace {

template <class Row>
Row const* find(std::span<Row const> rows, std::string_view name) {
  auto const place = std::find_if(rows.begin(), rows.end(), [&](Row const& each) { return each.name == name; });
  return place == rows.end() ? nullptr : &*place;
}

/// What prompts of other languages call a statistic or a plot, as it is written here; empty for all else.
std::string in_our_words(ast::Call const& call) {
  constexpr std::pair<std::string_view, std::string_view> words[] = {{"hist", "plot(histogram({}))"},
                                                                     {"density", "plot(histogram({}))"},
                                                                     {"std", "sd({})"},
                                                                     {"stdev", "sd({})"},
                                                                     {"stddev", "sd({})"},
                                                                     {"var", "sd({})^2"},
                                                                     {"variance", "sd({})^2"},
                                                                     {"average", "mean({})"},
                                                                     {"avg", "mean({})"},
                                                                     {"percentile", "quantile({})"},
                                                                     {"cor", "corr({})"},
                                                                     {"correlation", "corr({})"},
                                                                     {"length", "count({})"},
                                                                     {"traceplot", "plot(trace({}))"},
                                                                     {"prob", "probability({})"},
                                                                     {"residuals", "residual({})"},
                                                                     {"print", "{}"},
                                                                     {"disp", "{}"},
                                                                     {"display", "{}"},
                                                                     {"help", "help"},
                                                                     {"exit", "quit"},
                                                                     {"quit", "quit"},
                                                                     {"who", "list"}};
  std::string arguments;
  for (ast::Argument const& each : call.arguments) arguments += (arguments.empty() ? "" : ", ") + unparse(each.value);
  for (auto const& [foreign, ours] : words)
    if (call.function.text == foreign) return fmt::format(fmt::runtime(ours), arguments);
  return {};
}

/// `min(a)` is a statistic, `min(a, b)` the language's.
bool is_statistic(ast::Call const& call) {
  if (find(statistics(), call.function.text) == nullptr) return false;
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

std::string article(Quantity::Kind kind) { return kind == Quantity::Kind::draws ? "draws" : "rows of a record"; }

}  // namespace

std::optional<std::string> unpaired(Quantity const& a, Quantity const& b) {
  bool const rows = a.kind == Quantity::Kind::rows && b.kind == a.kind;
  bool const same = rows ? a.record != nullptr && b.record != nullptr && a.record->experiment == b.record->experiment &&
                               a.record->time == b.record->time
                         : a.kind == b.kind && a.of == b.of;
  if (same && a.values.size() == b.values.size()) return std::nullopt;
  return fmt::format("{} of {} and {} of {} cannot be combined element by element", article(a.kind), a.of, article(b.kind), b.of);
}

std::pair<std::string, std::string> without_draws(Quantity const& quantity) {
  if (quantity.kind == Quantity::Kind::number) return {"this is one number", ""};
  return {fmt::format("`{}` is an optimum, a single point without draws", quantity.of), "fit with mh to get draws"};
}

std::vector<double> Quantity::all_shown() const {
  std::vector<double> result;
  for (double const each : values) result.push_back(shown(each));
  return result;
}

std::string Quantity::unit_text() const {
  if (!unit || (unit->dimensionless() && unit->scale == 1)) return "";
  return unit->text_or_dimension();
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
           fmt::format("for example `{}`", find(series_functions(), what)->usage));
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
    refuse(channel->span, fmt::format("`{}` is not measured", path), "states and derived quantities are only predicted");
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
  StatisticRow const& row = *find(statistics(), call.function.text);
  if (call.arguments.size() != row.arguments ||
      std::any_of(call.arguments.begin(), call.arguments.end(), [](auto const& each) { return each.name; })) {
    refuse(call.span, fmt::format("`{}` takes {}", row.name, row.arguments == 1 ? "one argument" : "two arguments"),
           fmt::format("for example `{}`", row.usage));
    return std::nullopt;
  }
  std::vector<Quantity> of;
  for (ast::Argument const& argument : call.arguments) {
    auto each = value(argument.value);
    if (!each) return std::nullopt;
    if (finite(each->values).empty()) {
      refuse(argument.span, "this expression contains no number");
      return std::nullopt;
    }
    of.push_back(std::move(*each));
  }
  auto const result =
      row.value({of[0], finite(of[0].values), of.size() > 1 ? &of[1] : nullptr, call,
                 [&](Span span, std::string message, std::string help) { refuse(span, std::move(message), std::move(help)); }});
  if (!result) return std::nullopt;
  return Quantity{Quantity::Kind::number, {*result}, row.pure ? Unit{} : of[0].unit, "", of[0].of, {}, {}, nullptr};
}

void Evaluator::refuse_unknown(ast::Reference const& reference, Span span) {
  std::string const path = path_of(reference);
  std::vector<std::string> names = known_names();
  for (CommandRow const& row : commands()) names.emplace_back(row.name);  // a command misspelt reads like a quantity
  std::string near = did_you_mean(path, names);
  if (std::string const ours = instead_of_command(path); !ours.empty())
    near = nearest(path, known_names()).empty() ? ours : fmt::format("{} for the command: {}", near, ours);
  if (find(series_functions(), path) != nullptr) near = fmt::format("write `{}(CHANNEL)`", path);
  auto const* text = reference.index.size() == 1 ? std::get_if<ast::Text>(&reference.index.front().node) : nullptr;
  if (text != nullptr) near = fmt::format("write `{}.{}`", reference.name.text, text->value);
  if (results_.empty())
    refuse(span, fmt::format("there is no `{}`: no task has been run yet", path),
           !near.empty() ? near : "expressions at the prompt use results; run a fit first");
  else if (result(path) != nullptr)
    refuse(span, fmt::format("`{}` is a task, not a quantity", path),
           fmt::format("`{}.NAME` is one of its quantities; `show {}` shows all of it", path, path));
  else
    refuse(span, fmt::format("no result has a `{}`", path), near);
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
    if (std::string const ours = in_our_words(**call); !ours.empty()) {
      refuse((*call)->function.span, fmt::format("there is no function `{}`", (*call)->function.text),
             fmt::format("write `{}`", ours));
      return false;
    }
    bool const along = find(series_functions(), (*call)->function.text) != nullptr;
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
    refuse_unknown(*reference, tree.span);
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
        result.kind = each.kind, result.chains = each.chains, result.of = each.of;
      continue;
    }
    bool const first = result.values.size() == 1;
    if (!first) {
      auto const why = unpaired(result, each);
      if (!why) continue;
      refuse(tree.span, *why, "reduce each to one number, with `mean`, `sd` or another statistic");
      return std::nullopt;
    }
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

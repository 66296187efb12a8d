// Expressions over results: a number, a summary of many, or a plot.
#include "repl/answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "diagnostics/convergence.hpp"
#include "repl/commands.hpp"
#include "repl/quantity.hpp"
#include "report/text/summary_text.hpp"
#include "syntax/unparse.hpp"

namespace sysid::repl {
namespace {

constexpr int digits = 6;

std::string with_unit(std::string const& number, std::string const& unit) {
  return unit.empty() ? number : fmt::format("{} [{}]", number, unit);
}

std::string described(Quantity const& quantity) {
  std::string const unit = quantity.unit_text();
  std::vector<double> const values = quantity.all_shown();
  if (values.size() == 1) {
    std::string const sd = quantity.sd ? fmt::format(" \u00b1 {}", significant(quantity.shown(*quantity.sd), 2)) : "";
    return with_unit(significant(values[0], digits) + sd, unit);
  }
  if (quantity.kind == Quantity::Kind::draws) {
    ChainValues chains;
    std::size_t at = 0;
    for (std::size_t const length : quantity.chains) {
      chains.emplace_back(values.begin() + static_cast<std::ptrdiff_t>(at),
                          values.begin() + static_cast<std::ptrdiff_t>(at + length));
      at += length;
    }
    SummaryText const text = format_summary(summarise(quantity.label, unit, chains));
    return fmt::format("{}, 90 % between {} and {} ({} draws of {})", with_unit(text.mean + " \u00b1 " + text.sd, unit), text.q5,
                       text.q95, values.size(), quantity.of);
  }
  double sum = 0, squares = 0, low = std::nan(""), high = low;
  int count = 0;
  for (double const each : values) {
    if (!std::isfinite(each)) continue;
    ++count;
    sum += each;
    squares += each * each;
    low = std::isnan(low) ? each : std::min(low, each);
    high = std::isnan(high) ? each : std::max(high, each);
  }
  return fmt::format("{} samples along {}: between {} and {}, rms {}", count, quantity.of, significant(low, 4),
                     with_unit(significant(high, 4), unit),
                     with_unit(significant(std::sqrt(squares / std::max(count, 1)), 4), unit));
}

AxisName axis_of(Quantity const& quantity) { return {quantity.label, quantity.unit_text()}; }

std::vector<double> numbers_up_to(std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t i = 1; i <= count; ++i) numbers.push_back(static_cast<double>(i));
  return numbers;
}

/// A series against its time.
std::string along_time(Quantity const& quantity, PlotSize size) {
  RecordSeries const* record = quantity.record;
  std::vector<double> const time = record != nullptr ? record->time : numbers_up_to(quantity.values.size());
  return plot_curves({{time, quantity.all_shown(), true}},
                     record != nullptr ? AxisName{record->axis, record->unit} : AxisName{"row", ""}, axis_of(quantity), size);
}

/// Draws one after another.
std::string along_draws(Quantity const& quantity, PlotSize size) {
  std::vector<Curve> curves;
  curves.push_back({numbers_up_to(quantity.values.size()), quantity.all_shown(), true});
  return plot_curves(curves, {quantity.chains.size() > 1 ? "draw, one chain after the other" : "draw", ""}, axis_of(quantity),
                     size);
}

std::string plot_result(Result const& result, PlotSize plot_size) {
  constexpr std::size_t most_rows = 200;  // more are a black band
  for (RecordSeries const& record : result.records)
    for (SeriesColumn const& quantity : record.quantities) {
      if (quantity.measured.empty()) continue;
      Curve measured{{}, {}, false}, predicted{{}, {}, true};
      for (std::size_t i = 0; i < record.time.size() && predicted.x.size() < most_rows; ++i) {
        if (record.scored[i] == 0) continue;
        for (auto* curve : {&measured, &predicted}) curve->x.push_back(record.time[i]);
        measured.y.push_back(quantity.measured[i]);
        predicted.y.push_back(quantity.mean[i]);
      }
      return fmt::format("{} on {}: measured (dots) and predicted (line), the first {} rows\n{}", quantity.name, record.experiment,
                         predicted.x.size(),
                         plot_curves({predicted, measured}, {record.axis, record.unit}, {quantity.name, quantity.unit}, plot_size));
    }
  return "";
}

std::optional<std::string> plot(ast::Call const& call, PlotSize plot_size, Evaluator& evaluator, Diagnostics& diagnostics) {
  auto const refuse = [&](Span span, std::string message, std::string help) -> std::optional<std::string> {
    diagnostics.add({Severity::error, "", std::move(message), Label{span, {}}, {}, std::move(help)});
    return std::nullopt;
  };
  std::string const examples =
      "plot(trace(k)), plot(histogram(k)), plot(k, k3), plot(residual(output)), plot(posterior), plot(DATA)";
  auto const& arguments = call.arguments;
  if (arguments.empty() || arguments.size() > 2)
    return refuse(call.span, "`plot` takes one quantity, or two to plot against each other", examples);
  std::string drawn;
  if (arguments.size() == 2) {
    auto const x = evaluator.value(arguments[0].value), y = evaluator.value(arguments[1].value);
    if (!x || !y) return std::nullopt;
    for (Quantity const* each : {&*x, &*y})
      if (each->values.size() < 2) {
        auto const [message, help] = without_draws(*each);
        return refuse(arguments[each == &*x ? 0 : 1].value.span, message, help);
      }
    if (auto const why = unpaired(*x, *y))
      return refuse(call.span, *why, "both must be draws of one fit, or samples of one record");
    drawn = plot_curves({{x->all_shown(), y->all_shown(), false}}, axis_of(*x), axis_of(*y), plot_size);
  } else {
    ast::Expression const& what = arguments[0].value;
    auto const* name = std::get_if<ast::Reference>(&what.node);
    if (name != nullptr && name->index.empty() && evaluator.result(name->name.text) != nullptr) {
      drawn = plot_result(*evaluator.result(name->name.text), plot_size);
    } else {
      auto const* inner = std::get_if<ast::Box<ast::Call>>(&what.node);
      bool const trace = inner != nullptr && (*inner)->function.text == "trace" && (*inner)->arguments.size() == 1;
      bool const histogram = inner != nullptr && (*inner)->function.text == "histogram" && (*inner)->arguments.size() == 1;
      auto const quantity = evaluator.value(trace || histogram ? (*inner)->arguments[0].value : what);
      if (!quantity) return std::nullopt;
      if (quantity->values.size() < 2) {
        auto const [message, help] = without_draws(*quantity);
        return refuse(what.span, message, help.empty() ? examples : help + ", or plot(residual(CHANNEL)), plot(FIT)");
      }
      if (trace)
        drawn = quantity->kind == Quantity::Kind::rows ? along_time(*quantity, plot_size) : along_draws(*quantity, plot_size);
      else if (histogram || quantity->kind == Quantity::Kind::draws)
        drawn = plot_histogram(quantity->all_shown(), axis_of(*quantity), plot_size);
      else
        drawn = along_time(*quantity, plot_size);
    }
  }
  if (drawn.empty()) return refuse(call.span, "there are no finite values to plot", examples);
  return drawn;
}

bool has_quantity(TaskResults const& results, std::string const& name) {
  return std::any_of(results.all.begin(), results.all.end(), [&](Result const& each) {
    bool found = each.find_draws(name) != nullptr;
    for (RecordSeries const& record : each.records)
      for (SeriesColumn const& column : record.quantities) found = found || column.name == name;
    return found;
  });
}

/// What is meant by the call whose argument is no result, but a model, a data block or a channel of one.
std::optional<Diagnostic> instead_of_result(Context const& context, ast::Call const& call) {
  auto const* name = call.arguments.size() == 1 ? std::get_if<ast::Reference>(&call.arguments[0].value.node) : nullptr;
  if (name == nullptr || !context.work.checked || has_quantity(context.results, name->name.text)) return std::nullopt;
  std::string const& text = name->name.text;
  auto const refused = [&](std::string message, std::string help) {
    return Diagnostic{Severity::error, "", std::move(message), Label{name->name.span, {}}, {}, std::move(help)};
  };
  auto const& file = context.work.checked->file;
  for (DataBlock const& block : file.data) {
    if (block.name == text)
      return refused(fmt::format("`{}` is a data block, not a result", text),
                     fmt::format("`plot({0})` draws its channels; `show {0}` lists them", text));
    bool const measured =
        std::any_of(block.measured.begin(), block.measured.end(), [&](DataMeasureUse const& each) { return each.channel == text; });
    if (measured && call.function.text == "plot")
      return refused(fmt::format("no result has a `{}`", text), fmt::format("its samples: `plot({}.{})`", block.name, text));
  }
  for (Model const& model : file.models)
    if (model.name == text)
      return refused(fmt::format("`{}` is a model, not a result", text),
                     fmt::format("`show {}` shows it; fit it to data first", text));
  return std::nullopt;
}

/// False where the call names no data block, or a result or a quantity of one is called so.
bool plot_raw(Context const& context, ast::Call const& call, Evaluator const& evaluator, Diagnostics& diagnostics,
              std::optional<std::string>& said) {
  auto const* name = call.arguments.size() == 1 ? std::get_if<ast::Reference>(&call.arguments[0].value.node) : nullptr;
  if (name == nullptr || !name->index.empty() || name->primes > 0) return false;
  std::string const& text = name->name.text;
  if (evaluator.result(text.substr(0, text.find('.'))) != nullptr || has_quantity(context.results, text)) return false;
  try {
    said = plot_columns(context, text, name->name.span);
    if (said && said->empty()) {
      said.reset();
      diagnostics.add({Severity::error, "", "there are no finite values to plot", Label{name->name.span, {}}, {}, {}});
      return true;
    }
  } catch (UserError const& error) {
    diagnostics.add(error.diagnostic());
    return true;
  }
  return said.has_value();
}

}  // namespace

bool answer(Context& context, ast::Expression const& tree, std::string const& text) {
  Diagnostics diagnostics;
  std::vector<ast::FunctionDefinition const*> functions;
  if (context.work.checked)
    for (ast::Item const& item : context.work.checked->file.tree.items)
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) functions.push_back(function);
  Evaluator evaluator(context.results.all, functions, diagnostics);
  auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node);
  auto const* name = std::get_if<ast::Reference>(&tree.node);
  std::optional<std::string> said;
  if (call != nullptr && (*call)->function.text == "plot" && plot_raw(context, **call, evaluator, diagnostics, said)) {
    // what stands in a file
  } else if (call != nullptr && (*call)->function.text == "plot") {
    said = plot(**call, context.plot_size, evaluator, diagnostics);
  } else if (call != nullptr && ((*call)->function.text == "trace" || (*call)->function.text == "histogram")) {
    diagnostics.add({Severity::error,
                     "",
                     fmt::format("`{}` is a plot, not a number", (*call)->function.text),
                     Label{tree.span, {}},
                     {},
                     fmt::format("`plot({})`", unparse(tree))});
  } else if (name != nullptr && name->index.empty() && evaluator.result(name->name.text) != nullptr) {
    said = evaluator.result(name->name.text)->summary;
  } else if (name != nullptr && name->index.empty() &&
             context.work.statements.find(name->name.text) < context.work.statements.items.size()) {
    return command::show(context, name->name.text);
  } else if (auto const quantity = evaluator.value(tree)) {
    said = described(*quantity) + "\n";
  }
  if (!said && call != nullptr && !diagnostics.all().empty())
    if (auto other = instead_of_result(context, **call)) diagnostics.replace({*std::move(other)});
  context.output.show(diagnostics, text);
  if (said) context.output.answer(*said);
  return said.has_value();
}

}  // namespace sysid::repl

// Data blocks: statements in any order, each at most once where once is meant.
#include "check/data/data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "check/expression/distributions.hpp"
#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "check/message/errors_numbers.hpp"
#include "check/units/unit_errors.hpp"
#include "check/units/units.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

class DataChecker {
 public:
  DataChecker(ast::Data const& tree, Diagnostics& diagnostics)
      : tree_(tree), diagnostics_(diagnostics), before_(diagnostics.all().size()), scope_(graph_, diagnostics, {}) {}

  std::optional<DataBlock> run() {
    block_.name = tree_.name.text;
    block_.span = tree_.name.span;
    for (ast::DataStatement const& statement : tree_.statements) std::visit([&](auto const& each) { take(each); }, statement);
    if (!file_) diagnostics_.add(errors::no_file(tree_.name));
    if (std::string const reason = refuse(block_.rules); !reason.empty() && !diagnostics_.has_errors(before_))
      diagnostics_.add(errors::reading_contradicts(reading_, reason));
    if (diagnostics_.has_errors(before_)) return std::nullopt;
    return block_;
  }

 private:
  ColumnUse column(ast::Column const& tree) { return {tree.name, check_unit(tree.unit, diagnostics_), tree.span}; }

  bool fresh(std::map<std::string, Span>& seen, ast::Name const& name, std::string const& what) {
    auto const [place, is_fresh] = seen.emplace(name.text, name.span);
    if (!is_fresh) diagnostics_.add(errors::stated_twice(name.span, place->second, errors::named(what, name.text)));
    return is_fresh;
  }

  /// What a number of another kind would be right for, and how it is written there.
  struct OtherPlace {
    Unit unit;
    std::string help;
  };

  /// `1/50 [s]`: the unit belongs to the 50 alone. Empty where that unit is not `wanted` either.
  std::string quotient_of_number(ast::Expression const& tree, errors::Subject const& what, Unit const& wanted) {
    auto const* quotient = std::get_if<ast::Box<ast::Binary>>(&tree.node);
    if (quotient == nullptr || (*quotient)->symbol != "/") return {};
    auto const* below = std::get_if<ast::Number>(&(*quotient)->right->node);
    auto const* above = std::get_if<ast::Number>(&(*quotient)->left->node);
    if (below == nullptr || above == nullptr || !below->unit || above->unit || below->value == 0) return {};
    Diagnostics unsaid;
    auto const unit = check_unit(*below->unit, unsaid);
    if (!unit || refuse_number(tree.span, what, *unit, wanted)) return {};
    return errors::number_by_quotient(unparse(tree), above->value / below->value, unparse(*below->unit));
  }

  std::optional<double> number(ast::Expression const& tree, Unit const& unit, errors::Subject const& what,
                               std::optional<OtherPlace> const& elsewhere = std::nullopt) {
    auto const value = scope_.expression(tree);
    if (!value) return std::nullopt;
    if (value->kind == Typed::Kind::known)
      if (auto refused = refuse_number(tree.span, what, value->unit, unit)) {
        if (elsewhere && !refuse_number(tree.span, what, value->unit, elsewhere->unit)) refused->help = elsewhere->help;
        if (std::string const whole = quotient_of_number(tree, what, unit); !whole.empty()) refused->help = whole;
        diagnostics_.add(std::move(*refused));
        return std::nullopt;
      }
    auto const constant = graph_.constant_value(adapt(graph_, *value, unit));
    if (!constant) diagnostics_.add(errors::constant_needed(tree.span, what));
    return constant;
  }

  void take(ast::DataFile const& tree) {
    if (file_) diagnostics_.add(errors::stated_twice(tree.span, *file_, {"the file"}));
    file_ = tree.span;
    block_.path = tree.path.value;
    block_.path_span = tree.path.span;
  }
  void take(ast::DataTime const& tree) {
    if (times_) diagnostics_.add(errors::time_and_rate(tree.span, *times_));
    times_ = tree.span;
    block_.time = column(tree.column);
    check_time_unit(block_.time->unit, tree.column.span, diagnostics_);
  }
  void take(ast::DataRate const& tree) {
    if (times_) diagnostics_.add(errors::time_and_rate(tree.span, *times_));
    times_ = tree.span;
    Unit const second = unit_atom("s").value(), hertz = unit_atom("Hz").value();
    std::string const number_text = unparse(tree.value);
    auto const value =
        tree.step ? number(tree.value, second, {"the sampling step"},
                           OtherPlace{hertz, fmt::format("this is a number of samples per time: write `rate {}`", number_text)})
                  : number(tree.value, hertz, {"the sampling rate"},
                           OtherPlace{second, fmt::format("this is the time between two samples: write `step {}`", number_text)});
    if (!value) return;
    if (!(*value > 0) || !std::isfinite(*value)) {
      diagnostics_.add(errors::rate_not_positive(tree.value.span));
      return;
    }
    block_.step = tree.step ? *value : 1 / *value;
    block_.step_stated = tree.step;
    block_.step_place = tree.value.span;
  }
  void take(ast::DataReading const& tree) {
    reading_ = tree.span;
    for (ast::ReadingSetting const& setting : tree.settings) {
      ReadingRow const* const row = find_reading(setting.name.text);
      if (row == nullptr) {
        std::vector<std::string> known;
        for (ReadingRow const& each : reading_rows()) known.emplace_back(each.name);
        diagnostics_.add(errors::unknown_reading(setting.name, known));
        continue;
      }
      if (!fresh(settings_, setting.name, "setting")) continue;
      ReadingValue value{{}, setting.range};
      for (ast::ReadingItem const& item : setting.items) {
        value.items.push_back(item.value);
        value.quoted.push_back(item.quoted);
      }
      if (std::string const wanted = row->take(block_.rules, value); !wanted.empty())
        diagnostics_.add(errors::bad_reading(setting.span, setting.name.text, wanted, std::string(row->usage)));
    }
  }
  void take(ast::DataInput const& tree) {
    if (!fresh(inputs_, tree.input, "input")) return;
    DataInputUse use{column(tree.column), tree.input.text, {}, tree.input.span, {}};
    if (!tree.rule) {
      use.rule_span = tree.span;
    } else if (auto const rule = find_input_rule(tree.rule->text)) {
      use.rule = *rule;
      use.rule_span = tree.rule->span;
    } else {
      diagnostics_.add(errors::unknown_rule(*tree.rule, input_rule_names()));
    }
    if (tree.error) use.error = error(*tree.error, use);
    block_.inputs.push_back(std::move(use));
  }
  /// `normal(sd = 0.5)`, or `normal(0, sd = 0.5)`.
  std::optional<InputErrorUse> error(ast::Call const& written, DataInputUse const& use) {
    auto const refuse = [&](std::string const& reason) -> std::optional<InputErrorUse> {
      diagnostics_.add(errors::law_of_input_error(written.span, use.input, reason));
      return std::nullopt;
    };
    if (written.function.text != "normal") return refuse("can only be normal");
    ast::Call law = written;
    bool const has_mean = std::any_of(law.arguments.begin(), law.arguments.end(),
                                      [](ast::Argument const& each) { return !each.name || each.name->text == "mean"; });
    if (!has_mean) law.arguments.insert(law.arguments.begin(), {{written.span}, {}, {{written.span}, ast::Number{}}});
    std::optional<Unit> const unit = use.unit ? std::optional(difference(*use.unit)) : std::nullopt;
    auto const checked = check_distribution(scope_, law, {use.input, unit, use.span});
    if (!checked) return std::nullopt;
    if (!graph_.is_constant(checked->arguments[0], 0)) return refuse("has a mean other than 0");
    if (checked->lower || checked->upper) return refuse("has bounds");
    auto const sd = graph_.constant_value(checked->arguments[1]);
    if (!sd || !std::isfinite(*sd)) return refuse("must have a number as its standard deviation");
    InputErrorUse result{*sd, false, unit, written.span};
    if (unit) return result;
    for (ast::Argument const& argument : law.arguments) {
      if (!argument.name || argument.name->text == "mean") continue;
      auto const value = scope_.expression(argument.value);
      result.bare = value && value->kind != Typed::Kind::known;
      if (value && !result.bare && argument.name->text == "sd") result.unit = value->unit;
    }
    return result;
  }
  void take(ast::DataMeasure const& tree) {
    if (fresh(channels_, tree.channel, "channel"))
      block_.measured.push_back({column(tree.column), tree.channel.text, tree.channel.span});
  }
  void take(ast::DataConstant const& tree) {
    if (!fresh(constants_, tree.parameter, "constant")) return;
    auto const value = scope_.expression(tree.value);
    if (!value) return;
    auto const constant = graph_.constant_value(value->node);
    if (!constant || !std::isfinite(*constant)) {
      errors::Subject const what{"a constant of an experiment"};
      diagnostics_.add(constant ? errors::value_not_finite(tree.value.span, what) : errors::constant_needed(tree.value.span, what));
      return;
    }
    block_.constants.push_back({tree.parameter.text, *constant,
                                value->kind == Typed::Kind::known ? std::optional(value->unit) : std::nullopt, tree.parameter.span,
                                tree.value.span});
  }
  void take(ast::DataSplit const& tree) {
    for (ast::SplitPart const& part : tree.parts) {
      if (!fresh(parts_, part.name, "range")) continue;
      auto const first = number(part.first, Unit{}, {"a row"}), last = number(part.last, Unit{}, {"a row"});
      if (!first || !last) continue;
      if (*first != std::floor(*first) || *last != std::floor(*last) || *first < 1 || *last < *first || *last > 2e9) {
        diagnostics_.add(errors::bad_rows(cover(part.first.span, part.last.span)));
        continue;
      }
      DataPart const whole{part.name.text, static_cast<int>(*first), static_cast<int>(*last), part.span};
      overlaps(whole);
      block_.parts.push_back(whole);
    }
  }

  /// A part may lie inside another, or be outside it; ends that cross are a slip, and so is a second name for the same rows.
  void overlaps(DataPart const& part) {
    for (DataPart const& other : block_.parts) {
      int const from = std::max(part.first, other.first), to = std::min(part.last, other.last);
      bool const inside =
          (part.first >= other.first && part.last <= other.last) || (other.first >= part.first && other.last <= part.last);
      bool const same = part.first == other.first && part.last == other.last;
      if (from > to || (inside && !same)) continue;
      diagnostics_.add(
          errors::parts_overlap({part.name, part.first, part.last, part.span}, {other.name, other.first, other.last, other.span}));
      return;
    }
  }

  ast::Data const& tree_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  Graph graph_;
  Scope scope_;
  DataBlock block_;
  std::optional<Span> file_, times_;
  Span reading_{};
  std::map<std::string, Span> inputs_, channels_, constants_, parts_, settings_;
};

}  // namespace

std::optional<DataBlock> check_data(ast::Data const& tree, Diagnostics& diagnostics) {
  return DataChecker(tree, diagnostics).run();
}

}  // namespace sysid

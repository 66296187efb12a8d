// Arguments of a distribution are matched to rows of its table; scales must be spelt out (sd, variance or precision).
#include "check/expression/distributions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/expression/corrected_call.hpp"
#include "check/expression/doubtful_arguments.hpp"
#include "check/expression/leaves.hpp"
#include "check/expression/log_normal.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_numbers.hpp"
#include "check/units/unit_errors.hpp"
#include "check/units/unit_words.hpp"
#include "function/primitive.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::vector<std::string> spelling_names(ArgumentRow const& row) {
  std::vector<std::string> names;
  for (Spelling const& spelling : row.spellings) names.emplace_back(spelling.name);
  return names;
}

/// `log_uniform(10..1e4)`: a range among the arguments.
ast::Argument const* range_argument(ast::Call const& call) {
  for (ast::Argument const& each : call.arguments)
    if (auto const* range = std::get_if<ast::Box<ast::Binary>>(&each.value.node); range != nullptr && (*range)->symbol == "..")
      return &each;
  return nullptr;
}

struct Given {
  ast::Expression const* value = nullptr;
  Spelling const* spelling = nullptr;
  Span span;
};

std::optional<Unit> unit_of_argument(std::optional<Unit> const& unit, int unit_power) {
  if (!unit) return unit_power == 0 ? std::optional(Unit{}) : std::nullopt;
  return unit_power == 1 ? unit : power(*unit, {unit_power, 1});
}

/// One use of a distribution on its way from the call to expressions: arguments to their places, their values, then what must hold
/// between them.
class DistributionChecker {
 public:
  DistributionChecker(Scope& scope, ast::Call const& call, Quantity const& variate, DistributionRow const& row)
      : scope_(scope),
        diagnostics_(scope.diagnostics()),
        graph_(scope.graph()),
        call_(call),
        variate_(variate),
        row_(row),
        name_(row.name),
        given_(row.arguments.size()) {
    for (ArgumentRow const& argument : row.arguments)
      for (auto const& spelling : spelling_names(argument)) signature_.push_back(spelling);
  }

  std::optional<Distribution> run() {
    use_.row = &row_;
    if (auto foreign = written_as_elsewhere()) {
      diagnostics_.add(*std::move(foreign));
      return std::nullopt;
    }
    for (ast::Argument const& argument : call_.arguments) argument.name ? take_named(argument) : take_positional(argument);
    evaluate_arguments();
    use_.lower = bound(lower_, "lower");
    use_.upper = bound(upper_, "upper");
    if (!good_ || use_.arguments.size() != row_.arguments.size()) return std::nullopt;
    if (!unit_fits() || !arguments_fit() || !bounds_fit()) return std::nullopt;
    doubt_arguments();
    return use_;
  }

 private:
  void fail(Diagnostic diagnostic) {
    diagnostics_.add(std::move(diagnostic));
    good_ = false;
  }

  /// A call whose arguments are in another order, or not as arguments are written; its single mistakes would mislead.
  std::optional<Diagnostic> written_as_elsewhere() {
    if (ast::Argument const* const range = range_argument(call_)) {
      bool const bounds = signature_ == std::vector<std::string>{"lower", "upper"};
      return errors::range_in_distribution(call_, range->value, bounds, row_.cumulative != nullptr && !bounds);
    }
    bool const too_many = !is_trial_ && call_.arguments.size() > given_.size();
    if (std::string ungrouped = too_many ? without_grouped_digits(call_, given_.size(), works()) : std::string();
        !ungrouped.empty()) {
      Diagnostic grouped = errors::too_many_arguments(call_, call_.arguments[given_.size()], signature_);
      grouped.help = std::move(ungrouped);
      return grouped;
    }
    if (call_.arguments.size() < 2 || call_.arguments[0].name) return std::nullopt;
    ast::Argument const &first = call_.arguments[0], &second = call_.arguments[1];
    auto const* number = std::get_if<ast::Number>(&first.value.node);
    if (number == nullptr) return std::nullopt;
    bool const has_place = signature_.front() == "location" || signature_.front() == "mean" || signature_.front() == "median";
    std::span<Spelling const> const only = row_.arguments.front().spellings;
    bool const zero_place = number->value == 0 && !has_place && row_.arguments.size() == 1 && only.front().unit_power == 1;
    if (zero_place) return errors::place_of_half(call_, std::string(only.front().name));
    bool const of_t = signature_.size() > 1 && signature_[1] == "degrees_of_freedom";
    if (of_t && !second.name && !number->unit && number->value > 0 && cannot_count(second.value))
      return errors::degrees_of_freedom_first(call_);
    return std::nullopt;
  }

  /// What moves, has a unit or is not positive: no number of degrees of freedom.
  bool cannot_count(ast::Expression const& value) const {
    Diagnostics unsaid;
    auto const typed = scope_.with(unsaid).expression(value);
    if (!typed) return false;
    if (auto const constant = graph_.constant_value(typed->node)) return !(*constant > 0);
    return (typed->kind == Typed::Kind::known && !typed->unit.dimensionless()) || !moving_part(graph_, typed->node).empty();
  }

  void take(Given& place, Spelling const* spelling, ast::Argument const& argument, std::string const& spelt) {
    if (place.value != nullptr)
      return fail(
          errors::argument_twice(argument.span, place.span, spelt, place.spelling ? std::string(place.spelling->name) : spelt));
    place = {&argument.value, spelling, argument.span};
  }

  void take_positional(ast::Argument const& argument) {
    if (position_ >= given_.size()) {
      if (position_++ == given_.size()) fail(errors::too_many_arguments(call_, argument, signature_));
      return;
    }
    std::size_t const position = position_++;
    std::span<Spelling const> const spellings = row_.arguments[position].spellings;
    bool const in_doubt = std::any_of(spellings.begin(), spellings.end(), [](Spelling const& each) { return each.logarithm; }) &&
                          is_logarithm(argument.value);
    if (in_doubt)
      return fail(errors::logarithm_or_number(argument, mean_of_logarithm(scope_, argument.value, variate_).text, name_));
    if (spellings.size() > 1 && !row_.arguments[position].by_position)
      return fail(errors::must_be_named(call_, argument, spelling_names(row_.arguments[position]), other_meaning_of_first()));
    take(given_[position], &spellings.front(), argument, std::string(spellings.front().name));
  }

  /// `log_normal(3, 1)`: 3 is the median here, and the mean of the logarithm in other languages.
  std::string other_meaning_of_first() const {
    std::span<Spelling const> const first = row_.arguments.front().spellings;
    auto const logarithm = std::find_if(first.begin(), first.end(), [](Spelling const& each) { return each.logarithm; });
    ast::Argument const& argument = call_.arguments.front();
    if (logarithm == first.end() || argument.name || is_logarithm(argument.value)) return {};
    std::string const value = unparse(argument.value);
    return fmt::format("`{}` is the {}: where the mean of the logarithm is meant, write `{} = {}`", value, first.front().name,
                       logarithm->name, value);
  }

  void take_named(ast::Argument const& argument) {
    std::string const& key = argument.name->text;
    for (std::size_t i = 0; i < given_.size(); ++i)
      for (Spelling const& spelling : row_.arguments[i].spellings)
        if (spelling.name == key) return take(given_[i], &spelling, argument, key);
    if (key == "lower" || key == "upper") {
      if (row_.cumulative == nullptr) fail(errors::cannot_truncate(argument.span, name_));
      return take(key == "lower" ? lower_ : upper_, nullptr, argument, key);
    }
    std::vector<std::string> known = signature_;
    for (char const* const limit : {"lower", "upper"})
      if (row_.cumulative != nullptr && std::find(known.begin(), known.end(), limit) == known.end()) known.emplace_back(limit);
    fail(errors::unknown_argument(*argument.name, name_, known));
  }

  std::optional<Typed> value_in(std::optional<Unit> const& wanted, ast::Expression const& tree, std::string const& spelt,
                                bool is_width = false, std::vector<std::pair<Dimension, std::string>> cures = {}) {
    std::string const declared = variate_.unit ? "[" + unit_words(*variate_.unit, {}) + "]" : "";
    return scope_.expression_in(wanted, variate_.span, tree,
                                {Occasion::Kind::distribution, spelt, variate_.name, declared, is_width, std::move(cures),
                                 is_width ? location_argument(call_) : nullptr});
  }

  void evaluate_arguments() {
    bool const all_placed = good_;
    for (std::size_t i = 0; i < given_.size(); ++i) {
      ArgumentRow const& argument = row_.arguments[i];
      if (given_[i].value != nullptr) {
        evaluate(given_[i], argument, i);
      } else if (!std::isnan(argument.fallback)) {
        auto const scale = unit_of_argument(variate_.unit, argument.spellings.front().unit_power);
        use_.arguments.push_back(graph_.constant(argument.fallback * (scale ? scale->scale : 1)));
      } else {
        if (all_placed) diagnostics_.add(errors::argument_missing(call_, spelling_names(argument)));
        good_ = false;
      }
    }
  }

  bool is_of_logarithm() const { return sysid::is_of_logarithm(row_); }

  void doubt_arguments() {
    for (std::size_t i = 0; i < given_.size(); ++i)
      if (given_[i].value != nullptr) {
        WrittenArgument const written{*given_[i].value, *given_[i].spelling, given_[i].span};
        if (auto doubt = doubtful_angle(written, variate_)) return diagnostics_.add(std::move(*doubt));
        if (i > 0 && is_of_logarithm())
          if (auto doubt = doubtful_width_of_logarithm(written, graph_.constant_value(use_.arguments[i]), name_))
            return diagnostics_.add(std::move(*doubt));
      }
  }

  /// `variance = sigma` of a sigma in the unit of an sd: by the spelling that has its unit, or as the power that was asked for.
  std::vector<std::pair<Dimension, std::string>> other_spellings(Given const& given, ArgumentRow const& row) const {
    std::vector<std::pair<Dimension, std::string>> cures;
    if (!variate_.unit || variate_.unit->dimensionless()) return cures;
    if (is_of_logarithm() && given.spelling->unit_power == 0)
      cures.emplace_back(
          variate_.unit->dimension,
          fmt::format("it is the {} of the natural logarithm, a pure number: `sd = 0.1` is about 10 %", given.spelling->name));
    for (Spelling const& other : row.spellings)
      if (other.unit_power != given.spelling->unit_power && other.unit_power != 0)
        cures.emplace_back(unit_of_argument(variate_.unit, other.unit_power)->dimension, as_other_spelling(given, other));
    return cures;
  }

  static std::string as_other_spelling(Given const& given, Spelling const& other) {
    std::string const text = unparse(*given.value);
    std::string const base = std::holds_alternative<ast::Reference>(given.value->node) ? text : "(" + text + ")";
    std::string power;
    if (other.unit_power == 1 && given.spelling->unit_power == 2) power = fmt::format("{}^2", base);
    if (other.unit_power == 1 && given.spelling->unit_power == -2) power = fmt::format("1/{}^2", base);
    if (other.unit_power == 2 && given.spelling->unit_power == 1) power = fmt::format("sqrt({})", text);
    if (other.unit_power == -given.spelling->unit_power) power = fmt::format("1/{}", base);
    std::string const written = fmt::format("write `{} = {}`", other.name, text);
    return power.empty() ? written : fmt::format("{}, or `{} = {}`", written, given.spelling->name, power);
  }

  static std::string power_of_text(std::string const& unit, int exponent) {
    if (exponent == 0) return "-";
    if (exponent == 1 || unit.empty()) return unit;
    return fmt::format("{}^{}", unit.find_first_of(" */^") == std::string::npos ? unit : "(" + unit + ")", exponent);
  }

  /// Of `sigma^2`, whose unit is a pure number where that of sigma is.
  Unit unit_with_power(ast::Expression const& tree, Unit const& otherwise) const {
    auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
    auto const* exponent = binary == nullptr ? nullptr : std::get_if<ast::Number>(&(*binary)->right->node);
    if (exponent == nullptr || exponent->unit || (*binary)->symbol != "^" || exponent->value != 2) return otherwise;
    Diagnostics unsaid;
    auto const base = scope_.with(unsaid).expression(*(*binary)->left);
    if (!base || base->kind != Typed::Kind::known) return otherwise;
    Unit square = power(base->unit, {2, 1});
    square.text = power_of_text(base->unit.text, 2);
    return square;
  }

  /// The same where the dimension does not tell: `variance = sigma` of a sigma in [deg].
  bool of_other_power(Given const& given, ArgumentRow const& row, Typed const& value) {
    int const wanted = given.spelling->unit_power;
    if (!variate_.unit || !variate_.unit->dimensionless() || variate_.unit->scale == 1 || value.kind != Typed::Kind::known)
      return false;
    if (wanted == 0 && given.spelling->name != "degrees_of_freedom") return false;
    Unit const given_unit = unit_with_power(*given.value, value.unit);
    for (int const found : {1, 2, -2}) {
      Unit const unit = power(*variate_.unit, {found, 1});
      if (found == wanted || std::fabs(given_unit.scale / unit.scale - 1) > 1e-9 || given_unit.radian != unit.radian) continue;
      auto const in_words = [&](int exponent) { return power_of_text(variate_.unit->text, exponent); };
      // An angle tells its power by its radians. Of a share only the text does: 1 [ppm] is an sd of what is in [mm/m] as well as
      // its square.
      if (variate_.unit->radian.numerator == 0 && given_unit.text != in_words(found)) continue;
      UnitConflict conflict;
      conflict.primary = {given.span, "[" + in_words(found) + "]"};
      conflict.found = in_words(found);
      conflict.wanted = in_words(wanted);
      auto const other =
          std::find_if(row.spellings.begin(), row.spellings.end(), [&](Spelling const& each) { return each.unit_power == found; });
      conflict.help =
          other != row.spellings.end() ? as_other_spelling(given, *other) : errors::should_be_in("this", conflict.wanted);
      fail(errors::units_differ({Occasion::Kind::distribution, std::string(given.spelling->name), variate_.name},
                                std::move(conflict)));
      return true;
    }
    return false;
  }

  void evaluate(Given const& given, ArgumentRow const& row, std::size_t index) {
    std::optional<Unit> unit = unit_of_argument(variate_.unit, given.spelling->unit_power);
    // Widths of a temperature are differences: they have no zero to shift.
    std::string_view const spelt = given.spelling->name;
    bool const place = spelt == "mean" || spelt == "median" || spelt == "location" || spelt == "lower" || spelt == "upper";
    std::optional<Typed> value = value_in(unit, *given.value, std::string(spelt), !place, other_spellings(given, row));
    if (!value) {
      good_ = false;
      return;
    }
    if (!place) {
      if (of_other_power(given, row, *value)) return;
      value->unit.offset = 0;
      if (unit) unit->offset = 0;
    }
    NodeId node = adapt(graph_, *value, unit);
    if (given.spelling->logarithm) {
      if (variate_.unit && variate_.unit->offset != 0)
        return fail(errors::logarithm_of_shifted(given.span, std::string(spelt), name_));
      node = graph_.multiply(graph_.constant(variate_.unit ? variate_.unit->scale : 1), exp(Term(graph_, node)).id);
    }
    // Some are computed from those before, of which one may be missing or wrong: that has been said.
    if (use_.arguments.size() != index) return;
    if (given.spelling->to_canonical != nullptr) node = given.spelling->to_canonical(graph_, node, use_.arguments);
    use_.arguments.push_back(node);
  }

  std::optional<NodeId> bound(Given const& place, char const* spelt) {
    if (place.value == nullptr) return std::nullopt;
    auto const value = value_in(variate_.unit, *place.value, spelt);
    if (!value) {
      good_ = false;
      return std::nullopt;
    }
    NodeId const node = adapt(graph_, *value, variate_.unit);
    auto const number = graph_.constant_value(node);
    return number && std::isinf(*number) ? std::nullopt : std::optional(node);
  }

  bool refused(Diagnostic diagnostic) {
    diagnostics_.add(std::move(diagnostic));
    return false;
  }

  bool unit_fits() {
    std::optional<Unit> const& unit = variate_.unit;
    if (row_.dimensionless && unit && !unit->dimensionless()) {
      std::string const text = unit->text_or_dimension();
      return refused(row_.discrete ? errors::unit_of_count(call_.span, name_, text)
                                   : errors::unit_of_share(call_.span, name_, text));
    }
    if (row_.discrete && unit && unit->scale != 1) return refused(errors::unit_of_count(call_.span, name_, unit->text));
    return true;
  }

  /// Whether another call would be accepted in this place.
  Valid works() const {
    return [this](ast::Call const& other) {
      Diagnostics unsaid;
      Scope scope = scope_.with(unsaid);
      DistributionChecker trial(scope, other, variate_, row_);
      trial.is_trial_ = true;
      return trial.run().has_value();
    };
  }
  std::string correction() const { return is_trial_ ? std::string() : corrected_call(call_, works()); }

  // Where they are numbers.
  bool arguments_fit() {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < use_.arguments.size(); ++i)
      if (auto const number = graph_.constant_value(use_.arguments[i]); number && std::isinf(*number) && given_[i].value != nullptr)
        return refused(errors::argument_not_finite(given_[i].span, std::string(given_[i].spelling->name), name_));
    for (NodeId const argument : use_.arguments)
      if (auto const number = graph_.constant_value(argument)) numbers.push_back(*number);
    if (numbers.size() != use_.arguments.size() || row_.refuse == nullptr) return true;
    std::string_view const reason = row_.refuse(numbers);
    bool const negative = std::any_of(numbers.begin(), numbers.end(), [](double number) { return number < 0; });
    if (reason.empty()) return true;
    bool const logarithms = name_ == "log_uniform" && negative;
    return refused(errors::bad_arguments(
        call_.span, name_, reason,
        logarithms ? "its bounds are the positive values themselves, not their logarithms: `log_uniform(1e-3, 1)`" : correction()));
  }

  bool bounds_fit() {
    if (use_.lower && use_.upper) {
      auto const a = graph_.constant_value(*use_.lower), b = graph_.constant_value(*use_.upper);
      if (a && b && !(*a < *b)) return refused(errors::bad_arguments(call_.span, name_, "lower is not below upper", correction()));
    }
    if (row_.proper && (use_.lower || use_.upper)) {
      auto const left = graph_.constant_value(mass(graph_, use_));
      if (left && !(*left > 0)) return refused(errors::no_mass(call_.span, name_));
    }
    return true;
  }

  Scope& scope_;
  Diagnostics& diagnostics_;
  Graph& graph_;
  ast::Call const& call_;
  Quantity const& variate_;
  DistributionRow const& row_;
  std::string const name_;
  std::vector<std::string> signature_;
  std::vector<Given> given_;  // by argument of the row
  Given lower_, upper_;
  std::size_t position_ = 0;  // of the next argument without a name
  bool good_ = true;
  bool is_trial_ = false;  // of a call that may be meant
  Distribution use_;
};

}  // namespace

ast::Expression const* location_argument(ast::Call const& call) {
  for (ast::Argument const& argument : call.arguments)
    if (!argument.name || argument.name->text == "mean" || argument.name->text == "median" || argument.name->text == "location")
      return &argument.value;
  return nullptr;
}

std::optional<Distribution> check_distribution(Scope& scope, ast::Call const& call, Quantity const& variate) {
  DistributionRow const* row = find_distribution(call.function.text);
  if (row == nullptr) {
    std::vector<std::string> known;
    for (DistributionRow const& each : distributions()) known.emplace_back(each.name);
    Diagnostic unknown = errors::unknown_distribution(call.function, known, log_normal_of_others(scope, call, variate));
    if (std::string normal = normal_of_others(call); !normal.empty()) unknown.help = std::move(normal);
    scope.diagnostics().add(std::move(unknown));
    return std::nullopt;
  }
  return DistributionChecker(scope, call, variate, *row).run();
}

}  // namespace sysid

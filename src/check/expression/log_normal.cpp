// Other languages give a log-normal distribution by the mean and sd of the logarithm, without names.
#include "check/expression/log_normal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

#include "syntax/unparse.hpp"

namespace sysid {

bool is_logarithm(ast::Expression const& value) {
  auto const* call = std::get_if<ast::Box<ast::Call>>(&value.node);
  return call != nullptr && ((*call)->function.text == "log" || (*call)->function.text == "ln");
}

PlaceOfLogarithm mean_of_logarithm(Scope& scope, ast::Expression const& value, Quantity const& variate) {
  PlaceOfLogarithm const whole{"log_mean = " + unparse(value)};
  auto const* call = std::get_if<ast::Box<ast::Call>>(&value.node);
  if (!is_logarithm(value) || (*call)->arguments.size() != 1) return whole;
  ast::Expression const& inside = (*call)->arguments.front().value;
  Diagnostics unsaid;
  auto const typed = scope.with(unsaid).expression(inside);
  bool const pure = typed && typed->kind == Typed::Kind::known && typed->unit.dimensionless();
  return pure && variate.unit && !variate.unit->dimensionless() ? whole : PlaceOfLogarithm{"median = " + unparse(inside), true};
}

errors::LogNormalOfOthers log_normal_of_others(Scope& scope, ast::Call const& call, Quantity const& variate) {
  constexpr std::string_view means[] = {"mu", "meanlog"}, widths[] = {"sigma", "sdlog"};
  auto const is_one_of = [](ast::Argument const& argument, std::span<std::string_view const> names) {
    return argument.name && std::find(names.begin(), names.end(), argument.name->text) != names.end();
  };
  if (call.function.text != "lognormal" && call.function.text != "Lognormal" && call.function.text != "LogNormal") return {};
  if (call.arguments.size() != 2) return {};
  ast::Argument const &place = call.arguments[0], &width = call.arguments[1];
  if ((place.name && !is_one_of(place, means)) || (width.name && !is_one_of(width, widths))) return {};
  auto const [location, as_median] = mean_of_logarithm(scope, place.value, variate);
  std::string const of_logarithm =
      fmt::format("log_normal({}, {} = {})", location, as_median ? "sd" : "log_sd", unparse(width.value));
  auto const* number = std::get_if<ast::Number>(&place.value.node);
  errors::LogNormalOfOthers written;
  written.of_logarithm = of_logarithm;
  if (as_median || place.name || number == nullptr || !(number->value > 0)) return written;
  constexpr double most_log_mean = 30;  // 1e13
  written.of_median = fmt::format("log_normal(median = {}, log_sd = {})", unparse(place.value), unparse(width.value));
  written.median_first = number->value > most_log_mean;
  return written;
}

}  // namespace sysid

// Changes are tried on a copy of the call.
#include "check/expression/corrected_call.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "syntax/grouped_digits.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::string written(ast::Call const& call) { return unparse(ast::Expression{call.span, call}); }

/// Two arguments that may be bounds: those with the names, else both of two.
std::optional<std::pair<std::size_t, std::size_t>> bounds_of(ast::Call const& call) {
  std::size_t const none = call.arguments.size();
  std::size_t lower = none, upper = none;
  for (std::size_t i = 0; i < none; ++i) {
    if (!call.arguments[i].name) continue;
    if (call.arguments[i].name->text == "lower") lower = i;
    if (call.arguments[i].name->text == "upper") upper = i;
  }
  if (lower < none && upper < none) return std::pair(lower, upper);
  if (none == 2 && !call.arguments[0].name && !call.arguments[1].name) return std::pair<std::size_t, std::size_t>(0, 1);
  return std::nullopt;
}

bool is_zero(ast::Expression const& tree) {
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && number->value == 0;
}

/// Two signs in a row cancel.
void cancel_signs(ast::Expression& tree) {
  auto const* outer = std::get_if<ast::Box<ast::Unary>>(&tree.node);
  auto const* inner = outer == nullptr ? nullptr : std::get_if<ast::Box<ast::Unary>>(&(*outer)->operand->node);
  if (inner == nullptr || (*outer)->symbol != "-" || (*inner)->symbol != "-") return;
  ast::Expression operand = *(*inner)->operand;
  tree = std::move(operand);
}

}  // namespace

std::string corrected_call(ast::Call const& given, Valid const& valid) {
  ast::Call call = given;
  for (ast::Argument& each : call.arguments) cancel_signs(each.value);
  auto const bounds = bounds_of(call);
  if (bounds) {
    ast::Call exchanged = call;
    std::swap(exchanged.arguments[bounds->first].value, exchanged.arguments[bounds->second].value);
    if (valid(exchanged)) return fmt::format("write `{}`", written(exchanged));
  }
  for (std::size_t i = call.arguments.size(); i-- > 0;) {
    auto const* unary = std::get_if<ast::Box<ast::Unary>>(&call.arguments[i].value.node);
    if (unary == nullptr || (*unary)->symbol != "-") continue;
    ast::Call without_sign = call;
    ast::Expression operand = *(*unary)->operand;
    without_sign.arguments[i].value = std::move(operand);
    if (valid(without_sign)) return fmt::format("write `{}`", written(without_sign));
  }
  // From 0 no logarithm begins, and it has no median of 0.
  if (bounds && call.function.text == "log_uniform" && is_zero(call.arguments[bounds->first].value)) {
    auto const* upper = std::get_if<ast::Number>(&call.arguments[bounds->second].value.node);
    ast::Call above_zero = call, uniform = call;
    if (upper == nullptr) return {};
    ast::Number small = *upper;
    small.value = leading_number(fmt::format("{:.3g}", upper->value / 1000));
    above_zero.arguments[bounds->first].value.node = std::move(small);
    uniform.function.text = "uniform";
    if (valid(above_zero))
      return fmt::format("the lower bound is a small positive number: `{}`; where 0 is possible, write `{}`", written(above_zero),
                         written(uniform));
  }
  if (call.function.text == "log_normal" && !call.arguments.empty() && !call.arguments[0].name) {
    ast::Call of_logarithm = call;
    of_logarithm.arguments[0].name = ast::Name{call.span, "log_mean"};
    if (valid(of_logarithm))
      return fmt::format("write `{}`, if `{}` is the mean of the logarithm", written(of_logarithm),
                         unparse(call.arguments[0].value));
  }
  return {};
}

std::string without_grouped_digits(ast::Call const& call, std::size_t arguments, Valid const& valid) {
  ast::Call joined = call;
  joined.arguments.clear();
  std::string text, before;  // of the argument before
  bool before_is_group = false, grouped = false;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    ast::Argument const& each = call.arguments[i];
    std::string const digits = whole_digits(each);
    bool const adjoins = i > 0 && call.arguments[i - 1].span.end + 1 == each.span.begin;
    bool const group = adjoins && !each.name && continues_group(before, before_is_group, digits);
    if (group) {
      auto& number = std::get<ast::Number>(joined.arguments.back().value.node);
      number.value = 1000 * number.value + std::get<ast::Number>(each.value.node).value;
      text += digits;
    } else {
      joined.arguments.push_back(each);
      text += fmt::format("{}{}{}", i == 0 ? "" : ", ", each.name ? each.name->text + " = " : "",
                          digits.empty() ? unparse(each.value) : digits);
    }
    before = digits;
    before_is_group = group;
    grouped = grouped || group;
  }
  if (!grouped || joined.arguments.size() != arguments || !valid(joined)) return {};
  return fmt::format("digits are not grouped: write `{}({})`", call.function.text, text);
}

std::string normal_of_others(ast::Call const& call) {
  constexpr std::array<std::string_view, 5> names{"normal", "gaussian", "gauss", "norm", "n"};
  if (std::find(names.begin(), names.end(), in_small_letters(call.function.text)) == names.end()) return {};
  if (call.arguments.size() != 2 || call.arguments[0].name || call.arguments[1].name) return {};
  std::string const mean = unparse(call.arguments[0].value), width = unparse(call.arguments[1].value);
  std::string const help = fmt::format("write `normal({}, sd = {})`", mean, width);
  return call.function.text == "N" ? fmt::format("{}, or `normal({}, variance = {})`", help, mean, width) : help;
}

}  // namespace sysid

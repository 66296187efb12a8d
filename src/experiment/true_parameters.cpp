// Lines of a head to values of parameters.
#include "experiment/true_parameters.hpp"

#include <charconv>
#include <optional>

#include "check/units/units.hpp"
#include "likelihood/parameter_space.hpp"
#include "syntax/parse.hpp"

namespace sysid {

namespace {

struct Line {
  std::string_view name, number, unit;
};

/// "k = 18.6 [N/mm]".
std::optional<Line> split(std::string_view text) {
  std::size_t const equals = text.find(" = "), open = text.rfind(" [");
  if (equals == std::string_view::npos || open == std::string_view::npos || open < equals || !text.ends_with(']'))
    return std::nullopt;
  return Line{text.substr(0, equals), text.substr(equals + 3, open - equals - 3), text.substr(open + 2, text.size() - open - 3)};
}

std::optional<Unit> unit_of(std::string_view text) {
  Diagnostics ignored;
  auto const tree = parse_expression(Source("", "1 [" + std::string(text) + "]"), ignored);
  auto const* number = tree ? std::get_if<ast::Number>(&tree->node) : nullptr;
  return number != nullptr && number->unit ? check_unit(*number->unit, ignored) : std::nullopt;
}

/// In the declared unit of the parameter; nothing when that is of another dimension.
std::optional<double> declared_value(double stated, std::string_view unit, Parameter const& parameter) {
  if (!parameter.unit || parameter.unit->text == unit) return stated;
  auto const from = unit_of(unit);
  if (!from || from->dimension != parameter.unit->dimension || cycles_against_radians(*from, *parameter.unit)) return std::nullopt;
  return convert(stated, *from, *parameter.unit);
}

}  // namespace

std::vector<TrueValue> true_values(std::vector<std::string> const& comments, Model const& model, std::string const& experiment) {
  std::vector<TrueValue> out;
  if (comments.empty() || !comments.front().starts_with("made by sysid ")) return out;
  for (std::string const& comment : comments) {
    auto const line = split(comment);
    if (!line) continue;
    double stated = 0;
    auto const [end, error] = std::from_chars(line->number.data(), line->number.data() + line->number.size(), stated);
    if (error != std::errc() || end != line->number.data() + line->number.size()) continue;
    for (Parameter const& parameter : model.parameters) {
      if (parameter.name != line->name) continue;
      if (auto const value = declared_value(stated, line->unit, parameter))
        out.push_back(
            {parameter.per_experiment ? member_name(parameter.name, experiment) : parameter.name, parameter.unit_text(), *value});
    }
  }
  return out;
}

}  // namespace sysid

// Null directions in the user's words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics/identifiability/identifiability.hpp"

#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

using Part = NullDirection::Part;
using Words = std::span<ParameterWords const>;

std::string const& name(Words parameters, Part const& part) { return parameters[static_cast<std::size_t>(part.parameter)].name; }

bool equal(double a, double b) { return std::abs(a - b) < 1e-9; }

std::string power(double exponent) {
  if (equal(exponent, 1)) return "s";
  double const twice = 2 * exponent;
  if (!equal(exponent, std::round(exponent)) && equal(twice, std::round(twice))) return fmt::format("s^({:.0f}/2)", twice);
  return fmt::format("s^{}{:.4g}{}", exponent < 0 ? "(" : "", exponent, exponent < 0 ? ")" : "");
}

std::string scaling(NullDirection const& direction, Words parameters, std::string const& output) {
  bool const together =
      std::all_of(direction.parts.begin(), direction.parts.end(), [](Part const& p) { return equal(p.coefficient, 1); });
  std::vector<std::string> names;
  for (Part const& part : direction.parts) names.push_back(name(parameters, part));
  if (direction.parts.size() == 2)
    return fmt::format("{} and {} enter {} only as {}", names[0], names[1], output, determined_combination(direction, parameters));
  if (together) return fmt::format("scaling {} together leaves {} unchanged", listed(names), output);
  // One group per exponent, in the order of their first members.
  std::vector<std::pair<double, std::vector<std::string>>> groups;
  for (Part const& part : direction.parts) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](auto const& g) { return equal(g.first, part.coefficient); });
    if (group == groups.end()) group = groups.insert(groups.end(), {part.coefficient, {}});
    group->second.push_back(name(parameters, part));
  }
  std::vector<std::string> texts;
  for (auto const& [exponent, members] : groups) texts.push_back(fmt::format("{} by {}", listed(members), power(exponent)));
  return fmt::format("scaling {} leaves {} unchanged for any s", listed(texts), output);
}

std::string sum(NullDirection const& direction, Words parameters, std::string const& output) {
  if (direction.parts.size() == 2) {
    std::string const combination = determined_combination(direction, parameters);
    return fmt::format("{} and {} are confounded: only {} is determined by {}", name(parameters, direction.parts[0]),
                       name(parameters, direction.parts[1]), combination, output);
  }
  std::vector<std::string> up, down;
  for (Part const& part : direction.parts) {
    double const size = std::abs(part.coefficient);
    (part.coefficient > 0 ? up : down)
        .push_back(equal(size, 1) ? name(parameters, part) : fmt::format("{} ({:.4g} times)", name(parameters, part), size));
  }
  return fmt::format("adding the same amount to {}{} leaves {} unchanged", listed(up),
                     down.empty() ? std::string() : " and subtracting it from " + listed(down), output);
}

std::string general(NullDirection const& direction, Words parameters, std::string const& output) {
  std::vector<Part> parts = direction.parts;
  std::stable_sort(parts.begin(), parts.end(),
                   [](Part const& a, Part const& b) { return std::abs(a.coefficient) > std::abs(b.coefficient); });
  constexpr std::size_t most = 6;
  std::vector<std::string> names, moves;
  double const tenth = parts.front().coefficient < 0 ? -0.1 : 0.1;
  for (Part const& part : parts) {
    if (names.size() == most) break;
    ParameterWords const& parameter = parameters[static_cast<std::size_t>(part.parameter)];
    names.push_back(parameter.name);
    moves.push_back(
        fmt::format("{} by {:+.3g}{}", parameter.name, tenth * part.natural / parameter.scale, unit_after_number(parameter.unit)));
  }
  if (parts.size() == 1) return fmt::format("moving {} leaves {} unchanged to first order", moves[0], output);
  return fmt::format("{}{} are confounded: moving {} together leaves {} unchanged to first order", listed(names),
                     parts.size() > most ? fmt::format(" (and {} more)", parts.size() - most) : std::string(), listed(moves),
                     output);
}

}  // namespace

std::string determined_combination(NullDirection const& direction, Words parameters) {
  Part const &a = direction.parts[0], &b = direction.parts[1];
  std::string const &left = name(parameters, a), &right = name(parameters, b);
  if (direction.kind == NullDirection::Kind::scaling) {
    // a^u b^v is unchanged where u (exponent of a) + v (exponent of b) = 0.
    double const u = 1, v = -a.coefficient / b.coefficient;
    auto const factor = [](std::string const& text, double exponent) {
      if (equal(exponent, 1)) return text;
      if (equal(exponent, 0.5)) return fmt::format("sqrt({})", text);
      return fmt::format("{}^{:.4g}", text, exponent);
    };
    return fmt::format("{}{}{}", factor(left, u), v > 0 ? "*" : "/", factor(right, std::abs(v)));
  }
  double const v = -a.coefficient / b.coefficient, size = std::abs(v);
  return fmt::format("{} {} {}{}", left, v > 0 ? "+" : "-", equal(size, 1) ? "" : fmt::format("{:.4g}*", size), right);
}

std::string direction_words(NullDirection const& direction, Words parameters, std::string const& output, bool driven) {
  switch (direction.kind) {
    case NullDirection::Kind::no_influence:
      return fmt::format("{} has no influence on {}{}", name(parameters, direction.parts[0]), output,
                         driven ? " with this input" : "");
    case NullDirection::Kind::scaling:
      return scaling(direction, parameters, output);
    case NullDirection::Kind::sum:
      return sum(direction, parameters, output);
    case NullDirection::Kind::general:
      return general(direction, parameters, output);
  }
  return {};
}

}  // namespace sysid

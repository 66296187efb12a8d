// The text is cut into its names and their powers, one power is changed, and they are written again.
#include "check/units/changed_power.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace sysid {
namespace {

struct PoweredName {
  std::string name;
  int power = 1;
};

/// `N s/(m kg)`; nothing for other brackets, fractions in powers and anything else.
std::optional<std::vector<PoweredName>> powers_in(std::string_view text) {
  std::vector<PoweredName> names;
  bool below = false, grouped = false;
  for (std::size_t at = 0; at < text.size();) {
    char const c = text[at];
    bool const letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (c == ' ' || c == '*' || (c == '1' && names.empty() && !below)) {
      ++at;
    } else if (c == '/' && !below) {
      below = true;
      grouped = at + 1 < text.size() && text[at + 1] == '(';
      at += grouped ? 2 : 1;
    } else if (c == ')' && grouped && at + 1 == text.size()) {
      ++at;
    } else if (letter) {
      std::size_t end = at;
      while (end < text.size() &&
             ((text[end] >= 'a' && text[end] <= 'z') || (text[end] >= 'A' && text[end] <= 'Z') || text[end] == '_'))
        ++end;
      int power = 1;
      std::string_view const name = text.substr(at, end - at);
      if (end < text.size() && text[end] == '^') {
        auto const [stop, error] = std::from_chars(text.data() + end + 1, text.data() + text.size(), power);
        if (error != std::errc{}) return std::nullopt;
        end = static_cast<std::size_t>(stop - text.data());
      }
      // Without brackets a second name below the line would be read in two ways.
      if (below && !grouped && !names.empty() && names.back().power < 0) return std::nullopt;
      names.push_back({std::string(name), below ? -power : power});
      at = end;
    } else {
      return std::nullopt;
    }
  }
  return names;
}

std::string written_again(std::vector<PoweredName> const& names) {
  std::string above, below;
  int count = 0;
  for (PoweredName const& each : names) {
    if (each.power == 0) continue;
    std::string& side = each.power > 0 ? above : below;
    count += each.power < 0 ? 1 : 0;
    side += (side.empty() ? "" : " ") + each.name;
    if (std::abs(each.power) > 1) side += "^" + std::to_string(std::abs(each.power));
  }
  if (below.empty()) return above;
  return (above.empty() ? "1" : above) + "/" + (count > 1 ? "(" + below + ")" : below);
}

Dimension to_power(Dimension dimension, int k) {
  for (Rational& each : dimension) each = each * Rational{k, 1};
  return dimension;
}

/// k where factor = dimension^k; 0: there is none.
int whole_power(Dimension const& factor, Dimension const& dimension) {
  for (int k : {1, -1, 2, -2, 3, -3, 4, -4})
    if (factor == to_power(dimension, k)) return k;
  return 0;
}

/// Changes the powers of two names, where one pair of them makes the factor: N s^2/m^2 of N s/m and s/m.
bool change_two(std::vector<PoweredName>& names, std::vector<Dimension> const& dimensions, Dimension const& factor) {
  int fitting = 0;
  std::vector<PoweredName> changed;
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j)
      for (int const k : {1, -1, 2, -2}) {
        if (dimensions[i] == Dimension{} || dimensions[j] == Dimension{}) continue;
        Dimension rest = to_power(dimensions[i], -k);
        for (std::size_t d = 0; d < rest.size(); ++d) rest[d] = rest[d] + factor[d];
        int const other = whole_power(rest, dimensions[j]);
        if (other == 0) continue;
        changed = names;
        changed[i].power += k;
        changed[j].power += other;
        ++fitting;
      }
  if (fitting == 1) names = std::move(changed);
  return fitting == 1;
}

}  // namespace

std::string with_changed_power(std::string_view text, Dimension const& factor) {
  auto names = powers_in(text);
  if (!names) return {};
  int fitting = 0;
  std::vector<Dimension> dimensions;
  for (PoweredName& each : *names) {
    auto const unit = unit_atom(each.name);
    if (!unit || unit->offset != 0 || unit->hertz.numerator != 0 || unit->radian.numerator != 0) return {};
    dimensions.push_back(unit->dimension);
    if (int const power = unit->dimensionless() ? 0 : whole_power(factor, unit->dimension)) {
      each.power += power;
      ++fitting;
    }
  }
  if (fitting == 0 && change_two(*names, dimensions, factor)) fitting = 1;
  return fitting == 1 ? written_again(*names) : std::string();
}

std::string with_force_for_mass(std::string_view unit) {
  constexpr std::string_view of_force[] = {"kg cm", "kg mm", "cm kg", "mm kg", "kg/mm", "kg/cm", "kg/cm^2", "kg/mm^2"};
  auto const is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  for (std::string_view const mass : {"lb", "oz", "kg"}) {
    if (mass == "kg" && std::find(std::begin(of_force), std::end(of_force), unit) == std::end(of_force)) continue;
    std::size_t const at = unit.find(mass);
    if (at == std::string_view::npos || (at > 0 && is_letter(unit[at - 1]))) continue;
    std::size_t const end = at + mass.size();
    if (end < unit.size() && is_letter(unit[end])) continue;
    std::string const force = std::string(mass) + "f";
    if (unit_atom(force)) return std::string(unit.substr(0, end)) + "f" + std::string(unit.substr(end));
  }
  return {};
}

}  // namespace sysid

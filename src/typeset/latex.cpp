// LaTeX with amsmath.
#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "typeset/notation.hpp"
#include "typeset/symbol.hpp"

namespace sysid {

namespace {

/// What means something to LaTeX, as characters.
std::string escaped(std::string_view text) {
  std::string out;
  for (char const c : text) {
    if (c == '\\')
      out += "\\textbackslash{}";
    else if (c == '~' || c == '^')
      out += fmt::format("\\{}{{}}", c);
    else if (std::string_view("#$%&_{}").find(c) != std::string_view::npos)
      out += fmt::format("\\{}", c);
    else
      out += c;
  }
  return out;
}

constexpr std::string_view commands[] = {"sin",  "cos",  "tan", "arcsin", "arccos", "arctan", "sinh",
                                         "cosh", "tanh", "exp", "ln",     "min",    "max"};

class Latex final : public Notation {
 public:
  std::string letter(std::string_view text) const override {
    if (GreekLetter const* greek = greek_letter(text)) return std::string(greek->command);
    return text_width(text) == 1 ? escaped(text) : fmt::format("\\mathit{{{}}}", escaped(text));
  }
  std::string word(std::string_view text) const override {
    for (std::string_view const command : commands)
      if (command == text) return fmt::format("\\{}", command);
    // In mathematics blanks vanish.
    return fmt::format("\\{}{{{}}}", text.find(' ') == std::string_view::npos ? "mathrm" : "text", escaped(text));
  }
  std::string calligraphic(std::string_view text) const override { return fmt::format("\\mathcal{{{}}}", text); }
  std::string digits(std::string_view text) const override { return std::string(text); }
  std::string quoted(std::string_view text) const override { return fmt::format("\\text{{{}}}", escaped(text)); }
  std::string sign(Sign sign) const override {
    switch (sign) {
      case Sign::plus:
        return " + ";
      case Sign::minus:
        return " - ";
      case Sign::negative:
        return "-";
      case Sign::times:
        return " \\cdot ";
      case Sign::invisible:
        return " \\, ";
      case Sign::equal:
      case Sign::equal_to:
        return " = ";
      case Sign::less:
        return " < ";
      case Sign::less_equal:
        return " \\le ";
      case Sign::greater:
        return " > ";
      case Sign::greater_equal:
        return " \\ge ";
      case Sign::not_equal:
        return " \\ne ";
      case Sign::conjunction:
        return " \\text{ and } ";
      case Sign::disjunction:
        return " \\text{ or } ";
      case Sign::negation:
        return "\\text{not } ";
      case Sign::range:
        return " \\ldots ";
      case Sign::comma:
        return ", ";
      case Sign::distributed:
        return " \\sim ";
    }
    return "";
  }
  std::string row(std::vector<std::string> const& pieces) const override { return fmt::format("{}", fmt::join(pieces, "")); }
  std::string fraction(std::string const& above, std::string const& below) const override {
    return fmt::format("\\frac{{{}}}{{{}}}", above, below);
  }
  std::string raised(std::string const& base, std::string const& exponent) const override {
    return fmt::format("{{{}}}^{{{}}}", base, exponent);
  }
  std::string lowered(std::string const& base, std::string const& index) const override {
    return fmt::format("{}_{{{}}}", base, index);
  }
  std::string root(std::string const& inside) const override { return fmt::format("\\sqrt{{{}}}", inside); }
  std::string fenced(Fence fence, std::string const& inside) const override {
    auto const [open, close] = fence == Fence::bars       ? std::pair("|", "|")
                               : fence == Fence::brackets ? std::pair("[", "]")
                                                          : std::pair("(", ")");
    return fmt::format("\\left{}{}\\right{}", open, inside, close);
  }
  std::string dotted(std::string const& base, int dots) const override {
    return fmt::format("\\{}{{{}}}", dots == 1 ? "dot" : dots == 2 ? "ddot" : "dddot", base);
  }
  std::string cases(std::vector<std::pair<std::string, std::string>> const& branches) const override {
    std::string rows;
    for (auto const& [value, condition] : branches)
      rows += fmt::format("{}{} & {}", rows.empty() ? "" : " \\\\ ", value,
                          condition.empty() ? "\\text{otherwise}" : "\\text{if } " + condition);
    return fmt::format("\\begin{{cases}} {} \\end{{cases}}", rows);
  }
  std::string thin_space() const override { return "\\,"; }
};

}  // namespace

Notation const& latex_notation() {
  static Latex const notation;
  return notation;
}

}  // namespace sysid

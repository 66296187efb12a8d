// MathML Core, and well-formed as XML: characters in place of named entities.
#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "core/text/xml.hpp"
#include "typeset/notation.hpp"
#include "typeset/symbol.hpp"

namespace sysid {

namespace {

std::string_view character(Sign sign) {
  switch (sign) {
    case Sign::plus:
      return "+";
    case Sign::minus:
    case Sign::negative:
      return "−";
    case Sign::times:
      return "·";
    case Sign::invisible:
      return "\u2062";
    case Sign::equal:
    case Sign::equal_to:
      return "=";
    case Sign::less:
      return "&lt;";
    case Sign::less_equal:
      return "≤";
    case Sign::greater:
      return "&gt;";
    case Sign::greater_equal:
      return "≥";
    case Sign::not_equal:
      return "≠";
    case Sign::conjunction:
      return "and";
    case Sign::disjunction:
      return "or";
    case Sign::negation:
      return "not";
    case Sign::range:
      return "…";
    case Sign::comma:
      return ",";
    case Sign::distributed:
      return "∼";
  }
  return "";
}

class MathMl final : public Notation {
 public:
  std::string letter(std::string_view text) const override {
    GreekLetter const* greek = greek_letter(text);
    return fmt::format("<mi>{}</mi>", greek != nullptr ? std::string(greek->letter) : escape(text));
  }
  std::string word(std::string_view text) const override {
    return fmt::format("<mi{}>{}</mi>", text_width(text) == 1 ? " mathvariant=\"normal\"" : "", escape(text));
  }
  std::string calligraphic(std::string_view text) const override {
    std::string out;
    for (char const c : text) out += c == 'N' ? "𝒩" : c == 'G' ? "𝒢" : c == 'P' ? "𝒫" : std::string(1, c);
    return fmt::format("<mi>{}</mi>", out);
  }
  std::string digits(std::string_view text) const override { return fmt::format("<mn>{}</mn>", text); }
  std::string quoted(std::string_view text) const override { return fmt::format("<mtext>{}</mtext>", escape(text)); }
  std::string sign(Sign sign) const override {
    switch (sign) {
      case Sign::negative:
        return fmt::format("<mo form=\"prefix\">{}</mo>", character(sign));
      case Sign::invisible:
        return fmt::format("<mo lspace=\"0\" rspace=\"0.17em\">{}</mo>", character(sign));
      case Sign::comma:
        return "<mo separator=\"true\" lspace=\"0\" rspace=\"0.28em\">,</mo>";
      case Sign::conjunction:
      case Sign::disjunction:
      case Sign::negation:
        return fmt::format("<mtext>\u00A0{}\u00A0</mtext>", character(sign));
      default:
        return fmt::format("<mo>{}</mo>", character(sign));
    }
  }
  std::string row(std::vector<std::string> const& pieces) const override {
    if (pieces.size() == 1) return pieces.front();
    return fmt::format("<mrow>{}</mrow>", fmt::join(pieces, ""));
  }
  std::string fraction(std::string const& above, std::string const& below) const override {
    return fmt::format("<mfrac>{}{}</mfrac>", above, below);
  }
  std::string raised(std::string const& base, std::string const& exponent) const override {
    return fmt::format("<msup>{}{}</msup>", base, exponent);
  }
  std::string lowered(std::string const& base, std::string const& index) const override {
    return fmt::format("<msub>{}{}</msub>", base, index);
  }
  std::string root(std::string const& inside) const override { return fmt::format("<msqrt>{}</msqrt>", inside); }
  std::string fenced(Fence fence, std::string const& inside) const override {
    auto const [open, close] = fence == Fence::bars       ? std::pair("|", "|")
                               : fence == Fence::brackets ? std::pair("[", "]")
                                                          : std::pair("(", ")");
    // Around what is no taller than a letter they would grow all the same where the reader has no font for mathematics.
    bool const tall =
        inside.find("<mfrac") != inside.npos || inside.find("<mtable") != inside.npos || inside.find("<msqrt") != inside.npos;
    return fmt::format(
        "<mrow><mo form=\"prefix\" stretchy=\"{0}\">{1}</mo>{2}<mo form=\"postfix\" stretchy=\"{0}\">{3}</mo></mrow>", tall, open,
        inside, close);
  }
  std::string dotted(std::string const& base, int dots) const override {
    constexpr std::string_view accents[] = {"\u02D9", "\u00A8", "\u20DB"};
    return fmt::format("<mover accent=\"true\">{}<mo stretchy=\"false\">{}</mo></mover>", base, accents[dots - 1]);
  }
  std::string cases(std::vector<std::pair<std::string, std::string>> const& branches) const override {
    std::string rows;
    for (auto const& [value, condition] : branches)
      rows += fmt::format("<mtr><mtd>{}</mtd><mtd>{}</mtd></mtr>", value,
                          condition.empty() ? "<mtext>otherwise</mtext>" : "<mrow><mtext>if\u00A0</mtext>" + condition + "</mrow>");
    return fmt::format(
        "<mrow><mo form=\"prefix\" stretchy=\"true\">{{</mo><mtable class=\"cases\" columnalign=\"left\">{}</mtable></mrow>", rows);
  }
  std::string thin_space() const override { return "<mspace width=\"0.17em\"></mspace>"; }
};

}  // namespace

Notation const& mathml_notation() {
  static MathMl const notation;
  return notation;
}

}  // namespace sysid

// Escaping alone is ours; formulas are src/typeset's.
#include "report/typeset.hpp"

#include <fmt/format.h>

#include "typeset/typeset.hpp"

namespace sysid {

std::string escape(std::string_view text) {
  std::string out;
  for (char const c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string typeset(std::string_view statement) {
  if (std::optional<std::string> const formula = mathml(statement)) return *formula;
  return fmt::format("<code>{}</code>", escape(statement));
}

}  // namespace sysid

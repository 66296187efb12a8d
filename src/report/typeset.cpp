// One pass over the characters; what is no name, prime, power, product or minus stays as it is.
#include "report/typeset.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid {

namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80U;
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

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

std::string typeset(std::string_view equation) {
  std::string out;
  for (std::size_t i = 0; i < equation.size();) {
    char const c = equation[i];
    std::size_t end = i + 1;
    if (is_letter(c)) {
      while (end < equation.size() && (is_letter(equation[end]) || is_digit(equation[end]))) ++end;
      bool const call = end < equation.size() && equation[end] == '(';
      std::string const name = escape(equation.substr(i, end - i));
      out += call ? name : "<i>" + name + "</i>";
    } else if (c == '\'') {
      while (end < equation.size() && equation[end] == '\'') ++end;
      for (std::size_t left = end - i; left > 0; left -= std::min<std::size_t>(left, 2)) out += left >= 2 ? "″" : "′";
    } else if (c == '^' && end < equation.size()) {
      // The exponent: one name or number, or what its parentheses hold.
      std::size_t begin = end;
      if (equation[begin] == '(') {
        int depth = 0;
        do depth += equation[end] == '(' ? 1 : equation[end] == ')' ? -1 : 0;
        while (++end < equation.size() && depth > 0);
        out += fmt::format("<sup>{}</sup>", typeset(equation.substr(begin + 1, end - begin - (depth == 0 ? 2 : 1))));
      } else {
        if (equation[end] == '-') ++end;
        while (end < equation.size() && (is_letter(equation[end]) || is_digit(equation[end]) || equation[end] == '.')) ++end;
        out += fmt::format("<sup>{}</sup>", typeset(equation.substr(begin, end - begin)));
      }
    } else if (c == '*') {
      out += "\u2009";
    } else if (c == '-') {
      out += "−";
    } else {
      out += escape(equation.substr(i, 1));
    }
    i = end;
  }
  return out;
}

}  // namespace sysid

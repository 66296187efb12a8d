// Lists and blanks.
#include "core/text/words.hpp"

#include <algorithm>

namespace sysid {

std::string listed(std::vector<std::string> const& names, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0 && i + 1 == names.size())
      text.append(" ").append(last).append(" ");
    else if (i > 0)
      text += ", ";
    text += names[i];
  }
  return text;
}

std::string quoted(std::vector<std::string> const& names, std::string_view last) {
  std::vector<std::string> marked;
  for (std::string const& name : names) marked.push_back("`" + name + "`");
  return listed(marked, last);
}

std::string first_listed(std::vector<std::string> const& names, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more" : text;
}

std::string in_small_letters(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = in_small_letters(c);
  return out;
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  std::size_t const begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

}  // namespace sysid

// Blanks, tabs and line ends separate.
#include "repl/words.hpp"

#include <sstream>

namespace sysid::repl {

std::vector<std::string> words_in(std::string const& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace sysid::repl

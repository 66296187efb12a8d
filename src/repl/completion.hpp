// What may stand where the cursor is.
#pragma once
#include <string>
#include <vector>

#include "repl/workbench.hpp"

namespace sysid::repl {

struct Completions {
  std::size_t begin = 0;           // in the entry: where the word that they continue begins
  std::vector<std::string> words;  // sorted, each once; all begin with what is written
};

/// entry: the lines so far, up to the cursor.
Completions completions(Workbench const& workbench, std::string const& entry);

/// The longest beginning that all words share; whole UTF-8 characters.
std::string common_beginning(std::vector<std::string> const& words);

}  // namespace sysid::repl

// Blocks of pages that quote what a command prints: ```text from COMMAND.
#pragma once
#include <cstdlib>

#include "house/markdown.hpp"

namespace sysid::testing {

/// Checks every block of the pages that quotes `command` against what it printed. With SYSID_BLESS set in the environment a block
/// that quotes all of it is written anew; an excerpt stays what it is, and is mended by hand.
inline void check_quotes(std::string const& command, std::string const& printed) {
  // From the last block of a page to the first, so that writing one anew moves none of the others.
  for (fs::path const& path : pages()) {
    Page const page = read_page(path);
    for (auto block = page.blocks.rbegin(); block != page.blocks.rend(); ++block) {
      if (block->info != "text from " + command) continue;
      if (std::getenv("SYSID_BLESS") != nullptr && block->text.size() == lines_of(printed).size()) {
        bless(page, *block, printed);
        continue;
      }
      std::string const missing = not_printed(block->text, lines_of(printed));
      CHECK_MESSAGE(missing.empty(), page.name << ":" << block->line << ": not printed here: " << missing << "\nprinted:\n"
                                               << printed);
    }
  }
}

}  // namespace sysid::testing

// The pages of the documentation, read as Markdown as far as their tests need it: fenced blocks, prose, headings.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/system/files.hpp"

namespace sysid::testing {

namespace fs = std::filesystem;

inline fs::path const root = SYSID_SOURCE_DIR;

inline std::vector<fs::path> pages() {
  std::vector<fs::path> found = {root / "README.md", root / "models/README.md"};
  for (char const* folder : {"docs", "docs/methods", "docs/stdlib", "docs/decisions"})
    for (auto const& entry : fs::directory_iterator(root / folder))
      if (entry.path().extension() == ".md") found.push_back(entry.path());
  for (auto const& entry : fs::directory_iterator(root / "models"))
    if (fs::exists(entry.path() / "README.md")) found.push_back(entry.path() / "README.md");
  std::sort(found.begin() + 1, found.end());
  return found;
}

inline std::vector<std::string> lines_of(std::string const& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

struct Fence {
  int line = 0;      // of its first fence, from 1
  std::string info;  // behind the fence
  std::vector<std::string> text;
  std::string joined() const {
    std::string all;
    for (std::string const& each : text) all += each + "\n";
    return all;
  }
};

struct Page {
  fs::path path;
  std::string name;
  std::vector<Fence> blocks;
  std::vector<std::string> prose;  // lines outside blocks
};

inline Page read_page(fs::path const& path) {
  Page page{path, fs::relative(path, root).string(), {}, {}};
  bool inside = false;
  int number = 0;
  for (std::string const& line : lines_of(read_file(path))) {
    ++number;
    if (line.starts_with("```")) {
      if (!inside) page.blocks.push_back({number, line.substr(3), {}});
      inside = !inside;
    } else if (inside) {
      page.blocks.back().text.push_back(line);
    } else {
      page.prose.push_back(line);
    }
  }
  REQUIRE_MESSAGE(!inside, page.name << " ends inside a fenced block");
  return page;
}

// As GitHub makes them: lower case, blanks to hyphens, no punctuation.
inline std::string anchor(std::string const& heading) {
  std::string slug;
  for (char const c : heading) {
    bool const letter =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || static_cast<unsigned char>(c) >= 0x80;
    if (letter) slug += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (c == ' ') slug += '-';
  }
  return slug;
}

inline std::set<std::string> anchors(fs::path const& path) {
  std::set<std::string> found;
  for (std::string const& line : read_page(path).prose)
    if (line.starts_with("#")) found.insert(anchor(line.substr(std::min(line.find_first_not_of("# "), line.size()))));
  return found;
}

template <class Visit>
void each_block(std::string const& kind, Visit const& visit) {
  for (fs::path const& path : pages()) {
    Page const page = read_page(path);
    for (Fence const& block : page.blocks)
      if (block.info.starts_with(kind)) visit(page, block);
  }
}

/// The first line of `quoted` that is not in `printed` behind those before it; empty when all are. After three dots some lines may
/// be left out.
inline std::string not_printed(std::vector<std::string> const& quoted, std::vector<std::string> const& printed) {
  std::size_t at = 0;
  bool skip = true;
  for (std::string const& line : quoted) {
    if (line == "...") {
      skip = true;
      continue;
    }
    while (skip && at < printed.size() && printed[at] != line) ++at;
    if (at >= printed.size() || printed[at] != line) return line;
    ++at;
    skip = false;
  }
  return {};
}

/// Whether a block leaves nothing out, so that it can be written anew.
inline bool is_whole(Fence const& block) { return std::find(block.text.begin(), block.text.end(), "...") == block.text.end(); }

/// Writes `printed` in the place of the text of `block`; from the last block of a page to the first, so that none moves another.
inline void bless(Page const& page, Fence const& block, std::string const& printed) {
  std::vector<std::string> const lines = lines_of(read_file(page.path));
  std::string text;
  for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
    if (i < block.line || i >= block.line + static_cast<int>(block.text.size())) text += lines[static_cast<std::size_t>(i)] + "\n";
    if (i + 1 == block.line) text += printed;
  }
  std::ofstream(page.path) << text;
}

/// Text of the language that a reader of the page saves under a name: whole, or behind what stands there.
struct SavedText {
  std::string name;
  bool behind = false;
};
inline std::optional<SavedText> saved_text(Fence const& block) {
  for (auto const& [words, behind] : {std::pair{" saved as ", false}, std::pair{" added to ", true}})
    if (auto const at = block.info.find(words); at != std::string::npos)
      return SavedText{block.info.substr(at + std::string_view(words).size()), behind};
  return std::nullopt;
}

/// Whether the page has its reader save files, so that its commands are run one after the other (followed.cpp).
inline bool is_followed(Page const& page) {
  return std::any_of(page.blocks.begin(), page.blocks.end(), [](Fence const& block) { return saved_text(block).has_value(); });
}

}  // namespace sysid::testing

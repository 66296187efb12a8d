// The pages of the documentation, read as Markdown as far as their tests need it: fenced blocks, prose, headings.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/files.hpp"

namespace sysid::testing {

namespace fs = std::filesystem;

inline fs::path const root = SYSID_SOURCE_DIR;

inline std::vector<fs::path> pages() {
  std::vector<fs::path> found = {root / "README.md"};
  for (char const* folder : {"docs", "docs/stdlib"})
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

}  // namespace sysid::testing

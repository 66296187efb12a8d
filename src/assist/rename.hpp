// A new name for what stands at a place, everywhere: in the file, in modules beside it, and in the files beside it that use them.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "assist/analysis.hpp"

namespace sysid::assist {

/// Bytes of one file, by its path, in the order of the text.
using FileEdits = std::map<std::string, std::vector<Span>>;

struct Renaming {
  FileEdits places;     // each becomes the new name
  std::string refusal;  // why it cannot be; empty: it can
};

/// What would be renamed at `offset`: its place, or why nothing can be.
struct Renameable {
  Span span;
  std::string name, refusal;
};
Renameable can_rename(Reading const& reading, std::uint32_t offset);

/// Refused where the new name is none, where any name would mean something else afterwards, and where the file would have another
/// mistake. The texts with the new name are read and checked for that.
Renaming rename(std::string const& path, std::string const& text, std::uint32_t offset, std::string const& name,
                UnsavedText const& unsaved = {});

/// Of a file that a renaming has places in; empty where it cannot be read any more.
std::string text_of_file(std::string const& path);
/// The text with `name` in all places.
std::string renamed(std::string const& text, std::vector<Span> const& places, std::string const& name);

}  // namespace sysid::assist

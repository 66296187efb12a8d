// Places by the table of names; then the proof that nothing else changed its meaning: the new texts are resolved and checked anew.
#include "assist/rename.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/system/files.hpp"
#include "core/text/words.hpp"
#include "load/load.hpp"
#include "syntax/parse.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

/// A place in a file, whichever text it was read with.
struct FilePlace {
  std::string path;
  std::uint32_t offset = 0;
  friend auto operator<=>(FilePlace const&, FilePlace const&) = default;
};

FilePlace place_of(Source const& source, std::uint32_t offset) {
  int const file = source.place(offset).file;
  return {source.name(file), offset - source.line_begin(1, file)};
}

bool of_library(Reading const& reading, std::uint32_t offset) {
  int const file = reading.source.place(offset).file;
  return file > 0 && std::any_of(reading.modules.begin(), reading.modules.end(), [&](Module const& module) {
           return module.from_library && reading.source.name(file) == "stdlib/" + module.name + ".sysid";
         });
}

/// Why this cannot be renamed; empty: it can.
std::string refusal(Reading const& reading, Occurrence const& occurrence) {
  Symbol const& symbol = reading.names.symbols[static_cast<std::size_t>(occurrence.symbol)];
  switch (symbol.kind) {
    case SymbolKind::word:
      return fmt::format("`{}` is a word of the language", symbol.name);
    case SymbolKind::column:
      return fmt::format("`{}` is a column of a data file", symbol.name);
    case SymbolKind::file:
    case SymbolKind::module:
      return fmt::format("`{}` is a file", symbol.name);
    default:
      break;
  }
  if (symbol.named_after_another) return fmt::format("this task has no name of its own; give it one: `{} = ...`", symbol.name);
  for (Occurrence const& each : reading.names.all_of(occurrence.symbol))
    if (of_library(reading, each.span.begin)) return fmt::format("`{}` is declared in the standard library", symbol.name);
  return {};
}

std::string wrong_name(std::string const& name) {
  bool const good = !name.empty() && words::begins_name(name.front()) &&
                    std::all_of(name.begin(), name.end(), words::continues_name) && !words::contains(words::reserved, name);
  if (good) return "";
  return fmt::format("`{}` is not a valid name: use letters, digits and `_`, and begin with a letter or `_`; {} are reserved", name,
                     quoted({words::reserved.begin(), words::reserved.end()}));
}

/// The file itself and those beside it that use it or one of its modules: what a declaration may be named in.
class Neighbours {
 public:
  Neighbours(std::string const& path, std::string const& text, UnsavedText const& unsaved) : unsaved_(unsaved) {
    texts_[path] = text;
    std::filesystem::path const here(path);
    std::error_code nothing_there;
    for (auto const& entry :
         std::filesystem::directory_iterator(here.has_parent_path() ? here.parent_path() : ".", nothing_there)) {
      if (entry.path().extension() != ".sysid" || entry.path().filename() == here.filename()) continue;
      std::string const beside = (here.parent_path() / entry.path().filename()).string();
      if (std::string const* other = text_of(beside); other != nullptr && other->find("use") != std::string::npos)
        paths_.push_back(beside);
    }
    paths_.insert(paths_.begin(), path);
  }

  std::vector<std::string> const& paths() const { return paths_; }
  /// nullptr where it cannot be read.
  std::string const* text_of(std::string const& path) {
    if (auto const known = texts_.find(path); known != texts_.end()) return &known->second;
    std::optional<std::string> text = unsaved_ ? unsaved_(path) : std::nullopt;
    try {
      if (!text) text = read_regular_file(path, most_text_bytes + 1);
    } catch (IoError const&) {
      return nullptr;
    }
    return &texts_.emplace(path, std::move(*text)).first->second;
  }

 private:
  UnsavedText const& unsaved_;
  std::map<std::string, std::string> texts_;
  std::vector<std::string> paths_;
};

/// Codes of all errors, for comparison.
std::multiset<std::string> errors_of(std::string const& path, std::string const& text, UnsavedText const& unsaved) {
  Source source(path, text);
  Diagnostics diagnostics;
  std::multiset<std::string> codes;
  try {
    load(source, diagnostics, unsaved);
  } catch (std::exception const& error) {
    codes.insert(error.what());
  }
  for (Diagnostic const& each : diagnostics.all())
    if (each.severity == Severity::error) codes.insert(each.code);
  return codes;
}

/// Where a place of the old text is in the new one.
std::uint32_t moved(std::uint32_t offset, std::vector<Span> const& edits, std::size_t length) {
  std::int64_t shift = 0;
  for (Span const edit : edits)
    if (edit.begin < offset) shift += static_cast<std::int64_t>(length) - (edit.end - edit.begin);
  return static_cast<std::uint32_t>(offset + shift);
}

/// The first name that means something else in the new text; empty: none does.
std::string changed_meaning(Reading const& before, Reading const& after, FileEdits const& edits, std::size_t length) {
  static std::vector<Span> const none;
  std::map<FilePlace, int> now;  // groups of the new table
  for (Occurrence const& each : after.names.occurrences)
    now.emplace(place_of(after.source, each.span.begin), after.names.group[static_cast<std::size_t>(each.symbol)]);
  std::map<int, int> there, back;
  for (Occurrence const& each : before.names.occurrences) {
    FilePlace place = place_of(before.source, each.span.begin);
    auto const edited = edits.find(place.path);
    place.offset = moved(place.offset, edited == edits.end() ? none : edited->second, length);
    std::string const text(before.source.text(each.span));
    auto const found = now.find(place);
    if (found == now.end()) return text;
    int const old_group = before.names.group[static_cast<std::size_t>(each.symbol)];
    if (there.emplace(old_group, found->second).first->second != found->second) return text;
    if (back.emplace(found->second, old_group).first->second != old_group) return text;
    now.erase(found);
  }
  return now.empty() ? "" : "another name";
}

}  // namespace

std::string text_of_file(std::string const& path) {
  try {
    return read_regular_file(path, most_text_bytes + 1);
  } catch (IoError const&) {
    return {};
  }
}

std::string renamed(std::string const& text, std::vector<Span> const& places, std::string const& name) {
  std::string result;
  std::uint32_t from = 0;
  for (Span const place : places) {
    result += text.substr(from, place.begin - from) + name;
    from = place.end;
  }
  return result + text.substr(from);
}

Renameable can_rename(Reading const& reading, std::uint32_t offset) {
  Occurrence const* found = reading.names.at(offset);
  if (found == nullptr) return {{}, {}, "there is no name here"};
  return {found->span, std::string(reading.source.text(found->span)), refusal(reading, *found)};
}

Renaming rename(std::string const& path, std::string const& text, std::uint32_t offset, std::string const& name,
                UnsavedText const& unsaved) {
  auto const reading = read(path, text, unsaved);
  if (!reading || !reading->complete)
    return {{}, "the text has syntax errors: names in the parts that cannot be read would be missed"};
  Renameable const what = can_rename(*reading, offset);
  if (!what.refusal.empty()) return {{}, what.refusal};
  if (std::string wrong = wrong_name(name); !wrong.empty()) return {{}, std::move(wrong)};
  if (name == what.name) return {};

  Neighbours neighbours(path, text, unsaved);
  std::map<std::string, std::shared_ptr<Reading const>> readings;
  for (std::string const& each : neighbours.paths()) {
    auto read_there = each == path ? reading : read(each, *neighbours.text_of(each), unsaved);
    if (read_there) readings.emplace(each, std::move(read_there));
  }
  // A name of a module is known by its place; what a neighbour adds to the places may add to those of another.
  std::set<FilePlace> known;
  std::map<FilePlace, std::uint32_t> ends;
  known.insert(place_of(reading->source, what.span.begin));
  for (std::size_t size = 0; size != known.size();) {
    size = known.size();
    for (auto const& [root, there] : readings) {
      std::set<int> groups;
      for (Occurrence const& each : there->names.occurrences)
        if (known.contains(place_of(there->source, each.span.begin)))
          groups.insert(there->names.group[static_cast<std::size_t>(each.symbol)]);
      for (Occurrence const& each : there->names.occurrences) {
        if (!groups.contains(there->names.group[static_cast<std::size_t>(each.symbol)])) continue;
        if (std::string why = refusal(*there, each); !why.empty()) return {{}, std::move(why)};
        FilePlace const place = place_of(there->source, each.span.begin);
        known.insert(place);
        ends[place] = place.offset + each.span.end - each.span.begin;
      }
    }
  }
  Renaming result;
  for (auto const& [place, end] : ends) result.places[place.path].push_back({place.offset, end});

  std::map<std::string, std::string> texts;
  for (auto const& [file, places] : result.places) {
    std::string const* old = neighbours.text_of(file);
    if (old == nullptr) return {{}, fmt::format("cannot read `{}`", file)};
    texts[file] = renamed(*old, places, name);
  }
  UnsavedText const with_new_name = [&](std::string const& file) -> std::optional<std::string> {
    if (auto const changed = texts.find(file); changed != texts.end()) return changed->second;
    return unsaved ? unsaved(file) : std::nullopt;
  };
  for (auto const& [root, before] : readings) {
    bool touched = false;
    for (int file = 0; file < before->source.files(); ++file) touched = touched || texts.contains(before->source.name(file));
    if (!touched) continue;
    std::string const& old_text = *neighbours.text_of(root);
    std::string const& new_text = texts.contains(root) ? texts.at(root) : old_text;
    auto const after = read(root, new_text, with_new_name);
    if (!after || after->complete != before->complete)
      return {{}, fmt::format("`{}` cannot replace `{}` everywhere: a statement would get another meaning", name, what.name)};
    if (std::string const changed = changed_meaning(*before, *after, result.places, name.size()); !changed.empty())
      return {{},
              fmt::format("`{}` is already used where `{}` occurs: {} would mean something else", name, what.name,
                          changed == what.name ? "it" : "`" + changed + "`")};
    if (errors_of(root, new_text, with_new_name) != errors_of(root, old_text, unsaved))
      return {{}, fmt::format("with `{}` in place of `{}` the file would not have the same errors as now", name, what.name)};
  }
  return result;
}

}  // namespace sysid::assist

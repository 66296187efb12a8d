// The workspace of a session at the prompt: a file of the language, statement by statement, as they were typed or loaded.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/source.hpp"
#include "syntax/ast.hpp"

namespace sysid::repl {

enum class ItemKind { use, model, data, candidates, dictionary, function, task };
std::string_view word_of(ItemKind kind);

/// "model duffing": tells the statements of a file apart.
std::string title_of(ItemKind kind, std::string_view name);

/// A part of a text that stands word for word in what was typed.
struct TypedPart {
  Span in_text;
  std::uint32_t in_typed = 0;
};

/// A statement that stands directly in the file.
struct WorkItem {
  ItemKind kind = ItemKind::task;
  std::string name;
  std::string lead;       // comments before it, in lines of their own
  std::string text;       // as written
  std::string kept_of{};  // what it was called before it was changed and kept for tasks that had been run on it; else empty
  std::vector<TypedPart> typed{};  // of `text`, what stands in the entry that is being taken in
};

/// A name by which one statement refers to another.
struct ItemReference {
  ItemKind kind;
  Span span;  // of the name
  std::string name;
};

/// Kind and name of an item; of a task without a name its derived one.
ItemKind kind_of(ast::Item const& item);
std::string name_of(ast::Item const& item);
Span span_of(ast::Item const& item);
/// What stands in its own text under its own name: the name's place; none for an unnamed task and `use`.
std::vector<ItemReference> references_of(ast::Item const& item);

/// The one item of a text that parses.
ast::Item item_of(std::string const& text);

class Workspace {
 public:
  std::vector<WorkItem> items;

  /// Where the file lies or will lie: paths of data and modules are relative to its folder.
  std::filesystem::path path = "work.sysid";

  std::string text() const;
  /// Where the text of an item begins in `text()`.
  std::uint32_t begin(std::size_t item) const;
  /// items.size() when there is none.
  std::size_t find(ItemKind kind, std::string_view name) const;
  /// The same among all kinds but `use`; the first.
  std::size_t find(std::string_view name) const;

  /// Takes the place of the item of that kind and name, or goes to the end. A task goes to the end as long as no other refers to
  /// it, since tasks run in order. run: tasks that have been run; what they were run on is kept beside under a name of its own when
  /// it changes, and they refer to that. Returns the notices about it.
  std::vector<std::string> put(WorkItem item, std::set<std::string> const& run);
  /// Without what was kept for tasks that no longer refer to it.
  void prune();
  /// Paths of data files, relative to `path`, as seen from `folder`; absolute ones stay.
  void move_to(std::filesystem::path const& path);

 private:
  std::vector<std::string> keep_earlier(std::size_t item, std::set<std::string> const& run);
};

/// The statements of a file, with the comments that stand before each; comments behind the last are lost with nothing.
std::vector<WorkItem> items_of(std::string const& text);

}  // namespace sysid::repl

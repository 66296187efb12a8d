// What may stand at a place, gathered: names of the file, words of the language, files and columns.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "assist/analysis.hpp"
#include "assist/completion.hpp"
#include "assist/completion_place.hpp"
#include "assist/vocabulary.hpp"

namespace sysid::assist {

/// Each call adds to the list; a label that is there already is not added again.
class Offer {
 public:
  /// path and place are borrowed.
  Offer(std::string const& path, std::string const& text, CompletionPlace const& place, UnsavedText const& unsaved)
      : path_(path), place_(place), reading_(read(path, text, unsaved)) {}

  CompletionPlace const& place() const { return place_; }
  bool empty() const { return items_.empty(); }
  std::vector<Completion> take() { return std::move(items_); }

  // --- words of the language ---
  void add(Completion item);
  void keyword(std::string_view word) { add({std::string(word), CompletionKind::keyword, {}, {}}); }
  void keywords(std::span<std::string_view const> words);
  void vocabulary(std::vector<Word> const& words, CompletionKind kind);
  void vocabulary(WordKind kind, CompletionKind as = CompletionKind::word) { vocabulary(words_of(kind), as); }
  void settings(std::string_view owner) { vocabulary(settings_of(owner), CompletionKind::setting); }
  /// False: the setting has no choices.
  bool choices(std::string_view owner, std::string_view setting);
  void units();

  // --- names of the file ---
  void of_kind(SymbolKind kind);
  /// In the file itself, not in its modules.
  void own(SymbolKind kind);
  /// Of the model or dictionary that the task is about; where it is not known, of all.
  void of_subject(SymbolKind kind, std::optional<SymbolKind> or_kind = std::nullopt);
  /// Behind `bench.`, or behind the path of a part.
  void members();
  void states_and_parts();
  void quantities();
  void functions();
  void channels();
  /// Parameters that a model leaves open, its inputs among them where it is a part.
  void arguments_of_model(std::string const& model, bool inputs_too);
  /// `function f(a, b) = `: what stands in its brackets.
  void function_arguments();
  void expression();

  // --- files ---
  void modules();
  void files();
  /// Of the file that the data block names.
  void columns();

 private:
  std::vector<Symbol> const& all() const { return reading_->names.symbols; }
  /// wanted: of a Symbol const&.
  template <class Wanted>
  void symbols(Wanted const& wanted);
  /// The symbol of the block around the place, and of the model or dictionary of the task; -1: there is none.
  int block() const;
  int subject() const;
  void of_part(int owner);
  void columns_of(std::string const& file);
  std::filesystem::path folder() const;

  std::string const& path_;
  CompletionPlace const& place_;
  std::shared_ptr<Reading const> reading_;  // null: the text cannot be read
  std::set<std::string> seen_;
  std::vector<Completion> items_;
};

}  // namespace sysid::assist

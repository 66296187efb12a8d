// Rules over messages go by the names that a message gives, so it gives those that its sentence quotes.
#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "checking.hpp"
#include "core/system/files.hpp"
#include "syntax/words.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::filesystem::path const examples = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/errors";

bool is_name(std::string_view word) {
  return !word.empty() && words::begins_name(word.front()) && std::all_of(word.begin(), word.end(), words::continues_name);
}

/// The names that stand in a text, comments and units included.
std::set<std::string> names_in(std::string_view text) {
  std::set<std::string> names;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && words::continues_name(text[end])) ++end;
    if (is_name(text.substr(begin, end - begin))) names.emplace(text.substr(begin, end - begin));
    begin = std::max(end, begin + 1);
  }
  return names;
}

/// What stands in back quotes in a sentence and is a name as it stands.
std::set<std::string> quoted_in(std::string_view sentence) {
  std::set<std::string> quoted;
  for (std::size_t open = sentence.find('`'); open != std::string_view::npos;) {
    std::size_t const close = sentence.find('`', open + 1);
    if (close == std::string_view::npos) break;
    std::string_view const word = sentence.substr(open + 1, close - open - 1);
    if (is_name(word)) quoted.emplace(word);
    open = sentence.find('`', close + 1);
  }
  return quoted;
}

/// A word of the language, which a sentence may quote without being about it: "as written after `observe`".
bool is_word_of_the_language(std::string_view word) {
  using Table = std::span<std::string_view const>;
  for (Table const table :
       {Table(words::reserved), Table(words::items), Table(words::verbs), Table(words::prepositions), Table(words::task_words),
        Table(words::model_statements), Table(words::model_words), Table(words::data_statements), Table(words::data_words),
        Table(words::candidate_words), Table(words::dictionary_statements)})
    if (words::contains(table, word)) return true;
  return false;
}

}  // namespace

TEST_CASE("a message gives the names of the text that its sentence quotes") {
  std::filesystem::path const before = std::filesystem::current_path();
  std::filesystem::current_path(examples);  // where the modules of the examples are
  int checked_names = 0;
  for (auto const& entry : std::filesystem::directory_iterator(examples)) {
    if (entry.path().extension() != ".sysid") continue;
    std::string const text = read_file(entry.path());
    std::set<std::string> const written = names_in(text);
    Source source(entry.path().filename().string(), text);
    Diagnostics diagnostics;
    load(source, diagnostics);
    for (Diagnostic const& each : diagnostics.all()) {
      if (each.code.starts_with("E1")) continue;  // syntax: what is quoted is what could not be read
      for (std::string const& word : quoted_in(each.message)) {
        if (!written.contains(word) || is_word_of_the_language(word)) continue;
        ++checked_names;
        CHECK_MESSAGE(std::find(each.names.begin(), each.names.end(), word) != each.names.end(),
                      source.name() << ": " << each.code << " does not give `" << word << "`: " << each.message);
      }
    }
  }
  std::filesystem::current_path(before);
  CHECK(checked_names > 100);
}

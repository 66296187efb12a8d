// The TextMate grammar: applied to every shipped model as an editor applies it, line by line, and held to what the compiler's own
// scan and the table of names say of every token.
#include <doctest/doctest.h>

#include <map>
#include <regex>
#include <set>

#include "assist/analysis.hpp"
#include "assist/vocabulary.hpp"
#include "client.hpp"
#include "grammar/message/layout.hpp"
#include "syntax/words.hpp"

using namespace sysid;
using namespace sysid::test;
using assist::SymbolKind;
using assist::WordKind;

namespace {

/// The patterns keep to what ECMAScript's regular expressions and Oniguruma's have in common.
class Highlighter {
 public:
  explicit Highlighter(Json grammar) : grammar_(std::move(grammar)) { prepare(grammar_); }

  /// The innermost scope of every byte.
  std::vector<std::string> operator()(std::string const& text) {
    std::vector<std::string> scopes(text.size());
    std::vector<Json const*> open;  // rules with an end
    for (std::size_t begin = 0; begin < text.size();) {
      std::size_t const end = std::min(text.find('\n', begin), text.size());
      line(text.substr(begin, end - begin), begin, open, scopes);
      begin = end + 1;
    }
    CHECK(open.empty());
    return scopes;
  }

 private:
  void prepare(Json const& node) {
    if (node.is_object())
      for (char const* key : {"match", "begin", "end"})
        if (node.contains(key) && node.at(key).is_string())
          regexes_.emplace(node.at(key).get<std::string>(), std::regex(node.at(key).get<std::string>(), std::regex::optimize));
    if (node.is_structured())
      for (auto const& each : node) prepare(each);
  }

  void collect(Json const& patterns, std::vector<Json const*>& rules) const {
    for (Json const& each : patterns) {
      Json const& rule =
          each.contains("include") ? grammar_.at("repository").at(each.at("include").get<std::string>().substr(1)) : each;
      if (rule.contains("match") || rule.contains("begin"))
        rules.push_back(&rule);
      else
        collect(rule.at("patterns"), rules);
    }
  }
  std::vector<Json const*> const& rules_of(Json const* owner) {
    auto const [place, fresh] = rules_.try_emplace(owner);
    if (fresh && (owner == nullptr ? grammar_ : *owner).contains("patterns"))
      collect((owner == nullptr ? grammar_ : *owner).at("patterns"), place->second);
    return place->second;
  }

  void line(std::string const& text, std::size_t offset, std::vector<Json const*>& open, std::vector<std::string>& scopes) {
    std::size_t at = 0;
    for (int guard = 0; guard < 10000; ++guard) {
      Json const* current = open.empty() ? nullptr : open.back();
      Json const* found = nullptr;
      bool ends = false;
      std::smatch best;
      auto const attempt = [&](std::string const& pattern, Json const* rule, bool end) {
        std::smatch match;
        auto const flags = at == 0 ? std::regex_constants::match_default : std::regex_constants::match_not_bol;
        if (!std::regex_search(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), match, regexes_.at(pattern), flags))
          return;
        if (match.length(0) == 0 || (found != nullptr && match.position(0) >= best.position(0))) return;
        best = match;
        found = rule;
        ends = end;
      };
      if (current != nullptr) attempt(current->at("end"), current, true);
      for (Json const* rule : rules_of(current))
        attempt(rule->contains("match") ? rule->at("match") : rule->at("begin"), rule, false);
      std::string const around = current == nullptr ? "" : current->value("name", "");
      auto const paint = [&](std::size_t from, std::size_t to, std::string const& scope) {
        for (std::size_t i = from; i < to; ++i) scopes[offset + i] = scope;
      };
      if (found == nullptr) return paint(at, text.size(), around);
      std::size_t const begin = at + static_cast<std::size_t>(best.position(0)),
                        end = begin + static_cast<std::size_t>(best.length(0));
      paint(at, begin, around);
      paint(begin, end, found->value("name", around));
      char const* key = found->contains("match") ? "captures" : ends ? "endCaptures" : "beginCaptures";
      if (found->contains(key))
        for (auto const& [group, capture] : found->at(key).items()) {
          auto const i = static_cast<std::size_t>(std::stoi(group));
          if (!best[i].matched) continue;
          std::size_t const from = at + static_cast<std::size_t>(best.position(i));
          paint(from, from + static_cast<std::size_t>(best.length(i)), capture.at("name"));
        }
      if (ends)
        open.pop_back();
      else if (found->contains("begin"))
        open.push_back(found);
      at = end;
    }
    FAIL("a line without an end");
  }

  Json grammar_;
  std::map<std::string, std::regex> regexes_;
  std::map<Json const*, std::vector<Json const*>> rules_;
};

Json text_mate_grammar() { return Json::parse(content(std::filesystem::path(SYSID_SOURCE_DIR) / "grammar/sysid.tmLanguage.json")); }

/// What stands between the bars of the first group that has any.
std::set<std::string> alternatives(std::string const& pattern) {
  std::smatch match;
  std::set<std::string> words;
  static std::regex const group("\\((?:\\?:)?([a-z0-9_]+(?:\\|[a-z0-9_]+)*)\\)");
  if (!std::regex_search(pattern, match, group)) return words;
  std::istringstream stream(match[1].str());
  for (std::string word; std::getline(stream, word, '|');) words.insert(word);
  return words;
}

template <class Words>
std::set<std::string> as_set(Words const& words) {
  return {std::begin(words), std::end(words)};
}
std::set<std::string> names_of(std::vector<WordKind> const& kinds) {
  std::set<std::string> names;
  for (WordKind const kind : kinds)
    for (assist::Word const& word : assist::words_of(kind)) names.insert(word.name);
  return names;
}

/// What a token's scope begins with.
std::vector<std::string> expected(grammar::Token const& token, std::string const& text, assist::Reading const& reading,
                                  bool in_unit, bool first) {
  using grammar::TokenKind;
  if (in_unit) return {"constant.other.unit"};
  if (token.kind == TokenKind::text) return {"string."};
  if (token.kind == TokenKind::number) return {"constant.numeric"};
  if (token.is(".")) return {"variable."};  // within a path
  if (token.kind == TokenKind::symbol) return {"keyword.operator", "punctuation"};
  if (words::contains(words::reserved, token.text)) return {"keyword.control", "keyword.operator.logical"};
  assist::Occurrence const* occurrence = reading.names.at(token.span.begin);
  bool const called = token.span.end < text.size() && text[token.span.end] == '(';
  if (occurrence == nullptr || occurrence->span.begin != token.span.begin) {
    static std::set<std::string> const within = {"with", "to",         "on",       "from",        "hold",   "error", "rows",
                                                 "per",  "experiment", "discrete", "probability", "shared", "input"};
    if (called) return {"support.function"};  // gp, values
    if (first || words::contains(words::verbs, token.text)) return {"keyword."};
    if (within.contains(std::string(token.text))) return {"keyword.other", "keyword.declaration"};
    return {"variable.", "constant.language"};
  }
  switch (reading.names.symbols[static_cast<std::size_t>(occurrence->symbol)].kind) {
    case SymbolKind::model:
      return {"entity.name.type", "variable.", "entity.name.function"};
    case SymbolKind::data:
    case SymbolKind::candidates:
    case SymbolKind::dictionary:
      return {occurrence->declares ? "entity.name.type" : "variable."};
    case SymbolKind::task:
      return {occurrence->declares ? "entity.name.tag" : "variable."};
    case SymbolKind::function:
    case SymbolKind::process:
      return {"entity.name.function"};
    case SymbolKind::module:
      return {"entity.name.namespace"};
    case SymbolKind::word:
      return called ? std::vector<std::string>{"support.function", "entity.name.function"}
                    : std::vector<std::string>{"variable.", "keyword.other"};
    default:
      return {"variable."};
  }
}

}  // namespace

TEST_CASE("the words of the TextMate grammar are those of the language") {
  Json const rules = text_mate_grammar().at("repository");
  auto const words_in = [&](char const* rule) { return alternatives(rules.at(rule).at("match")); };
  CHECK(words_in("functions") == names_of({WordKind::function}));
  CHECK(words_in("distributions") == names_of({WordKind::distribution}));
  CHECK(words_in("laws") == names_of({WordKind::law}));
  CHECK(words_in("kernels") == names_of({WordKind::kernel}));
  CHECK(words_in("families") == names_of({WordKind::family}));
  CHECK(words_in("methods") == names_of({WordKind::fitting, WordKind::selecting, WordKind::discovering, WordKind::derivative,
                                         WordKind::solver, WordKind::signal}));
  std::set<std::string> model = words_in("model-statement");
  model.merge(words_in("declaration"));
  CHECK(model == as_set(words::model_statements));
  CHECK(words_in("data-statement") == as_set(words::data_statements));
  std::set<std::string> dictionary = words_in("dictionary-statement");
  dictionary.merge(words_in("dictionary-list"));
  CHECK(dictionary == as_set(words::dictionary_statements));
  std::set<std::string> candidates = words_in("candidate-statement");
  candidates.merge(words_in("candidate-words"));
  CHECK(candidates == as_set(words::candidate_words));
  std::string const task = rules.at("task").at("match");
  for (std::string_view const verb : words::verbs) {
    CAPTURE(verb);
    CHECK(task.find(verb) != std::string::npos);
  }
  std::set<std::string> const prepositions = alternatives(rules.at("task-words").at("patterns").at(0).at("match"));
  CHECK(prepositions == as_set(words::prepositions));
  CHECK(alternatives(rules.at("task-words").at("patterns").at(1).at("match")) == as_set(words::task_words));
  std::set<std::string> reserved = alternatives(rules.at("reserved").at("patterns").at(0).at("match"));
  reserved.merge(alternatives(rules.at("reserved").at("patterns").at(1).at("match")));
  CHECK(reserved == as_set(words::reserved));
  for (std::string_view const block : words::blocks) CHECK(rules.contains(std::string(block)));
}

TEST_CASE("every token and comment of every shipped model has its scope") {
  Highlighter highlight(text_mate_grammar());
  std::vector<std::filesystem::path> files = shipped_models();
  for (auto const& entry : std::filesystem::directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / "stdlib"))
    files.push_back(entry.path());
  int tokens = 0;
  for (std::filesystem::path const& path : files) {
    std::string const text = content(path);
    CAPTURE(path.string());
    auto const reading = assist::read(path.string(), text);
    REQUIRE(reading);
    std::vector<std::string> const scopes = highlight(text);
    Source const source("", text);
    Diagnostics none;
    grammar::Layout const layout = grammar::lay_out(source, none, 1);
    for (Span const comment : layout.comments)
      for (std::uint32_t i = comment.begin; i < comment.end; ++i) REQUIRE(scopes[i] == "comment.line.sysid");
    bool in_unit = false;
    for (std::size_t t = 0; t < layout.tokens.size(); ++t) {
      grammar::Token const& token = layout.tokens[t];
      // An index stands directly behind its name.
      if (token.is("["))
        in_unit =
            t == 0 || layout.tokens[t - 1].kind != grammar::TokenKind::word || layout.tokens[t - 1].span.end < token.span.begin;
      bool const first = t == 0 || layout.tokens[t - 1].statement != token.statement;
      std::vector<std::string> const wanted = expected(token, text, *reading, in_unit, first);
      std::string const scope = scopes[token.span.begin];
      CAPTURE(source.place(token.span.begin).line);
      CAPTURE(token.text);
      CAPTURE(scope);
      CHECK(std::any_of(wanted.begin(), wanted.end(), [&](std::string const& each) { return scope.starts_with(each); }));
      // The whole of it has one scope, primes and indices aside.
      for (std::uint32_t i = token.span.begin; i < token.span.end && text[i] != '\''; ++i) CHECK(scopes[i] == scope);
      if (in_unit && token.is("]")) in_unit = false;
      ++tokens;
    }
  }
  MESSAGE(tokens << " tokens");
  CHECK(tokens > 5000);
}

TEST_CASE("the extension for VS Code names files that are there") {
  std::filesystem::path const folder = std::filesystem::path(SYSID_SOURCE_DIR) / "grammar";
  Json const manifest = Json::parse(content(folder / "vscode/package.json"));
  Json const configuration = Json::parse(content(folder / "language-configuration.json"));
  CHECK(configuration.at("comments").at("lineComment") == "#");
  auto const there = [&](std::string const& path) {
    return std::filesystem::exists(folder / path) || std::filesystem::exists(folder / "vscode" / path);
  };
  CHECK(there(manifest.at("main")));
  CHECK(there(manifest.at("contributes").at("languages").at(0).at("configuration")));
  CHECK(there(manifest.at("contributes").at("grammars").at(0).at("path")));
  CHECK(manifest.at("contributes").at("grammars").at(0).at("scopeName") == text_mate_grammar().at("scopeName"));
}

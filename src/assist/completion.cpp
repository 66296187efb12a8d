// By the place of the word: which block, which statement, which bracket.
#include "assist/completion.hpp"

#include <algorithm>

#include "assist/completion_offer.hpp"
#include "assist/completion_place.hpp"
#include "assist/vocabulary.hpp"
#include "check/checked/task_kinds.hpp"
#include "distribution/distribution.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

using grammar::Token;
using grammar::TokenKind;

class Completer : private Offer {
 public:
  using Offer::Offer;

  std::vector<Completion> run() {
    if (place().in_text)
      files();
    else if (!place().path.empty())
      members();
    else if (!place().brackets.empty() && place().brackets.back().symbol == '[' && unit_bracket())
      units();
    else if (place().block == "model")
      model();
    else if (place().block == "data")
      data();
    else if (place().block == "candidates")
      candidates();
    else if (place().block == "dictionary")
      dictionary();
    else
      top();
    return take();
  }

 private:
  /// A `[` behind a number, a declared name or a column; directly behind a name of an expression it opens an index.
  bool unit_bracket() const {
    auto const& tokens = place().before;
    for (std::size_t i = tokens.size(); i-- > 0;)
      if (tokens[i].is("["))
        return i == 0 || tokens[i - 1].kind != TokenKind::word || tokens[i - 1].span.end < tokens[i].span.begin;
    return true;
  }
  /// Behind `~`, and in the brackets of what stands there.
  void distribution(bool noise) {
    if (place().brackets.empty()) {
      for (Word const& word : words_of(WordKind::distribution))
        if (!noise || find_distribution(word.name)->noise) add({word.name, CompletionKind::word, word.signature, word.summary});
      return;
    }
    OpenBracket const& inner = place().brackets.back();
    if (inner.begins && inner.argument.empty() && find_distribution(inner.callee) != nullptr) settings(inner.callee);
    expression();
  }
  /// Behind the `~` of a disturbance.
  void law() {
    if (place().brackets.empty()) {
      vocabulary(WordKind::law);
      return add({"normal", CompletionKind::word, find_word(WordKind::distribution, "normal")->signature, "in discrete time"});
    }
    OpenBracket const& inner = place().brackets.back();
    if (inner.begins && inner.argument.empty()) settings(inner.callee);
    expression();
  }
  void normal() {
    Word const& word = *find_word(WordKind::distribution, "normal");
    if (place().brackets.empty()) return add({word.name, CompletionKind::word, word.signature, word.summary});
    OpenBracket const& inner = place().brackets.back();
    if (inner.begins && inner.argument.empty()) settings("normal");
  }
  void process() {
    if (place().brackets.empty()) return add({"gp", CompletionKind::word, "gp(covariance)", "a Gaussian process of mean zero"});
    OpenBracket const& inner = place().brackets.back();
    if (inner.callee == "gp") return vocabulary(WordKind::kernel);
    if (inner.begins && inner.argument.empty()) settings(inner.callee);
    function_arguments();
    quantities();
  }
  void part() {
    if (!place().has("=")) return;
    if (place().brackets.empty()) return of_kind(SymbolKind::model);
    OpenBracket const& inner = place().brackets.back();
    if (place().brackets.size() == 1 && inner.begins && inner.argument.empty()) arguments_of_model(inner.callee, true);
    expression();
  }
  void model() {
    std::string_view const first = place().first();
    if (place().before.empty()) {
      keywords(words::model_statements);
      return expression();
    }
    if (!words::contains(words::model_statements, first) ||
        (place().before.size() > 1 && place().before[1].kind == TokenKind::symbol))  // an equation about something called `input`
      return expression();
    if (first == "part") return part();
    if (place().has("~")) {
      if (first == "function") return process();
      if (first == "disturbance") return law();
      return distribution(first == "observe");
    }
    if (place().has("=") || (!place().brackets.empty() && first != "function")) return expression();
    if (first == "time" && place().before.size() == 1) return keyword("discrete");
    if (first == "initial") return states_and_parts();
    if (first == "parameter" && place().before.size() >= 2) keyword(place().follows("per") ? "experiment" : "per");
  }

  void data() {
    std::string_view const first = place().first();
    if (place().before.empty()) return keywords(words::data_statements);
    if (first == "time" && place().before.size() == 1) return columns();
    if (first == "read") return reading();
    if (first == "split") return place().follows("=") ? keyword("rows") : void();
    if (first == "constant") return place().has("=") ? expression() : own(SymbolKind::parameter);
    if (first != "input" && first != "measure") return;
    if (place().before.size() == 1) return of_kind(first == "input" ? SymbolKind::input : SymbolKind::channel);
    if (place().follows("=")) return columns();
    if (place().follows("hold")) return vocabulary(choices_of("", "hold"), CompletionKind::choice);
    if (first != "input" || !place().has("=")) return;
    if (place().has("error")) return normal();
    if (!place().has("hold")) keyword("hold");
    keyword("error");
  }

  void reading() {
    if (place().follows("read") || place().follows(",")) {
      return vocabulary(reading_settings(), CompletionKind::setting);
    }
    auto const& tokens = place().before;
    if (!place().follows("=") || tokens.size() < 2) return;
    if (tokens[tokens.size() - 2].is("date")) return columns();
    vocabulary(choices_of("read", tokens[tokens.size() - 2].text), CompletionKind::choice);
  }

  void candidates() {
    if (place().before.empty()) {
      of_kind(SymbolKind::model);
      return keyword("shared");
    }
    if (place().first() == "shared") return of_kind(SymbolKind::parameter);
    if (!place().brackets.empty()) return arguments_of_model(place().brackets.back().callee, false);
    if (!place().has("probability")) keyword("probability");
  }

  void dictionary() {
    std::string_view const first = place().first();
    if (place().before.empty()) return keywords(words::dictionary_statements);
    if (!place().has("=")) return;
    if (first == "state") return of_kind(SymbolKind::channel);
    if (first == "coefficients") return;
    if (first == "terms" || first == "exclude") vocabulary(WordKind::family, CompletionKind::function);
    if (!place().brackets.empty() && place().brackets.back().argument.empty()) settings(place().brackets.back().callee);
    expression();
  }

  void top() {
    auto const& tokens = place().before;
    if (tokens.empty()) {
      keywords(words::items);
      return keywords(words::verbs);
    }
    if (tokens.front().is("use")) return modules();
    if (tokens.front().is("function")) return place().has("=") ? expression() : void();
    if (tokens.size() == 2 && tokens[1].is("=")) return keywords(words::verbs);
    std::size_t const verb = tokens.size() > 2 && tokens[1].is("=") ? 2 : 0;
    if (words::contains(words::verbs, tokens[verb].text)) task(tokens[verb].text, verb);
  }

  void task(std::string_view verb, std::size_t at) {
    auto const& tokens = place().before;
    if (tokens.size() == at + 1) return subjects(verb);
    if (place().has("with")) return option(verb);
    bool const has_preposition = std::any_of(tokens.begin(), tokens.end(),
                                             [](Token const& token) { return words::contains(words::prepositions, token.text); });
    if (!has_preposition && place().follows(",") && words::task_kind(verb) == TaskKind::predict) return own(SymbolKind::task);
    if (words::contains(words::prepositions, tokens.back().text) || (has_preposition && place().follows(",")))
      return own(SymbolKind::data);
    if (!place().brackets.empty()) return arguments_of_model(place().brackets.back().callee, false);
    TaskKindRow const* const row = find_task_kind(verb);
    if (!has_preposition && row != nullptr && !row->preposition.empty()) keyword(std::string(row->preposition));
    keyword("with");
  }
  void subjects(std::string_view verb) {
    auto const kind = words::task_kind(verb);
    if (kind == TaskKind::predict) return own(SymbolKind::task);
    if (kind == TaskKind::discover) return own(SymbolKind::dictionary);
    if (kind == TaskKind::select) own(SymbolKind::candidates);
    of_kind(SymbolKind::model);
  }

  void option(std::string_view verb) {
    if (!place().brackets.empty()) return setting(verb);
    auto const& tokens = place().before;
    if (place().follows("with") || place().follows(",")) {
      vocabulary(options_of(verb), CompletionKind::setting);
      return vocabulary(backends_of(verb), CompletionKind::function);
    }
    if (place().follows("input")) return of_subject(SymbolKind::input);
    if (!place().follows("=")) return;
    bool const signal = tokens.size() > 2 && tokens[tokens.size() - 3].is("input");
    if (signal) return vocabulary(WordKind::signal, CompletionKind::function);
    std::string_view const key = tokens[tokens.size() - 2].text;
    choices(verb, key);
    if (key == "distance") functions();
  }
  void setting(std::string_view verb) {
    OpenBracket const& inner = place().brackets.back();
    if (inner.callee == "values") return of_subject(SymbolKind::parameter, SymbolKind::part);
    if (inner.callee == "near") return own(SymbolKind::task);
    if (inner.callee == "weights" || inner.callee == "noise") return of_subject(SymbolKind::channel);
    if (inner.callee == "measured" || inner.callee == "predicted" || inner.callee == "residual") return channels();
    if (!inner.argument.empty()) {
      choices(inner.callee, inner.argument);
      return;
    }
    settings(inner.callee);
    if (empty() && words::task_kind(verb) == TaskKind::select) functions();
  }
};

}  // namespace

Completions complete(std::string const& path, std::string const& text, std::uint32_t offset, UnsavedText const& unsaved) {
  CompletionPlace place;
  find_place(text.substr(0, offset), place);
  if (place.in_comment) return {{offset, offset}, {}};
  return {place.word, Completer(path, text, place, unsaved).run()};
}

}  // namespace sysid::assist

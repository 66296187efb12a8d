// By the place of the word: which block, which statement, which bracket.
#include "assist/completion.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "assist/analysis.hpp"
#include "assist/completion_place.hpp"
#include "assist/vocabulary.hpp"
#include "check/tasks.hpp"
#include "core/files.hpp"
#include "data/table.hpp"
#include "distribution/distribution.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

using grammar::Token;
using grammar::TokenKind;

constexpr std::size_t most_of_header = 1U << 16U;  // bytes of a data file that are read for the names of its columns

class Completer {
 public:
  Completer(std::string const& path, std::string const& text, CompletionPlace const& place, UnsavedText const& unsaved)
      : path_(path), place_(place), reading_(read(path, text, unsaved)) {}

  std::vector<Completion> run() {
    if (place_.in_text)
      files();
    else if (!place_.path.empty())
      members();
    else if (!place_.brackets.empty() && place_.brackets.back().symbol == '[' && unit_bracket())
      units();
    else if (place_.block == "model")
      model();
    else if (place_.block == "data")
      data();
    else if (place_.block == "candidates")
      candidates();
    else if (place_.block == "dictionary")
      dictionary();
    else
      top();
    return std::move(items_);
  }

 private:
  // --- what is offered ---

  void add(Completion item) {
    if (seen_.insert(item.label).second) items_.push_back(std::move(item));
  }
  void keywords(std::span<std::string_view const> words) {
    for (std::string_view const word : words) add({std::string(word), CompletionKind::keyword, {}, {}});
  }
  void keyword(char const* word) { add({word, CompletionKind::keyword, {}, {}}); }
  void vocabulary(std::vector<Word> const& words, CompletionKind kind) {
    for (Word const& word : words) add({word.name, kind, word.signature, word.summary});
  }
  void vocabulary(WordKind kind, CompletionKind as = CompletionKind::word) { vocabulary(words_of(kind), as); }
  void settings(std::string_view owner) { vocabulary(settings_of(owner), CompletionKind::setting); }
  bool choices(std::string_view owner, std::string_view setting) {
    std::vector<Word> const all = choices_of(owner, setting);
    vocabulary(all, CompletionKind::choice);
    return !all.empty();
  }

  template <class Wanted>
  void symbols(Wanted const& wanted) {
    if (!reading_) return;
    for (Symbol const& symbol : reading_->names.symbols) {
      if (!wanted(symbol)) continue;
      std::string detail(kind_name(symbol.kind));
      if (symbol.unit) detail += " [" + std::string(reading_->source.text(symbol.unit->span)) + "]";
      bool const function = symbol.kind == SymbolKind::function || symbol.kind == SymbolKind::process;
      add({symbol.name, function ? CompletionKind::function : CompletionKind::name, std::move(detail), {}});
    }
  }
  void of_kind(SymbolKind kind) {
    symbols([&](Symbol const& each) { return each.kind == kind; });
  }
  /// In the file itself, not in its modules.
  void own(SymbolKind kind) {
    symbols([&](Symbol const& each) {
      return each.kind == kind && each.declaration && reading_->source.place(each.declaration->begin).file == 0;
    });
  }
  static bool is_quantity(SymbolKind kind) {
    return kind == SymbolKind::model_argument || kind == SymbolKind::part || kind == SymbolKind::time ||
           kind == SymbolKind::input || kind == SymbolKind::state || kind == SymbolKind::parameter ||
           kind == SymbolKind::constant || kind == SymbolKind::local || kind == SymbolKind::derived;
  }
  static bool is_function(SymbolKind kind) { return kind == SymbolKind::function || kind == SymbolKind::process; }

  /// The symbol of the block around the place; -1: it has none.
  int block() const {
    if (!reading_ || place_.block.empty()) return -1;
    for (Block const& each : reading_->names.blocks) {
      auto const& declaration = reading_->names.symbols[static_cast<std::size_t>(each.symbol)].declaration;
      if (declaration && declaration->begin == place_.block_name.span.begin) return each.symbol;
    }
    return -1;
  }
  void quantities() {
    int const owner = block();
    symbols([&](Symbol const& each) { return each.owner == owner && owner >= 0 && is_quantity(each.kind); });
  }
  void functions() {
    int const owner = block();
    symbols([&](Symbol const& each) { return is_function(each.kind) && (each.owner == owner || each.owner == -1); });
    vocabulary(WordKind::function, CompletionKind::function);
  }
  void channels() {
    int const owner = block();
    symbols([&](Symbol const& each) { return each.kind == SymbolKind::channel && (owner < 0 || each.owner == owner); });
  }
  void expression() {
    if (!place_.brackets.empty()) {
      std::string const& callee = place_.brackets.back().callee;
      if (callee == "measured" || callee == "predicted" || callee == "residual") return channels();
    }
    if (place_.first() == "function") function_arguments();
    quantities();
    functions();
    for (char const* word : {"if", "then", "else", "and", "or", "not"}) keyword(word);
    for (char const* number : {"pi", "inf"}) add({number, CompletionKind::word, "number", {}});
  }
  /// `function f(a, b) = `: what stands in its brackets.
  void function_arguments() {
    for (std::size_t i = 2; i < place_.before.size() && !place_.before[i].is(")"); ++i)
      if (place_.before[i].kind == TokenKind::word)
        add({std::string(place_.before[i].text), CompletionKind::name, "argument of the function", {}});
  }

  // --- by place ---

  void members() {
    if (!reading_) return;
    std::vector<Symbol> const& all = reading_->names.symbols;
    if (place_.block.empty()) {  // `bench.train`
      for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].kind == SymbolKind::data && all[i].name == place_.path)
          symbols([&](Symbol const& each) { return each.kind == SymbolKind::data_part && each.owner == static_cast<int>(i); });
      if (items_.empty()) of_part(subject_model());
      return;
    }
    of_part(block());
  }
  /// Names of the part that the path leads to from a model.
  void of_part(int owner) {
    std::vector<Symbol> const& all = reading_->names.symbols;
    std::string rest = place_.path + ".";
    while (!rest.empty() && owner >= 0) {
      std::string const name = rest.substr(0, rest.find('.'));
      rest.erase(0, name.size() + 1);
      auto const part = std::find_if(all.begin(), all.end(), [&](Symbol const& each) {
        return each.kind == SymbolKind::part && each.owner == owner && each.name == name;
      });
      owner = part == all.end() ? -1 : part->refers;
    }
    if (owner >= 0) symbols([&](Symbol const& each) { return each.owner == owner && is_quantity(each.kind); });
  }

  /// A `[` behind a number, a declared name or a column; directly behind a name of an expression it opens an index.
  bool unit_bracket() const {
    auto const& tokens = place_.before;
    for (std::size_t i = tokens.size(); i-- > 0;)
      if (tokens[i].is("["))
        return i == 0 || tokens[i - 1].kind != TokenKind::word || tokens[i - 1].span.end < tokens[i].span.begin;
    return true;
  }
  void units() {
    static constexpr std::array<std::string_view, 24> common{"m",   "mm", "s",   "ms",   "kg",  "N",       "kN",  "Pa",
                                                             "Hz",  "V",  "A",   "W",    "J",   "rad",     "K",   "degC",
                                                             "mol", "l",  "min", "hour", "day", "percent", "ohm", "um"};
    for (std::string_view const unit : common) add({std::string(unit), CompletionKind::unit, {}, {}});
    int const owner = block();
    symbols([&](Symbol const& each) { return each.kind == SymbolKind::model_argument && each.owner == owner; });
  }

  /// Behind `~`, and in the brackets of what stands there.
  void distribution(bool noise) {
    if (place_.brackets.empty()) {
      for (Word const& word : words_of(WordKind::distribution))
        if (!noise || find_distribution(word.name)->noise) add({word.name, CompletionKind::word, word.signature, word.summary});
      return;
    }
    OpenBracket const& inner = place_.brackets.back();
    if (inner.begins && inner.argument.empty() && find_distribution(inner.callee) != nullptr) settings(inner.callee);
    expression();
  }
  void process() {
    if (place_.brackets.empty()) return add({"gp", CompletionKind::word, "gp(covariance)", "a Gaussian process of mean zero"});
    OpenBracket const& inner = place_.brackets.back();
    if (inner.callee == "gp") return vocabulary(WordKind::kernel);
    if (inner.begins && inner.argument.empty()) settings(inner.callee);
    function_arguments();
    quantities();
  }
  void part() {
    if (!place_.has("=")) return;
    if (place_.brackets.empty()) return of_kind(SymbolKind::model);
    OpenBracket const& inner = place_.brackets.back();
    if (place_.brackets.size() == 1 && inner.begins && inner.argument.empty()) arguments_of_model(inner.callee, true);
    expression();
  }
  void arguments_of_model(std::string const& model, bool inputs_too) {
    if (!reading_) return;
    std::vector<Symbol> const& all = reading_->names.symbols;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].kind == SymbolKind::model && all[i].name == model)
        symbols([&](Symbol const& each) {
          return each.owner == static_cast<int>(i) &&
                 (each.kind == SymbolKind::model_argument ||
                  (inputs_too && (each.kind == SymbolKind::input || each.kind == SymbolKind::parameter)));
        });
  }

  void model() {
    std::string_view const first = place_.first();
    bool const declares = place_.before.size() > 1 || place_.block.empty();
    if (place_.before.empty()) {
      keywords(words::model_statements);
      return expression();
    }
    if (!words::contains(words::model_statements, first) ||
        (declares && place_.before[1].kind == TokenKind::symbol))  // an equation about something called `input`
      return expression();
    if (first == "part") return part();
    if (place_.has("~")) {
      if (first == "function") return process();
      return distribution(first == "observe");
    }
    if (place_.has("=") || (!place_.brackets.empty() && first != "function")) return expression();
    if (first == "time" && place_.before.size() == 1) return keyword("discrete");
    if (first == "initial") {
      int const owner = block();
      return symbols([&](Symbol const& each) {
        return each.owner == owner && (each.kind == SymbolKind::state || each.kind == SymbolKind::part);
      });
    }
    if (first == "parameter" && place_.before.size() >= 2) keyword(place_.follows("per") ? "experiment" : "per");
  }

  void data() {
    std::string_view const first = place_.first();
    if (place_.before.empty()) return keywords(words::data_statements);
    if (first == "time" && place_.before.size() == 1) return columns();
    if (first == "split") return place_.follows("=") ? keyword("rows") : void();
    if (first == "constant") return place_.has("=") ? expression() : own(SymbolKind::parameter);
    if (first != "input" && first != "measure") return;
    if (place_.before.size() == 1) return of_kind(first == "input" ? SymbolKind::input : SymbolKind::channel);
    if (place_.follows("=")) return columns();
    if (place_.follows("hold")) return vocabulary(choices_of("", "hold"), CompletionKind::choice);
    if (place_.has("=") && first == "input") keyword("hold");
  }

  void candidates() {
    if (place_.before.empty()) {
      of_kind(SymbolKind::model);
      return keyword("shared");
    }
    if (place_.first() == "shared") return of_kind(SymbolKind::parameter);
    if (!place_.brackets.empty()) return arguments_of_model(place_.brackets.back().callee, false);
    if (!place_.has("probability")) keyword("probability");
  }

  void dictionary() {
    std::string_view const first = place_.first();
    if (place_.before.empty()) return keywords(words::dictionary_statements);
    if (!place_.has("=")) return;
    if (first == "state") return of_kind(SymbolKind::channel);
    if (first == "coefficients") return;
    if (first == "terms" || first == "exclude") vocabulary(WordKind::family, CompletionKind::function);
    if (!place_.brackets.empty() && place_.brackets.back().argument.empty()) settings(place_.brackets.back().callee);
    expression();
  }

  void top() {
    auto const& tokens = place_.before;
    if (tokens.empty()) {
      keywords(words::items);
      return keywords(words::verbs);
    }
    if (tokens.front().is("use")) return modules();
    if (tokens.front().is("function")) return place_.has("=") ? expression() : void();
    if (tokens.size() == 2 && tokens[1].is("=")) return keywords(words::verbs);
    std::size_t const verb = tokens.size() > 2 && tokens[1].is("=") ? 2 : 0;
    if (words::contains(words::verbs, tokens[verb].text)) task(tokens[verb].text, verb);
  }

  void task(std::string_view verb, std::size_t at) {
    auto const& tokens = place_.before;
    if (tokens.size() == at + 1) return subjects(verb);
    if (place_.has("with")) return option(verb);
    bool const has_preposition = std::any_of(tokens.begin(), tokens.end(),
                                             [](Token const& token) { return words::contains(words::prepositions, token.text); });
    if (words::contains(words::prepositions, tokens.back().text) || (has_preposition && place_.follows(",")))
      return own(SymbolKind::data);
    if (!place_.brackets.empty()) return arguments_of_model(place_.brackets.back().callee, false);
    if (!has_preposition && verb != "simulate") keyword(verb == "predict" ? "on" : verb == "discover" ? "from" : "to");
    keyword("with");
  }
  void subjects(std::string_view verb) {
    if (verb == "predict") return own(SymbolKind::task);
    if (verb == "discover") return own(SymbolKind::dictionary);
    if (verb == "select") own(SymbolKind::candidates);
    of_kind(SymbolKind::model);
  }

  void option(std::string_view verb) {
    if (!place_.brackets.empty()) return setting(verb);
    auto const& tokens = place_.before;
    if (place_.follows("with") || place_.follows(",")) {
      vocabulary(options_of(verb), CompletionKind::setting);
      return vocabulary(verb == "select"     ? WordKind::selecting
                        : verb == "discover" ? WordKind::discovering
                                             : WordKind::fitting,
                        CompletionKind::function);
    }
    if (place_.follows("input")) return of_subject(SymbolKind::input);
    if (!place_.follows("=")) return;
    bool const signal = tokens.size() > 2 && tokens[tokens.size() - 3].is("input");
    if (signal) return vocabulary(WordKind::signal, CompletionKind::function);
    std::string_view const key = tokens[tokens.size() - 2].text;
    choices(verb, key);
    if (key == "distance") functions();
  }
  void setting(std::string_view verb) {
    OpenBracket const& inner = place_.brackets.back();
    if (inner.callee == "values") return of_subject(SymbolKind::parameter, SymbolKind::part);
    if (inner.callee == "near") return own(SymbolKind::task);
    if (inner.callee == "weights" || inner.callee == "noise") return of_subject(SymbolKind::channel);
    if (inner.callee == "measured" || inner.callee == "predicted" || inner.callee == "residual") return channels();
    if (!inner.argument.empty()) {
      choices(inner.callee, inner.argument);
      return;
    }
    settings(inner.callee);
    if (items_.empty() && verb == "select") functions();
  }
  int subject_model() const {
    auto const& tokens = place_.before;
    std::vector<Symbol> const& all = reading_->names.symbols;
    for (std::size_t i = 0; i + 1 < tokens.size(); ++i)
      if (words::contains(words::verbs, tokens[i].text))
        for (std::size_t k = 0; k < all.size(); ++k)
          if ((all[k].kind == SymbolKind::model || all[k].kind == SymbolKind::dictionary) && all[k].name == tokens[i + 1].text)
            return static_cast<int>(k);
    return -1;
  }
  /// Of the model or dictionary that the task is about; where it is not known, of all.
  void of_subject(SymbolKind kind, SymbolKind other = SymbolKind::word) {
    if (!reading_) return;
    int const owner = subject_model();
    symbols([&](Symbol const& each) {
      return (each.kind == kind || (each.kind == other && other != SymbolKind::word)) && (owner < 0 || each.owner == owner);
    });
  }

  // --- files ---

  std::filesystem::path folder() const {
    std::filesystem::path const parent = std::filesystem::path(path_).parent_path();
    return parent.empty() ? "." : parent;
  }
  void modules() {
    for (LibraryModule const& module : library_modules())
      add({std::string(module.name), CompletionKind::module, "standard library", {}});
    std::error_code nothing_there;
    for (auto const& entry : std::filesystem::directory_iterator(folder(), nothing_there))
      if (entry.path().extension() == ".sysid" && entry.path().stem() != std::filesystem::path(path_).stem())
        add({entry.path().stem().string(), CompletionKind::module, "beside this file", {}});
  }
  void files() {
    if (place_.first() != "file" && !place_.has("file")) return;
    std::error_code nothing_there;
    std::set<std::string> names;
    for (auto const& entry : std::filesystem::directory_iterator(folder() / place_.folder, nothing_there)) {
      std::string const extension = entry.path().extension().string();
      std::string const name = entry.path().filename().string();
      if (entry.is_directory(nothing_there) && !name.starts_with('.')) names.insert(name + "/");
      if (extension == ".csv" || extension == ".tsv" || extension == ".txt" || extension == ".dat") names.insert(name);
    }
    for (std::string const& name : names) add({name, CompletionKind::file, {}, {}});
  }
  static bool is_name(std::string const& text) {
    return !text.empty() && words::begins_name(text.front()) && std::all_of(text.begin(), text.end(), words::continues_name) &&
           !words::contains(words::reserved, text);
  }
  void columns() {
    if (!reading_) return;
    for (ast::Item const& item : reading_->tree.items) {
      auto const* data = std::get_if<ast::Data>(&item);
      if (data == nullptr || data->name.span.begin != place_.block_name.span.begin) continue;
      for (ast::DataStatement const& statement : data->statements)
        if (auto const* file = std::get_if<ast::DataFile>(&statement)) columns_of(file->path.value);
    }
  }
  void columns_of(std::string const& file) {
    try {
      std::string bytes = read_file(folder() / file, most_of_header);
      bytes.resize(std::min(bytes.size(), most_of_header));
      if (bytes.size() == most_of_header) bytes.resize(bytes.rfind('\n') == std::string::npos ? 0 : bytes.rfind('\n') + 1);
      Table const table = Table::parse(file, std::move(bytes));
      for (std::string const& column : table.columns())
        add({is_name(column) ? column : "\"" + column + "\"", CompletionKind::column, "column of " + file, {}});
    } catch (std::exception const&) {  // no such file, or no table: said by the check
    }
  }

  std::string const& path_;
  CompletionPlace const& place_;
  std::shared_ptr<Reading const> reading_;
  std::set<std::string> seen_;
  std::vector<Completion> items_;
};

}  // namespace

Completions complete(std::string const& path, std::string const& text, std::uint32_t offset, UnsavedText const& unsaved) {
  CompletionPlace place;
  find_place(text.substr(0, offset), place);
  if (place.in_comment) return {{offset, offset}, {}};
  return {place.word, Completer(path, text, place, unsaved).run()};
}

}  // namespace sysid::assist

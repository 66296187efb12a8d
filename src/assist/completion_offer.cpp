// Names by the block that owns them; files by what is in the folder of the text.
#include "assist/completion_offer.hpp"

#include <algorithm>
#include <array>

#include "core/system/files.hpp"
#include "data/table/table.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

using grammar::TokenKind;

constexpr std::size_t most_of_header = 1U << 16U;  // bytes of a data file that are read for the names of its columns

bool is_quantity(SymbolKind kind) {
  return kind == SymbolKind::model_argument || kind == SymbolKind::part || kind == SymbolKind::time || kind == SymbolKind::input ||
         kind == SymbolKind::state || kind == SymbolKind::disturbance || kind == SymbolKind::parameter ||
         kind == SymbolKind::constant || kind == SymbolKind::local || kind == SymbolKind::derived;
}

bool is_function(SymbolKind kind) { return kind == SymbolKind::function || kind == SymbolKind::process; }

bool is_name(std::string const& text) {
  return !text.empty() && words::begins_name(text.front()) && std::all_of(text.begin(), text.end(), words::continues_name) &&
         !words::contains(words::reserved, text);
}

}  // namespace

// --- words of the language ---

void Offer::add(Completion item) {
  if (seen_.insert(item.label).second) items_.push_back(std::move(item));
}

void Offer::keywords(std::span<std::string_view const> words) {
  for (std::string_view const word : words) add({std::string(word), CompletionKind::keyword, {}, {}});
}

void Offer::vocabulary(std::vector<Word> const& words, CompletionKind kind) {
  for (Word const& word : words) add({word.name, kind, word.signature, word.summary});
}

bool Offer::choices(std::string_view owner, std::string_view setting) {
  std::vector<Word> const all = choices_of(owner, setting);
  vocabulary(all, CompletionKind::choice);
  return !all.empty();
}

void Offer::units() {
  static constexpr std::array<std::string_view, 24> common{"m",   "mm", "s",   "ms",   "kg",  "N",       "kN",  "Pa",
                                                           "Hz",  "V",  "A",   "W",    "J",   "rad",     "K",   "degC",
                                                           "mol", "l",  "min", "hour", "day", "percent", "ohm", "um"};
  for (std::string_view const unit : common) add({std::string(unit), CompletionKind::unit, {}, {}});
  int const owner = block();
  symbols([&](Symbol const& each) { return each.kind == SymbolKind::model_argument && each.owner == owner; });
}

// --- names of the file ---

template <class Wanted>
void Offer::symbols(Wanted const& wanted) {
  if (!reading_) return;
  for (Symbol const& symbol : all()) {
    if (!wanted(symbol)) continue;
    std::string detail(kind_name(symbol.kind));
    if (symbol.unit) detail += " [" + std::string(reading_->source.text(symbol.unit->span)) + "]";
    add({symbol.name, is_function(symbol.kind) ? CompletionKind::function : CompletionKind::name, std::move(detail), {}});
  }
}

void Offer::of_kind(SymbolKind kind) {
  symbols([&](Symbol const& each) { return each.kind == kind; });
}

void Offer::own(SymbolKind kind) {
  symbols([&](Symbol const& each) {
    return each.kind == kind && each.declaration && reading_->source.place(each.declaration->begin).file == 0;
  });
}

int Offer::block() const {
  if (!reading_ || place_.block.empty()) return -1;
  for (Block const& each : reading_->names.blocks) {
    auto const& declaration = all()[static_cast<std::size_t>(each.symbol)].declaration;
    if (declaration && declaration->begin == place_.block_name.span.begin) return each.symbol;
  }
  return -1;
}

int Offer::subject() const {
  auto const& tokens = place_.before;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i)
    if (words::contains(words::verbs, tokens[i].text))
      for (std::size_t k = 0; k < all().size(); ++k)
        if ((all()[k].kind == SymbolKind::model || all()[k].kind == SymbolKind::dictionary) && all()[k].name == tokens[i + 1].text)
          return static_cast<int>(k);
  return -1;
}

void Offer::of_subject(SymbolKind kind, std::optional<SymbolKind> or_kind) {
  if (!reading_) return;
  int const owner = subject();
  symbols([&](Symbol const& each) { return (each.kind == kind || each.kind == or_kind) && (owner < 0 || each.owner == owner); });
}

void Offer::members() {
  if (!reading_) return;
  if (!place_.block.empty()) return of_part(block());
  for (std::size_t i = 0; i < all().size(); ++i)  // `bench.train`
    if (all()[i].kind == SymbolKind::data && all()[i].name == place_.path)
      symbols([&](Symbol const& each) { return each.kind == SymbolKind::data_part && each.owner == static_cast<int>(i); });
  if (items_.empty()) of_part(subject());
}

// Names of the part that the path leads to from a model.
void Offer::of_part(int owner) {
  std::string rest = place_.path + ".";
  while (!rest.empty() && owner >= 0) {
    std::string const name = rest.substr(0, rest.find('.'));
    rest.erase(0, name.size() + 1);
    auto const part = std::find_if(all().begin(), all().end(), [&](Symbol const& each) {
      return each.kind == SymbolKind::part && each.owner == owner && each.name == name;
    });
    owner = part == all().end() ? -1 : part->refers;
  }
  if (owner >= 0) symbols([&](Symbol const& each) { return each.owner == owner && is_quantity(each.kind); });
}

void Offer::states_and_parts() {
  int const owner = block();
  symbols(
      [&](Symbol const& each) { return each.owner == owner && (each.kind == SymbolKind::state || each.kind == SymbolKind::part); });
}

void Offer::quantities() {
  int const owner = block();
  symbols([&](Symbol const& each) { return each.owner == owner && owner >= 0 && is_quantity(each.kind); });
}

void Offer::functions() {
  int const owner = block();
  symbols([&](Symbol const& each) { return is_function(each.kind) && (each.owner == owner || each.owner == -1); });
  vocabulary(WordKind::function, CompletionKind::function);
}

void Offer::channels() {
  int const owner = block();
  symbols([&](Symbol const& each) { return each.kind == SymbolKind::channel && (owner < 0 || each.owner == owner); });
}

void Offer::arguments_of_model(std::string const& model, bool inputs_too) {
  if (!reading_) return;
  for (std::size_t i = 0; i < all().size(); ++i)
    if (all()[i].kind == SymbolKind::model && all()[i].name == model)
      symbols([&](Symbol const& each) {
        return each.owner == static_cast<int>(i) &&
               (each.kind == SymbolKind::model_argument ||
                (inputs_too && (each.kind == SymbolKind::input || each.kind == SymbolKind::parameter)));
      });
}

void Offer::function_arguments() {
  for (std::size_t i = 2; i < place_.before.size() && !place_.before[i].is(")"); ++i)
    if (place_.before[i].kind == TokenKind::word)
      add({std::string(place_.before[i].text), CompletionKind::name, "argument of the function", {}});
}

void Offer::expression() {
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

// --- files ---

std::filesystem::path Offer::folder() const {
  std::filesystem::path const parent = std::filesystem::path(path_).parent_path();
  return parent.empty() ? "." : parent;
}

void Offer::modules() {
  for (LibraryModule const& module : library_modules())
    add({std::string(module.name), CompletionKind::module, "standard library", {}});
  std::error_code nothing_there;
  for (auto const& entry : std::filesystem::directory_iterator(folder(), nothing_there))
    if (entry.path().extension() == ".sysid" && entry.path().stem() != std::filesystem::path(path_).stem())
      add({entry.path().stem().string(), CompletionKind::module, "beside this file", {}});
}

void Offer::files() {
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

void Offer::columns() {
  if (!reading_) return;
  for (ast::Item const& item : reading_->tree.items) {
    auto const* data = std::get_if<ast::Data>(&item);
    if (data == nullptr || data->name.span.begin != place_.block_name.span.begin) continue;
    for (ast::DataStatement const& statement : data->statements)
      if (auto const* file = std::get_if<ast::DataFile>(&statement)) columns_of(file->path.value);
  }
}

void Offer::columns_of(std::string const& file) {
  try {
    std::string bytes = read_regular_file(folder() / file, most_of_header);
    bytes.resize(std::min(bytes.size(), most_of_header));
    if (bytes.size() == most_of_header) bytes.resize(bytes.rfind('\n') == std::string::npos ? 0 : bytes.rfind('\n') + 1);
    Table const table = Table::parse(file, std::move(bytes));
    for (std::string const& column : table.columns())
      add({is_name(column) ? column : "\"" + column + "\"", CompletionKind::column, "column of " + file, {}});
  } catch (std::exception const&) {  // no such file, or no table: said by the check
  }
}

}  // namespace sysid::assist

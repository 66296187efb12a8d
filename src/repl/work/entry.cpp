// A statement is tried as what may stand in a file, in a model, in a data block, and as an expression.
#include "repl/work/entry.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "syntax/entry.hpp"
#include "syntax/parse.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

using Kind = EntryPart::Kind;

/// What stands around a statement of each kind for the parser to know it.
struct Frame {
  Kind kind;
  std::string_view before, after;
};
constexpr std::array<Frame, 4> frames{{{Kind::items, "", ""},
                                       {Kind::model_statement, "model m {\n", "\n}"},
                                       {Kind::data_statement, "data d {\n", "\n}"},
                                       {Kind::expression, "", ""}}};
static_assert(frames[1].before.size() == model_frame && frames[2].before.size() == data_frame);
Frame const& frame_of(Kind kind) { return frames[static_cast<std::size_t>(kind)]; }

std::string framed(std::string const& text, Kind kind) {
  return std::string(frame_of(kind).before) + text + std::string(frame_of(kind).after);
}

Diagnostics mistakes_as(std::string const& text, Kind kind) {
  Diagnostics found;
  Source const source("", framed(text, kind));
  if (kind == Kind::expression) {
    parse_expression(source, found);
    return found;
  }
  auto const tree = parse(source, found);
  // `}` in the text must not end the frame.
  if (tree && kind != Kind::items && tree->items.size() != 1)
    found.add({Severity::error, "E1101", "expected the end of the statement", Label{{0, 1}, {}}, {}, ""});
  return found;
}

std::vector<std::string> first_words(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size() && words.size() < 3;) {
    if (text[at] == ' ' || text[at] == '\t' || text[at] == '\n') {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && words::continues_name(text[end])) ++end;
    if (end == at) ++end;
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

/// `step(0)` is a value of the function, though a data block could have `step` with a number in parentheses.
bool is_call(std::string const& text) {
  auto const begin = std::find_if(text.begin(), text.end(), words::begins_name);
  auto const end = std::find_if_not(begin, text.end(), words::continues_name);
  return end != text.end() && *end == '(' && mistakes_as(text, Kind::expression).all().empty();
}

/// What a statement that parses as nothing was meant to be.
Kind meant(std::string_view text) {
  auto const words = first_words(text);
  auto const at = [&](std::size_t i) { return i < words.size() ? std::string_view(words[i]) : std::string_view(); };
  bool const word_follows = !at(1).empty() && (words::begins_name(at(1)[0]) || at(1)[0] == '"');
  bool const named_task =
      at(1) == "=" && !at(2).empty() && words::begins_name(at(2)[0]) && !words::contains(words::reserved, at(2));
  if ((words::contains(words::items, at(0)) || words::contains(words::verbs, at(0))) && word_follows) return Kind::items;
  if (named_task && words::contains(words::verbs, at(2))) return Kind::items;
  if (words::contains(words::model_statements, at(0)) && word_follows)
    return words::contains(words::data_statements, at(0)) && text.find(" hold ") != std::string_view::npos ? Kind::data_statement
                                                                                                           : Kind::model_statement;
  if (words::contains(words::data_statements, at(0)) && (word_follows || (!at(1).empty() && words::is_digit(at(1)[0]))))
    return Kind::data_statement;
  if (named_task) {
    // `posterior = fitt duffing to ...`: two words side by side are no equation.
    std::size_t const verb = text.find(at(2), text.find('=') + 1);
    std::size_t const next = text.find_first_not_of(" \t", verb + at(2).size());
    if (next != std::string_view::npos && next > verb + at(2).size() && words::begins_name(text[next])) return Kind::items;
  }
  if (text.find('=') != std::string_view::npos || text.find('~') != std::string_view::npos) {
    // `=` in the arguments of a call makes no equation.
    int depth = 0;
    for (char const c : text) {
      depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
      if (depth == 0 && (c == '=' || c == '~')) return Kind::model_statement;
    }
  }
  // `paramter k [N/m]`: a word misspelt stands before another.
  if (word_follows && words::begins_name(at(0).empty() ? ' ' : at(0)[0])) {
    for (auto const& [kind, table] :
         {std::pair(Kind::items, words::list(words::items)), std::pair(Kind::items, words::list(words::verbs)),
          std::pair(Kind::model_statement, words::list(words::model_statements)),
          std::pair(Kind::data_statement, words::list(words::data_statements))})
      if (!nearest(at(0), table).empty()) return kind;
  }
  return Kind::expression;
}

Span moved(Span span, std::int64_t by, std::uint32_t end) {
  auto const move = [&](std::uint32_t at) {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(at) + by, 0, end));
  };
  return {move(span.begin), move(span.end)};
}

}  // namespace

Diagnostic moved(Diagnostic diagnostic, std::int64_t by, std::uint32_t end) {
  if (diagnostic.primary) diagnostic.primary->span = moved(diagnostic.primary->span, by, end);
  for (Label& label : diagnostic.secondary) label.span = moved(label.span, by, end);
  return diagnostic;
}

std::vector<EntryPart> parts_of(std::string const& entry, Diagnostics& diagnostics) {
  std::vector<EntryPart> parts;
  bool sound = true;
  for (Span const span : top_level_statements(entry)) {
    std::string const text = entry.substr(span.begin, span.end - span.begin);
    std::optional<Kind> kind;
    for (Frame const& frame : frames)
      if (!kind && mistakes_as(text, frame.kind).all().empty()) kind = frame.kind;
    if (kind == Kind::data_statement && is_call(text)) kind = Kind::expression;
    if (kind) {
      parts.push_back({*kind, span});
      continue;
    }
    Kind const wanted = meant(text);
    auto const by = static_cast<std::int64_t>(span.begin) - static_cast<std::int64_t>(frame_of(wanted).before.size());
    Diagnostics const found = mistakes_as(text, wanted);
    for (Diagnostic const& each : found.all()) diagnostics.add(moved(each, by, static_cast<std::uint32_t>(entry.size())));
    sound = false;
  }
  if (!sound) parts.clear();
  return parts;
}

namespace {

template <class Block>
Block block_around(std::string const& text, Kind kind) {
  Diagnostics diagnostics;
  auto tree = parse(Source("", framed(text, kind)), diagnostics);
  if (!tree || tree->items.size() != 1) throw InternalError("a statement that was parsed does not parse again");
  return std::get<Block>(std::move(tree->items.front()));
}

}  // namespace

ast::ModelStatement model_statement_of(std::string const& text) {
  return block_around<ast::Model>(text, Kind::model_statement).statements.at(0);
}

ast::DataStatement data_statement_of(std::string const& text) {
  return block_around<ast::Data>(text, Kind::data_statement).statements.at(0);
}

}  // namespace sysid::repl

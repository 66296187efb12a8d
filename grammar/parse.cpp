// The file rule, and the entry points of syntax/parse.hpp.
#include "syntax/parse.hpp"

#include <algorithm>
#include <variant>

#include "grammar/actions.hpp"
#include "grammar/candidates.hpp"
#include "grammar/data.hpp"
#include "grammar/dictionary.hpp"
#include "grammar/message/errors.hpp"
#include "grammar/model.hpp"
#include "grammar/task.hpp"
#include "syntax/other_file.hpp"

namespace sysid {

namespace grammar {

namespace {

constexpr std::size_t most_errors = 20;

}  // namespace

struct file_line_tag : resumes_behind_item {};
struct lone_expression_tag : resumes_behind_item {};

constexpr x3::rule<struct file_tag, ast::File> file = "a file";
constexpr x3::rule<file_line_tag, ast::Item> file_line = wanted::item;
constexpr x3::rule<struct use_tag, ast::Use> use = "a module";
constexpr x3::rule<struct item_tag, ast::Item> item = wanted::item;
constexpr x3::rule<lone_expression_tag, ast::Expression> lone_expression = wanted::value;

auto const file_def = *(file_line[append(&ast::File::items)] | '\n' | ';');
auto const file_line_def = (!(x3::lit('\n') | ';' | x3::eoi)) > item[take] > end_of_statement;
auto const use_def = located[keyword("use") > name[to(&ast::Use::module)]];
auto const item_def =
    use[take] | model[take] | data[take] | candidates[take] | dictionary[take] | function_definition[take] | task[take];
auto const lone_expression_def = x3::eps > *x3::lit('\n') > expression[take] > end_of_statement > *x3::lit('\n') > x3::eoi;

BOOST_SPIRIT_DEFINE(file, file_line, use, item, lone_expression)

namespace {

template <class Tree>
struct Reading {
  Tree tree;
  bool complete = false;     // nothing was reported
  std::vector<Span> unread;  // what holds a mistake; its nodes are in the tree, half filled
  bool open_end = false;     // a block or a text does not end
};

/// The whole source by `rule`.
template <class Rule>
Reading<typename Rule::attribute_type> read_all(Rule const& rule, Source const& source, Diagnostics& diagnostics) {
  std::size_t const before = diagnostics.all().size();
  if (source.text().size() > most_text_bytes) {
    diagnostics.add(errors::text_too_large({most_text_bytes, most_text_bytes + 1}, most_text_bytes));
    Reading<typename Rule::attribute_type> nothing;
    nothing.open_end = true;
    return nothing;
  }
  Layout const layout = lay_out(source, diagnostics, before + most_errors);
  State state(layout, diagnostics, before + most_errors);
  Reading<typename Rule::attribute_type> reading;
  Iterator first = state.begin();
  bool const parsed = x3::phrase_parse(first, state.end(), x3::with<state_tag>(state)[rule], x3::ascii::blank, reading.tree);
  reading.complete = diagnostics.all().size() == before;
  if (reading.complete && (!parsed || first != state.end()))
    throw InternalError("the parser stopped inside a text without a message");
  reading.unread = state.take_unread();
  for (Token const& token : layout.tokens)
    if (layout.reported.contains(token.statement)) reading.unread.push_back(token.span);
  reading.open_end = layout.reported_at_end;
  return reading;
}

/// A rule behind whose failure the parse went on leaves a node without a place, or one that begins in what was left out.
template <class Node>
void erase_unread(std::vector<Node>& nodes, std::vector<Span> const& unread) {
  std::erase_if(nodes, [&](Node const& node) {
    Span const span = std::visit([](auto const& each) { return each.span; }, node);
    return span.begin == span.end ||
           std::any_of(unread.begin(), unread.end(), [&](Span each) { return each.begin <= span.begin && span.begin < each.end; });
  });
}

}  // namespace

}  // namespace grammar

namespace {

constexpr std::size_t most_marked = 60;

/// Of a file of another kind one message, in place of one for each line.
bool is_other_file(Source const& source, Diagnostics& diagnostics) {
  std::string_view const kind = other_kind(source.text());
  if (kind.empty()) return false;
  std::string_view const line = source.text().substr(0, source.text().find_first_of("\r\n"));
  bool const text = std::all_of(line.begin(), line.end(), [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); });
  Span const mark{0, static_cast<std::uint32_t>(std::min<std::size_t>(line.size(), text ? most_marked : 1))};
  diagnostics.add(grammar::errors::other_file(mark, source.name(), kind));
  return true;
}

void add_all(Diagnostics const& found, Diagnostics& diagnostics) {
  for (Diagnostic const& each : found.all()) diagnostics.add(each);
}

}  // namespace

std::optional<ast::File> parse(Source const& source, Diagnostics& diagnostics) {
  Diagnostics found;
  auto reading = grammar::read_all(grammar::file, source, found);
  bool const doubtful = !reading.complete || ends_lines_by_return(source.text());
  if (doubtful && is_other_file(source, diagnostics)) return std::nullopt;
  add_all(found, diagnostics);
  return reading.complete ? std::optional(std::move(reading.tree)) : std::nullopt;
}

ReadableFile parse_readable(Source const& source, Diagnostics& diagnostics) {
  Diagnostics found;
  auto reading = grammar::read_all(grammar::file, source, found);
  if (!reading.complete && is_other_file(source, diagnostics)) return {};
  add_all(found, diagnostics);
  if (reading.complete) return {std::move(reading.tree), {}};
  if (reading.open_end) return {std::nullopt, std::move(reading.unread)};
  grammar::erase_unread(reading.tree.items, reading.unread);
  for (ast::Item& item : reading.tree.items) {
    if (auto* model = std::get_if<ast::Model>(&item)) grammar::erase_unread(model->statements, reading.unread);
    if (auto* set = std::get_if<ast::Candidates>(&item)) grammar::erase_unread(set->statements, reading.unread);
    if (auto* dictionary = std::get_if<ast::Dictionary>(&item)) grammar::erase_unread(dictionary->statements, reading.unread);
    if (auto* data = std::get_if<ast::Data>(&item)) grammar::erase_unread(data->statements, reading.unread);
  }
  return {std::move(reading.tree), std::move(reading.unread)};
}

std::optional<ast::Expression> parse_expression(Source const& source, Diagnostics& diagnostics) {
  auto reading = grammar::read_all(grammar::lone_expression, source, diagnostics);
  return reading.complete ? std::optional(std::move(reading.tree)) : std::nullopt;
}

}  // namespace sysid

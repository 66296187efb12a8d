// The file rule, and the entry points of syntax/parse.hpp.
#include "syntax/parse.hpp"

#include "grammar/actions.hpp"
#include "grammar/candidates.hpp"
#include "grammar/data.hpp"
#include "grammar/errors.hpp"
#include "grammar/model.hpp"
#include "grammar/task.hpp"

namespace sysid {

namespace grammar {

namespace {

constexpr std::size_t most_errors = 20;

}  // namespace

struct file_tag {};
struct file_line_tag : resumes_behind_item {};
struct use_tag {};
struct item_tag {};
struct lone_expression_tag : resumes_behind_item {};

constexpr x3::rule<file_tag, ast::File> file = "a file";
constexpr x3::rule<file_line_tag, ast::Item> file_line = wanted::item;
constexpr x3::rule<use_tag, ast::Use> use = "a module";
constexpr x3::rule<item_tag, ast::Item> item = wanted::item;
constexpr x3::rule<lone_expression_tag, ast::Expression> lone_expression = wanted::value;

auto const file_def = *(file_line[append(&ast::File::items)] | '\n' | ';');
auto const file_line_def = (!(x3::lit('\n') | ';' | x3::eoi)) > item[take] > end_of_statement;
auto const use_def = located[keyword("use") > name[to(&ast::Use::module)]];
auto const item_def = use[take] | model[take] | data[take] | candidates[take] | function_definition[take] | task[take];
auto const lone_expression_def = x3::eps > *x3::lit('\n') > expression[take] > end_of_statement > *x3::lit('\n') > x3::eoi;

BOOST_SPIRIT_DEFINE(file, file_line, use, item, lone_expression)

namespace {

/// The tree of the whole source by `rule`, or nothing when anything was reported.
template <class Rule>
std::optional<typename Rule::attribute_type> parse_all(Rule const& rule, Source const& source, Diagnostics& diagnostics) {
  std::size_t const before = diagnostics.all().size();
  if (source.text().size() > most_text_bytes) {
    diagnostics.add(errors::text_too_large({most_text_bytes, most_text_bytes + 1}, most_text_bytes));
    return std::nullopt;
  }
  Layout const layout = lay_out(source, diagnostics, before + most_errors);
  State state(layout, diagnostics, before + most_errors);
  typename Rule::attribute_type tree;
  Iterator first = state.begin();
  bool const parsed = x3::phrase_parse(first, state.end(), x3::with<state_tag>(state)[rule], x3::ascii::blank, tree);
  if (diagnostics.all().size() > before) return std::nullopt;
  if (!parsed || first != state.end()) throw InternalError("the parser stopped inside a text without a message");
  return tree;
}

}  // namespace

}  // namespace grammar

std::optional<ast::File> parse(Source const& source, Diagnostics& diagnostics) {
  return grammar::parse_all(grammar::file, source, diagnostics);
}

std::optional<ast::Expression> parse_expression(Source const& source, Diagnostics& diagnostics) {
  return grammar::parse_all(grammar::lone_expression, source, diagnostics);
}

}  // namespace sysid

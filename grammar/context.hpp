// What every rule shares: the one iterator and context type (another would instantiate every rule again), the state that travels
// through the parse, and the bases of rule tags that set spans, report failures and resume behind them.
#pragma once
#include <boost/spirit/home/x3.hpp>
#include <string>

#include "grammar/message/explain.hpp"
#include "grammar/message/layout.hpp"

namespace sysid::grammar {

namespace x3 = boost::spirit::x3;

using Iterator = char const*;
using Skipper = x3::ascii::blank_type;

class State {
 public:
  State(Layout const& layout, Diagnostics& diagnostics, std::size_t limit)
      : layout_(layout), diagnostics_(diagnostics), limit_(limit) {}

  Iterator begin() const { return layout_.text.data(); }
  Iterator end() const { return begin() + layout_.text.size(); }
  Span span(Iterator first, Iterator last) const {
    while (last > first && last[-1] == ' ') --last;  // an optional part that is absent leaves the blanks before it behind
    return {offset(first), offset(last)};
  }

  void report(Iterator where, std::string const& wanted) {
    if (is_full()) return;
    if (auto diagnostic = explain(layout_, offset(where), wanted)) diagnostics_.add(std::move(*diagnostic));
  }
  /// Where parsing goes on behind a failure: nowhere once nothing more would be reported.
  Iterator behind_statement(Iterator where) const {
    return is_full() ? end() : begin() + grammar::behind_statement(layout_, offset(where));
  }
  Iterator behind_item(Iterator where, std::string const& wanted) const {
    return is_full() ? end() : begin() + grammar::behind_item(layout_, offset(where), wanted);
  }

  /// What the rules pass over behind a failure.
  void mark_unread(Iterator first, Iterator behind) { unread_.push_back({offset(first), offset(behind)}); }
  std::vector<Span> take_unread() { return std::move(unread_); }

  int depth = 0;

 private:
  bool is_full() const { return diagnostics_.all().size() >= limit_; }
  std::uint32_t offset(Iterator at) const { return static_cast<std::uint32_t>(at - begin()); }

  Layout const& layout_;
  Diagnostics& diagnostics_;
  std::size_t limit_;
  std::vector<Span> unread_;
};

struct state_tag {};
using Context = x3::context<state_tag, State, x3::phrase_parse_context<Skipper>::type>;

/// Base of the tags of rules behind whose failures the parse goes on: at the next statement of a block.
struct resumes_behind_statement {
  template <class AnyContext>
  x3::error_handler_result on_error(Iterator& first, Iterator const&, x3::expectation_failure<Iterator> const& failure,
                                    AnyContext const& context) {
    State& state = x3::get<state_tag>(context);
    state.report(failure.where(), failure.which());
    Iterator const behind = state.behind_statement(failure.where());
    state.mark_unread(first, behind);
    first = behind;
    return x3::error_handler_result::accept;
  }
};
/// The same for whatever stands directly in a file.
struct resumes_behind_item {
  template <class AnyContext>
  x3::error_handler_result on_error(Iterator& first, Iterator const&, x3::expectation_failure<Iterator> const& failure,
                                    AnyContext const& context) {
    State& state = x3::get<state_tag>(context);
    state.report(failure.where(), failure.which());
    Iterator const behind = state.behind_item(failure.where(), failure.which());
    state.mark_unread(first, behind);
    first = behind;
    return x3::error_handler_result::accept;
  }
};

/// nested[p] is p one level deeper, refused beyond the deepest level.
template <class Subject>
struct nested_directive : x3::unary_parser<Subject, nested_directive<Subject>> {
  using x3::unary_parser<Subject, nested_directive<Subject>>::unary_parser;
  static bool const is_pass_through_unary = true;
  static bool const handles_container = Subject::handles_container;

  template <class AnyContext, class RuleContext, class Attribute>
  bool parse(Iterator& first, Iterator const& last, AnyContext const& context, RuleContext& rule_context,
             Attribute& attribute) const {
    State& state = x3::get<state_tag>(context);
    struct Level {
      int& depth;
      explicit Level(int& depth) : depth(depth) { ++depth; }
      Level(Level const&) = delete;
      Level& operator=(Level const&) = delete;
      ~Level() { --depth; }
    } const level(state.depth);
    if (level.depth > deepest_nesting) boost::throw_exception(x3::expectation_failure<Iterator>(first, wanted::shallower_nesting));
    return this->subject.parse(first, last, context, rule_context, attribute);
  }
};

/// located[p] is p, and sets the span of the rule's node to what p consumed. (The usual place, on_success, gets no node in X3 when
/// the rule has semantic actions.)
template <class Subject>
struct located_directive : x3::unary_parser<Subject, located_directive<Subject>> {
  using x3::unary_parser<Subject, located_directive<Subject>>::unary_parser;
  static bool const is_pass_through_unary = true;
  static bool const handles_container = Subject::handles_container;

  template <class AnyContext, class Node, class Attribute>
  bool parse(Iterator& first, Iterator const& last, AnyContext const& context, Node& node, Attribute& attribute) const {
    x3::skip_over(first, last, context);
    Iterator const begin = first;
    if (!this->subject.parse(first, last, context, node, attribute)) return false;
    node.span = x3::get<state_tag>(context).span(begin, first);
    return true;
  }
};

template <template <class> class Directive>
struct directive_generator {
  template <class Subject>
  constexpr auto operator[](Subject const& subject) const {
    return Directive<typename x3::extension::as_parser<Subject>::value_type>(x3::as_parser(subject));
  }
};
inline constexpr directive_generator<nested_directive> nested{};
inline constexpr directive_generator<located_directive> located{};

}  // namespace sysid::grammar

/// A failed expectation names what stood behind `>`: through an action or a directive, the rule inside.
namespace boost::spirit::x3 {
template <class Subject, class Action>
struct get_info<action<Subject, Action>> {
  using result_type = std::string;
  std::string operator()(action<Subject, Action> const& parser) const { return what(parser.subject); }
};
template <class Subject>
struct get_info<sysid::grammar::nested_directive<Subject>> {
  using result_type = std::string;
  std::string operator()(sysid::grammar::nested_directive<Subject> const& parser) const { return what(parser.subject); }
};
}  // namespace boost::spirit::x3

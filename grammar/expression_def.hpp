// Definitions of expression.hpp but for units: one rule per level of precedence, from `or` (loosest) to `^`.
#pragma once
#include <string>

#include "grammar/actions.hpp"
#include "grammar/expression.hpp"

namespace sysid::grammar {

constexpr x3::rule<struct conditional_tag, ast::Conditional> conditional = wanted::value;
constexpr x3::rule<struct disjunction_tag, ast::Expression> disjunction = wanted::value;
constexpr x3::rule<struct conjunction_tag, ast::Expression> conjunction = wanted::value;
/// `not a` and `-a`.
constexpr x3::rule<struct denial_tag, ast::Unary> denial = wanted::value;
constexpr x3::rule<struct negative_tag, ast::Unary> negative = wanted::value;
constexpr x3::rule<struct negation_tag, ast::Expression> negation = wanted::value;
constexpr x3::rule<struct comparison_tag, ast::Expression> comparison = wanted::value;
constexpr x3::rule<struct sum_tag, ast::Expression> sum = wanted::value;
constexpr x3::rule<struct product_tag, ast::Expression> product = wanted::value;
constexpr x3::rule<struct signed_value_tag, ast::Expression> signed_value = wanted::value;
constexpr x3::rule<struct power_tag, ast::Expression> power = wanted::value;
constexpr x3::rule<struct primary_tag, ast::Expression> primary = wanted::value;
/// One expression in parentheses, or a list of several.
constexpr x3::rule<struct group_tag, ast::List> group = wanted::value;
constexpr x3::rule<struct number_tag, ast::Number> number = wanted::value;
/// What stands between `[` and `]` behind a name, and between `(` and `)` behind a declared one.
constexpr x3::rule<struct index_tag, std::vector<ast::Expression>> index = "an index";
constexpr x3::rule<struct closing_bracket_of_index_tag> closing_bracket_of_index = "`]`";
constexpr x3::rule<struct sizes_tag, std::vector<ast::Expression>> sizes = "the size of a vector or matrix";
constexpr x3::rule<struct experiment_word_tag> experiment_word = "`experiment`";
constexpr x3::rule<struct then_tag> then_word = "`then`";
constexpr x3::rule<struct else_tag> else_word = "`else`";
constexpr x3::rule<struct no_value_follows_tag> no_value_follows = wanted::operator_between;

/// Symbols by longest match.
struct binary_operator : x3::symbols<std::string> {
  binary_operator(std::initializer_list<char const*> spellings) {
    for (char const* spelling : spellings) add(spelling, spelling);
  }
};
binary_operator const comparison_operator{"<", "<=", ">", ">=", "==", "!="};
binary_operator const sum_operator{"+", "-"};
binary_operator const product_operator{"*", "/"};

inline void fold(ast::Expression& left, std::string symbol, ast::Expression& right) {
  Span const span = cover(left.span, right.span);
  ast::Binary binary{{span}, std::move(symbol), std::move(left), std::move(right)};
  left = {{span}, ast::Box<ast::Binary>(std::move(binary))};
}
/// (operator, right operand): left-associative.
constexpr auto fold_symbol = [](auto& context) {
  auto& part = x3::_attr(context);
  fold(x3::_val(context), std::move(boost::fusion::at_c<0>(part)), boost::fusion::at_c<1>(part));
};
constexpr auto fold_with(char const* symbol) {
  return [symbol](auto& context) { fold(x3::_val(context), symbol, x3::_attr(context)); };
}
constexpr auto take_group = [](auto& context) {
  ast::List& list = x3::_attr(context);
  if (list.items.size() == 1)
    x3::_val(context) = std::move(list.items.front());
  else
    x3::_val(context).node = ast::Box<ast::List>(std::move(list));
};
constexpr auto end_of_range = [](auto& context) { fold(x3::_val(context).value, "..", x3::_attr(context)); };
constexpr auto push_item = [](auto& context) { x3::_val(context).push_back(std::move(x3::_attr(context))); };
constexpr auto count_prime = [](auto& context) { ++x3::_val(context).primes; };

auto const expression_def = conditional[take_boxed] | disjunction[take];

auto const then_word_def = word("then");
auto const else_word_def = word("else");
auto const conditional_def =
    located[word("if") > nested[expression][to(&ast::Conditional::condition)] > then_word >
            nested[expression][to(&ast::Conditional::then)] > else_word > nested[expression][to(&ast::Conditional::otherwise)]];

auto const disjunction_def = conjunction[take] >> *(word("or") > conjunction[fold_with("or")]);
auto const conjunction_def = negation[take] >> *(word("and") > negation[fold_with("and")]);
auto const negation_def = denial[take_boxed] | comparison[take];
auto const denial_def = located[word("not")[symbol("not")] > nested[negation][to(&ast::Unary::operand)]];
// At most one: a second comparison operator is found by whatever stands behind the expression.
auto const comparison_def = sum[take] >> -(comparison_operator > sum)[fold_symbol];
auto const sum_def = product[take] >> *(sum_operator > product)[fold_symbol];
auto const product_def = signed_value[take] >> *(product_operator > signed_value)[fold_symbol] > no_value_follows;
auto const signed_value_def = negative[take_boxed] | power[take];
auto const negative_def = located[x3::lit('-')[symbol("-")] > nested[signed_value][to(&ast::Unary::operand)]];
auto const power_def = primary[take] >> -('^' > nested[signed_value][fold_with("^")]);
auto const no_value_follows_def = !(name | digit | '(' | '"');

auto const primary_def = located[number[take_node] | text[take_node] | group[take_group] | call[take_boxed] | reference[take_node]];
auto const number_def = located[plain_number[take] >> -unit[to(&ast::Number::unit)]];
auto const group_def =
    located['(' > nested[expression][append(&ast::List::items)] > *(',' > nested[expression][append(&ast::List::items)]) > ')'];

auto const call_def = located[name[to(&ast::Call::function)] >> '(' >>
                              -(argument[append(&ast::Call::arguments)] >> *(',' > argument[append(&ast::Call::arguments)])) > ')'];
auto const distribution_def = located[call[take]];
auto const argument_def = located[-(element >> equals)[to(&ast::Argument::name)] >> nested[expression][to(&ast::Argument::value)] >>
                                  -(x3::lit("..") > nested[expression][end_of_range])];

auto const reference_def =
    located[path[to(&ast::Reference::name)] >> -(x3::no_skip[&x3::lit('[')] >> index[to(&ast::Reference::index)]) >>
            x3::no_skip[*x3::lit('\'')[count_prime]]];
auto const index_def = '[' > nested[expression][push_item] > *(',' > nested[expression][push_item]) > closing_bracket_of_index;
auto const closing_bracket_of_index_def = x3::lit(']');

auto const declared_def =
    located[name[to(&ast::Declared::name)] >> -sizes[to(&ast::Declared::sizes)] >> -unit[to(&ast::Declared::unit)]];
auto const declared_parameter_def =
    located[name[to(&ast::Declared::name)] >> -sizes[to(&ast::Declared::sizes)] >>
            -(word("per") > experiment_word)[set(&ast::Declared::per_experiment, true)] >> -unit[to(&ast::Declared::unit)]];
auto const experiment_word_def = word("experiment");
auto const sizes_def = '(' > nested[expression][push_item] > *(',' > nested[expression][push_item]) > ')';

BOOST_SPIRIT_DEFINE(expression, conditional, then_word, else_word, disjunction, conjunction, negation, denial, comparison, sum,
                    product, signed_value, negative, power, no_value_follows, primary, number, group, call, distribution, argument,
                    reference, index, closing_bracket_of_index, declared, declared_parameter, experiment_word, sizes)

}  // namespace sysid::grammar

// Definitions of dictionary.hpp: one rule per statement. No equation stands here, so a keyword commits at once. What is declared is
// a number: there are no sizes.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/dictionary.hpp"
#include "grammar/model.hpp"

namespace sysid::grammar {

struct dictionary_line_tag : resumes_behind_statement {};

constexpr x3::rule<dictionary_line_tag, ast::DictionaryStatement> dictionary_line = wanted::dictionary_statement;
constexpr x3::rule<struct dictionary_statement_tag, ast::DictionaryStatement> dictionary_statement = wanted::dictionary_statement;
constexpr x3::rule<struct quantity_tag, ast::Declared> quantity = wanted::name;
constexpr x3::rule<struct dictionary_discrete_tag, ast::DiscreteTimeDeclaration> dictionary_discrete = "a declaration of time";
constexpr x3::rule<struct dictionary_time_tag, ast::TimeDeclaration> dictionary_time = "a declaration of time";
constexpr x3::rule<struct dictionary_inputs_tag, ast::InputDeclaration> dictionary_inputs = "a declaration of inputs";
constexpr x3::rule<struct measured_state_tag, ast::DictionaryState> measured_state = wanted::name;
constexpr x3::rule<struct dictionary_states_tag, ast::DictionaryStates> dictionary_states = "a declaration of states";
constexpr x3::rule<struct dictionary_parameter_tag, ast::DictionaryParameter> dictionary_parameter = "a declaration of a parameter";
constexpr x3::rule<struct dictionary_definition_tag, ast::Definition> dictionary_definition = "a definition";
constexpr x3::rule<struct dictionary_list_tag, ast::DictionaryList> dictionary_list = "a list of terms";
constexpr x3::rule<struct coefficient_units_tag, ast::CoefficientUnits> coefficient_units = "the units of coefficients";

constexpr auto prime_of_state = [](auto& context) { ++x3::_val(context).primes; };

auto const dictionary_def = located[keyword("dictionary") > name[to(&ast::Dictionary::name)] > -text[to(&ast::Dictionary::title)] >
                                    opening_brace > *(dictionary_line[append(&ast::Dictionary::statements)] | '\n' | ';') > '}'];
auto const dictionary_line_def = (!(x3::lit('\n') | ';' | '}' | x3::eoi)) > dictionary_statement[take] > end_of_statement;
auto const dictionary_statement_def = dictionary_discrete[take] | dictionary_time[take] | dictionary_inputs[take] |
                                      dictionary_states[take] | dictionary_parameter[take] | dictionary_definition[take] |
                                      function_definition[take] | dictionary_list[take] | coefficient_units[take];

auto const quantity_def = located[name[to(&ast::Declared::name)] >> -unit[to(&ast::Declared::unit)]];
auto const dictionary_discrete_def = located[word("time") >> word("discrete") >>
                                             (&end_of_statement | (&digit >> expression[to(&ast::DiscreteTimeDeclaration::step)]))];
auto const dictionary_time_def = located[word("time") > quantity[to(&ast::TimeDeclaration::time)]];
auto const dictionary_inputs_def = located[word("input") > quantity[append(&ast::InputDeclaration::names)] >
                                           *(',' > quantity[append(&ast::InputDeclaration::names)])];
auto const measured_state_def =
    located[name[to(&ast::DictionaryState::name)] >> x3::no_skip[*x3::lit('\'')[prime_of_state]] >>
            -unit[to(&ast::DictionaryState::unit)] >> -(equals > element[to(&ast::DictionaryState::channel)])];
auto const dictionary_states_def = located[word("state") > measured_state[append(&ast::DictionaryStates::states)] >
                                           *(',' > measured_state[append(&ast::DictionaryStates::states)])];
auto const dictionary_parameter_def = located[word("parameter") > quantity[to(&ast::DictionaryParameter::name)] >
                                              -((tilde > distribution[to(&ast::DictionaryParameter::prior)]) |
                                                (equals > expression[to(&ast::DictionaryParameter::value)]))];
auto const dictionary_definition_def =
    located[(word("constant")[set(&ast::Definition::kind, ast::DefinitionKind::constant)] |
             word("let")[set(&ast::Definition::kind, ast::DefinitionKind::local)]) > quantity[to(&ast::Definition::name)] > equals >
            expression[to(&ast::Definition::value)]];
auto const dictionary_list_def =
    located[(word("target")[set(&ast::DictionaryList::kind, ast::DictionaryListKind::target)] |
             word("terms")[set(&ast::DictionaryList::kind, ast::DictionaryListKind::terms)] |
             word("exclude")[set(&ast::DictionaryList::kind, ast::DictionaryListKind::exclude)]) > equals >
            expression[append(&ast::DictionaryList::items)] > *(',' > expression[append(&ast::DictionaryList::items)])];
auto const coefficient_units_def = located[word("coefficients") > equals > unit[append(&ast::CoefficientUnits::units)] >
                                           *(',' > unit[append(&ast::CoefficientUnits::units)])];

BOOST_SPIRIT_DEFINE(dictionary, dictionary_line, dictionary_statement, quantity, dictionary_discrete, dictionary_time,
                    dictionary_inputs, measured_state, dictionary_states, dictionary_parameter, dictionary_definition,
                    dictionary_list, coefficient_units)

}  // namespace sysid::grammar

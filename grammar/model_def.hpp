// Definitions of model.hpp: one rule per statement. To add one: a node in syntax/ast.hpp, a word in syntax/words.hpp, a rule here,
// a line in sysid.ebnf, a case in syntax/unparse.cpp.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/model.hpp"

namespace sysid::grammar {

struct model_line_tag : resumes_behind_statement {};

constexpr x3::rule<model_line_tag, ast::ModelStatement> model_line = wanted::model_statement;
constexpr x3::rule<struct model_statement_tag, ast::ModelStatement> model_statement = wanted::model_statement;
constexpr x3::rule<struct model_argument_tag, ast::ModelArgument> model_argument = wanted::name;
constexpr x3::rule<struct discrete_time_tag, ast::DiscreteTimeDeclaration> discrete_time = "a declaration of time";
constexpr x3::rule<struct time_declaration_tag, ast::TimeDeclaration> time_declaration = "a declaration of time";
constexpr x3::rule<struct input_declaration_tag, ast::InputDeclaration> input_declaration = "a declaration of inputs";
constexpr x3::rule<struct state_declaration_tag, ast::StateDeclaration> state_declaration = "a declaration of states";
constexpr x3::rule<struct disturbance_declaration_tag, ast::DisturbanceDeclaration> disturbance_declaration =
    "a declaration of a disturbance";
constexpr x3::rule<struct initial_declaration_tag, ast::InitialDeclaration> initial_declaration = "initial values";
constexpr x3::rule<struct initial_value_tag, ast::InitialValue> initial_value = wanted::name;
constexpr x3::rule<struct parameter_declaration_tag, ast::ParameterDeclaration> parameter_declaration =
    "a declaration of a parameter";
constexpr x3::rule<struct definition_tag, ast::Definition> definition = "a definition";
constexpr x3::rule<struct process_definition_tag, ast::ProcessDefinition> process_definition = "a Gaussian process";
constexpr x3::rule<struct observation_tag, ast::Observation> observation = "an observation";
constexpr x3::rule<struct part_tag, ast::Part> part = "a part";
constexpr x3::rule<struct equation_tag, ast::Equation> equation = "an equation";

auto const model_def =
    located[keyword("model") > name[to(&ast::Model::name)] > -('(' > model_argument[append(&ast::Model::arguments)] >
                                                               *(',' > model_argument[append(&ast::Model::arguments)]) > ')') >
            -text[to(&ast::Model::title)] > opening_brace > *(model_line[append(&ast::Model::statements)] | '\n' | ';') > '}'];
auto const model_line_def = (!(x3::lit('\n') | ';' | '}' | x3::eoi)) > model_statement[take] > end_of_statement;
auto const model_statement_def = discrete_time[take] | time_declaration[take] | input_declaration[take] | state_declaration[take] |
                                 disturbance_declaration[take] | initial_declaration[take] | parameter_declaration[take] |
                                 definition[take] | process_definition[take] | function_definition[take] | observation[take] |
                                 part[take] | equation[take];

auto const model_argument_def =
    located[name[to(&ast::ModelArgument::name)] >> -(equals > expression[to(&ast::ModelArgument::value)])];
auto const discrete_time_def = located[keyword("time") >> word("discrete") >>
                                       (&end_of_statement | (&digit >> expression[to(&ast::DiscreteTimeDeclaration::step)]))];
auto const time_declaration_def = located[keyword("time") > declared[to(&ast::TimeDeclaration::time)]];
auto const input_declaration_def = located[keyword("input") > declared[append(&ast::InputDeclaration::names)] >
                                           *(',' > declared[append(&ast::InputDeclaration::names)])];
auto const state_declaration_def = located[keyword("state") > declared[append(&ast::StateDeclaration::names)] >
                                           *(',' > declared[append(&ast::StateDeclaration::names)])];
auto const disturbance_declaration_def = located[keyword("disturbance") > declared[to(&ast::DisturbanceDeclaration::name)] > tilde >
                                                 distribution[to(&ast::DisturbanceDeclaration::law)]];
auto const initial_declaration_def = located[keyword("initial") > initial_value[append(&ast::InitialDeclaration::values)] >
                                             *(',' > initial_value[append(&ast::InitialDeclaration::values)])];
auto const initial_value_def =
    located[reference[to(&ast::InitialValue::state)] > ((tilde > distribution[to(&ast::InitialValue::law)]) |
                                                        (x3::expect[equals] > expression[to(&ast::InitialValue::value)]))];
auto const parameter_declaration_def = located[keyword("parameter") > declared_parameter[to(&ast::ParameterDeclaration::name)] >
                                               -((tilde > distribution[to(&ast::ParameterDeclaration::prior)]) |
                                                 (equals > expression[to(&ast::ParameterDeclaration::value)]))];
auto const definition_def = located[(keyword("constant")[set(&ast::Definition::kind, ast::DefinitionKind::constant)] |
                                     keyword("let")[set(&ast::Definition::kind, ast::DefinitionKind::local)] |
                                     keyword("derive")[set(&ast::Definition::kind, ast::DefinitionKind::derived)]) >
                                    declared[to(&ast::Definition::name)] > equals > expression[to(&ast::Definition::value)]];
auto const function_definition_def =
    located[keyword("function") > name[to(&ast::FunctionDefinition::name)] > '(' >
            -(name[append(&ast::FunctionDefinition::parameters)] >> *(',' > name[append(&ast::FunctionDefinition::parameters)])) >
            ')' > equals > expression[to(&ast::FunctionDefinition::value)]];
// Up to `~` it may still be a function with a value: that rule says what is wrong with a head.
auto const process_definition_def =
    located[keyword("function") >> name[to(&ast::ProcessDefinition::name)] >> '(' >>
            name[append(&ast::ProcessDefinition::inputs)] >> *(',' >> name[append(&ast::ProcessDefinition::inputs)]) >> ')' >>
            tilde > distribution[to(&ast::ProcessDefinition::process)]];
auto const observation_def =
    located[keyword("observe") > declared[to(&ast::Observation::channel)] > tilde > distribution[to(&ast::Observation::noise)]];
auto const part_def = located[keyword("part") > name[to(&ast::Part::name)] > equals > call[to(&ast::Part::model)]];
auto const equation_def =
    located[!(x3::lit('+') | '-') >> expression[to(&ast::Equation::left)] > equals > expression[to(&ast::Equation::right)]];

BOOST_SPIRIT_DEFINE(model, model_line, model_statement, model_argument, discrete_time, time_declaration, input_declaration,
                    state_declaration, disturbance_declaration, initial_declaration, initial_value, parameter_declaration,
                    definition, function_definition, process_definition, observation, part, equation)

}  // namespace sysid::grammar

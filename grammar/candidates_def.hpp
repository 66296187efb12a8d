// Definitions of candidates.hpp. A candidate begins with a model's name, so only `shared` with a name behind it is a word;
// `shared probability 0.5` is a model of that name.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/candidates.hpp"

namespace sysid::grammar {

struct candidate_line_tag : resumes_behind_statement {};

constexpr x3::rule<candidate_line_tag, ast::CandidateStatement> candidate_line = wanted::candidate_statement;
constexpr x3::rule<struct candidate_statement_tag, ast::CandidateStatement> candidate_statement = wanted::candidate_statement;
constexpr x3::rule<struct candidate_tag, ast::Candidate> candidate = wanted::candidate_statement;
constexpr x3::rule<struct shared_parameters_tag, ast::SharedParameters> shared_parameters = "shared parameters";

auto const candidates_def = located[keyword("candidates") > name[to(&ast::Candidates::name)] > -text[to(&ast::Candidates::title)] >
                                    opening_brace > *(candidate_line[append(&ast::Candidates::statements)] | '\n' | ';') > '}'];
auto const candidate_line_def = (!(x3::lit('\n') | ';' | '}' | x3::eoi)) > candidate_statement[take] > end_of_statement;
auto const candidate_statement_def = shared_parameters[take] | candidate[take];
auto const shared_parameters_def =
    located[(word("shared") >> &name_begin >> !(word("probability") >> !(',' | end_of_statement))) >
            element[append(&ast::SharedParameters::names)] > *(',' > element[append(&ast::SharedParameters::names)])];
auto const candidate_def =
    located[name[to(&ast::Candidate::model)] >
            -('(' > argument[append(&ast::Candidate::arguments)] > *(',' > argument[append(&ast::Candidate::arguments)]) > ')') >
            -(word("probability") > expression[to(&ast::Candidate::probability)])];

BOOST_SPIRIT_DEFINE(candidates, candidate_line, candidate_statement, candidate, shared_parameters)

}  // namespace sysid::grammar

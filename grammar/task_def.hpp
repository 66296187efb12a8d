// Definitions of task.hpp: `[NAME =] VERB SUBJECT [to DATA[.PART]] [with OPTION, ...]`. Verbs and prepositions are rows of
// syntax/words.hpp; which preposition and which options a verb takes is the checker's business.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/task.hpp"

namespace sysid::grammar {

struct verb_tag {};
struct preposition_tag {};
struct data_reference_tag {};
struct option_tag {};
struct data_word_tag {};
struct end_of_task_tag {};

constexpr x3::rule<verb_tag, ast::Name> verb = wanted::verb;
constexpr x3::rule<preposition_tag, ast::Name> preposition = "`to`, `on` or `from`";
constexpr x3::rule<data_reference_tag, ast::DataReference> data_reference = "the name of a data block";
constexpr x3::rule<option_tag, ast::Option> option = "an option";
constexpr x3::rule<end_of_task_tag> end_of_task = wanted::end_of_task;

template <auto const& Table>
constexpr auto take_one_of = [](auto& context) {
  x3::_pass(context) = words::contains(Table, x3::_attr(context).text);
  x3::_val(context) = std::move(x3::_attr(context));
};

auto const task_def =
    located[(((name >> equals)[to(&ast::Task::name)] > verb[to(&ast::Task::verb)]) | verb[to(&ast::Task::verb)]) >
            name[to(&ast::Task::subject)] > -(preposition[to(&ast::Task::preposition)] > data_reference[to(&ast::Task::data)]) >
            -(word("with") > option[append(&ast::Task::options)] > *(',' > option[append(&ast::Task::options)])) > end_of_task];
auto const verb_def = located[name[take_one_of<words::verbs>]];
auto const preposition_def = located[name[take_one_of<words::prepositions>]];
auto const data_reference_def = located[name[to(&ast::DataReference::data)] >> -('.' > name[to(&ast::DataReference::part)])];
auto const option_def = located[((word("input") >> &name)[set(&ast::Option::input, true)] > name[to(&ast::Option::key)] > equals >
                                 expression[to(&ast::Option::value)]) |
                                (-(name >> equals)[to(&ast::Option::key)] >> expression[to(&ast::Option::value)])];
auto const end_of_task_def = &end_of_statement;

BOOST_SPIRIT_DEFINE(task, verb, preposition, data_reference, option, end_of_task)

}  // namespace sysid::grammar

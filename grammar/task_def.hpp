// Definitions of task.hpp: `[NAME =] VERB SUBJECT[(ARGUMENT, ...)] [to DATA[.PART], ...] [with OPTION, ...]`; `predict` takes
// several subjects, `predict FIT, FIT on DATA`. Verbs and prepositions are rows of syntax/words.hpp; which preposition and which
// options a verb takes is the checker's business.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/task.hpp"

namespace sysid::grammar {

constexpr x3::rule<struct verb_tag, ast::Name> verb = wanted::verb;
constexpr x3::rule<struct preposition_tag, ast::Name> preposition = "`to`, `on` or `from`";
constexpr x3::rule<struct data_reference_tag, ast::DataReference> data_reference = "the name of a data block";
constexpr x3::rule<struct another_fit_tag, ast::Name> another_fit = "the name of another fit";
constexpr x3::rule<struct option_tag, ast::Option> option = "an option";
/// `with` and what follows; its own list, since an alternative does not roll a container back.
constexpr x3::rule<struct settings_tag, std::vector<ast::Option>> settings = "`with`";
constexpr x3::rule<struct preposition_or_end_tag> preposition_or_end = wanted::preposition_or_end;
constexpr x3::rule<struct with_or_end_tag> with_or_end = wanted::with_or_end;

template <auto const& Table>
constexpr auto take_one_of = [](auto& context) {
  x3::_pass(context) = words::contains(Table, x3::_attr(context).text);
  x3::_val(context) = std::move(x3::_attr(context));
};

constexpr auto takes_several = [](auto& context) {
  x3::_pass(context) = words::task_kind(x3::_val(context).verb.text) == TaskKind::predict;
};

constexpr auto push = [](auto& context) { x3::_val(context).push_back(std::move(x3::_attr(context))); };

auto const task_def =
    located[(((name >> equals)[to(&ast::Task::name)] > verb[to(&ast::Task::verb)]) | verb[to(&ast::Task::verb)]) >
            name[to(&ast::Task::subject)] >
            -('(' > argument[append(&ast::Task::arguments)] > *(',' > argument[append(&ast::Task::arguments)]) > ')') >
            *((x3::eps[takes_several] >> ',') > another_fit[append(&ast::Task::others)]) >
            ((preposition[to(&ast::Task::preposition)] > data_reference[append(&ast::Task::data)] >
              *(',' > data_reference[append(&ast::Task::data)]) > (settings[to(&ast::Task::options)] | x3::expect[with_or_end])) |
             settings[to(&ast::Task::options)] | x3::expect[preposition_or_end])];
auto const settings_def = word("with") > option[push] > *(',' > option[push]);
auto const verb_def = located[name[take_one_of<words::verbs>]];
auto const preposition_def = located[name[take_one_of<words::prepositions>]];
auto const data_reference_def = located[name[to(&ast::DataReference::data)] >> -('.' > name[to(&ast::DataReference::part)])];
auto const another_fit_def = name;
auto const option_def = located[((word("input") >> &name)[set(&ast::Option::input, true)] > element[to(&ast::Option::key)] >
                                 equals > expression[to(&ast::Option::value)]) |
                                (-(name >> equals)[to(&ast::Option::key)] >> expression[to(&ast::Option::value)])];
auto const preposition_or_end_def = &end_of_statement;
auto const with_or_end_def = &end_of_statement;

BOOST_SPIRIT_DEFINE(task, verb, preposition, data_reference, another_fit, option, settings, preposition_or_end, with_or_end)

}  // namespace sysid::grammar

// Messages about reuse: vectors and matrices, models inside models, modules. The other messages: check/message/errors.hpp.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "check/message/errors.hpp"
#include "syntax/shape.hpp"

namespace sysid::errors {

// vectors and matrices (E27)
Diagnostic whole_number_needed(Span span, Subject const& what);
Diagnostic size_out_of_range(Span span, std::string const& name, long size, long most);
Diagnostic too_many_sizes(Span span, std::string const& name);
Diagnostic shape_conflict(Span span, std::string const& symbol, Shape const& left, Span left_span, Shape const& right,
                          Span right_span);
/// E2705: `initial y = (0, 0)` of a number.
Diagnostic list_of_initial(Span span, ast::Reference const& state, Shape const& given);
Diagnostic wrong_shape(Span span, Subject const& what, Shape const& given, Shape const& wanted);
Diagnostic uneven_list(Span span, Shape const& first, Shape const& other, Span other_span);
Diagnostic index_out_of_range(Span span, std::string const& name, Shape const& shape);
Diagnostic index_count(Span span, std::string const& name, Shape const& shape, std::size_t given);
Diagnostic array_arguments(ast::Name const& function, std::size_t given, std::string const& usage);
Diagnostic model_too_large(Span span);
Diagnostic models_too_large(Span span);

// models inside models (E28)
Diagnostic part_cycle(Span span, Names const& loop);
Diagnostic model_argument_missing(Span span, std::string const& model, std::string const& argument);
Diagnostic unknown_model_argument(ast::Name const& name, std::string const& model, Names const& known);
/// Of the i-th argument and those without a name behind it, at the last of which i is then: `n = 1, 2, 3`.
Diagnostic model_argument_by_position(std::span<ast::Argument const> arguments, std::size_t& i, std::string const& model,
                                      Names const& known);
Diagnostic model_argument_twice(Span second, Span first, std::string const& name);
Diagnostic input_of_part_unbound(Span span, std::string const& part, Names const& inputs, std::string const& model);
Diagnostic no_rate_of_binding(Span use, Span binding, std::string const& input);
/// models: how many a candidate stands for.
Diagnostic candidate_range(Span span, long models, std::size_t most);
Diagnostic discrete_part(Span span, std::string const& part, Span declaration);
Diagnostic process_of_part(Span span, std::string const& part, Span declaration);

// modules (E29)
Diagnostic module_not_found(ast::Name const& module, std::string const& folder, Names const& known);
Diagnostic module_cycle(Span span, Names const& loop);
Diagnostic name_of_two_modules(Span second, Span first, std::string const& kind, std::string const& name);
Diagnostic not_for_a_module(Span span, std::string const& what, std::string const& module);

}  // namespace sysid::errors

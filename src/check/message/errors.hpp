// The messages of the checker, one named constructor per mistake; the wording is in errors_*.cpp beside this file. Those about
// units are in check/units/unit_errors.cpp, those about data files in data/table/*_errors.cpp, those about syntax in
// grammar/message.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "check/message/subject.hpp"
#include "core/numeric/unit.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"
#include "syntax/unit_slips.hpp"
#include "syntax/words.hpp"

namespace sysid::errors {

// names, functions, units (E20)
/// moving: the states and inputs among the known.
Diagnostic unknown_name(ast::Name const& name, Names const& known, Names const& moving = {});
/// `dy/dt`, whose derivative has this many primes. name: `y`; declared: it is in this model.
Diagnostic quotient_as_derivative(Span span, ast::Reference const& above, std::string const& name, int primes, bool declared);
Diagnostic duplicate_name(ast::Name const& name, Span first);
Diagnostic unknown_function(ast::Call const& call, Names const& known, bool is_quantity);
/// `y(t)`, `y(t - 0.01)` of a quantity in continuous time; nothing for other calls.
std::optional<Diagnostic> quantity_at_time(ast::Call const& call);
Diagnostic argument_count(ast::Name const& function, std::size_t given, std::size_t least, std::size_t most);
Diagnostic piecewise_without_otherwise(ast::Call const& call);
Diagnostic named_argument_of_function(ast::Name const& argument, std::string const& function);
/// `y^1/3`: power, divisor.
Diagnostic divided_power(ast::Binary const& power, ast::Expression const& divisor);
Diagnostic definition_cycle(Span span, Names const& loop);
Diagnostic primes_on(ast::Reference const& reference, std::string const& what);
/// `D'` of a vector or matrix that is defined: often a transpose is meant.
Diagnostic primes_on_array(ast::Reference const& reference);
Diagnostic beyond_highest(ast::Reference const& reference, int order);
Diagnostic second_input_derivative(ast::Reference const& reference);
Diagnostic not_a_number(Span span, Subject const& what);
Diagnostic constant_needed(Span span, Subject const& what);
/// meant: what it seems to stand for, when its letters tell; whole: the unit it stands in, as it should be written.
Diagnostic unknown_unit(ast::Name const& name, std::optional<UnitSlip> const& meant = std::nullopt, std::string const& whole = {});
Diagnostic unit_exponent(Span span);
Diagnostic list_here(Span span);
Diagnostic number_of_other_kind(Span span, Subject const& what, Unit const& given, Unit const& wanted);
Diagnostic number_in_cycles(Span span, Subject const& what, Unit const& given, Unit const& wanted);

// distributions (E21)
/// A log-normal distribution with the arguments of other languages, as it is written here.
struct LogNormalOfOthers {
  std::string of_logarithm;   // its arguments are of the logarithm; empty: it is none
  std::string of_median;      // if the first is the median; empty: it cannot be
  bool median_first = false;  // which is the likelier
};
Diagnostic unknown_distribution(ast::Name const& name, Names const& known, LogNormalOfOthers const& written = {});
Diagnostic unknown_argument(ast::Name const& argument, std::string const& distribution, Names const& known);
Diagnostic argument_twice(Span second, Span first, std::string const& spelling, std::string const& other);
Diagnostic argument_missing(ast::Call const& call, Names const& spellings);
/// argument: one of call's, without a name.
/// first: what else the first argument may mean; empty: nothing.
Diagnostic must_be_named(ast::Call const& call, ast::Argument const& argument, Names const& spellings,
                         std::string const& first = {});
/// Of `log_normal(log(30), ...)`: a median by position, or the mean of the logarithm. written: as the latter.
Diagnostic logarithm_or_number(ast::Argument const& argument, std::string const& written, std::string const& distribution);
Diagnostic logarithm_of_shifted(Span span, std::string const& spelling, std::string const& distribution);
Diagnostic too_many_arguments(ast::Call const& call, ast::Argument const& argument, Names const& signature);
/// bounds: the arguments are a lower and an upper one; truncates: other bounds can be given.
Diagnostic range_in_distribution(ast::Call const& call, ast::Expression const& range, bool bounds, bool truncates);
/// `half_normal(0, sd = 1)`.
Diagnostic place_of_half(ast::Call const& call, std::string const& width);
/// `student_t(4, y, scale = s)`.
Diagnostic degrees_of_freedom_first(ast::Call const& call);
Diagnostic not_a_noise(ast::Call const& call, Names const& known);
Diagnostic truncated_noise(ast::Call const& call);
Diagnostic cannot_truncate(Span span, std::string const& distribution);
Diagnostic prior_reads(Span span, std::string const& parameter, std::string const& what);
Diagnostic prior_cycle(Span span, Names const& loop);
/// help: how the call is written, empty where that is not known.
Diagnostic bad_arguments(Span span, std::string const& distribution, std::string_view reason, std::string help);
/// names: of the parameters that the argument reads.
Diagnostic never_allowed(Span span, std::string const& distribution, std::string const& variate, std::string_view reason,
                         std::vector<std::string> const& names);
/// argument: "sd"; of: what has it.
Diagnostic width_below_zero(Span parameter, std::string const& name, std::string const& argument, std::string const& of);
Diagnostic wide_logarithm(Span width, std::string const& distribution, std::string const& spelling, std::string const& written);
/// A number of an angle in `unit` that looks like one in `meant`.
Diagnostic angle_in_other_unit(Span argument, std::string const& text, std::string const& name, std::string const& unit,
                               std::string const& meant);
Diagnostic no_mass(Span span, std::string const& distribution);
Diagnostic unit_of_share(Span span, std::string const& distribution, std::string const& unit);
Diagnostic unit_of_count(Span span, std::string const& distribution, std::string const& unit);
Diagnostic count_as_prior(ast::Call const& call);
Diagnostic noise_of_counts(Span span, std::string const& channel, std::string const& distribution);
Diagnostic no_prior_or_value(ast::ParameterDeclaration const& parameter);

// structure of a model (E30)
Diagnostic state_without_equation(Span declaration, std::string const& state, std::string const& highest);
Diagnostic algebraic_state(Span declaration, std::string const& state);
Diagnostic surplus_equation(ast::Equation const& equation, Names const& states);
Diagnostic explicit_solver(Span option, std::string const& solver, Span equation, std::string const& unknown);
/// part: what is not linear in the states; absent where it has no place in the text.
Diagnostic solver_of_linear_equations(Span option, std::string const& solver, std::optional<Span> const& part, bool varies);
Diagnostic solver_that_reads_no_time(Span option, std::string const& solver, std::string const& model);
Diagnostic solver_of_few_states(Span option, std::string const& solver, std::string const& model, std::size_t states, int most);
/// held: not even a straight line will do.
Diagnostic input_of_exact_solver(Span input, std::string const& name, Span option, std::string const& solver, bool held);
Diagnostic constraint_of_input(ast::Equation const& equation, std::string const& input);
Diagnostic constraint_of_unknown(ast::Equation const& equation, std::string const& unknown);
Diagnostic start_off_constraint(Span equation, Span initial);
Diagnostic start_not_used(Span initial, std::string const& unknown);
Diagnostic estimated_start_of_constraint(Span start, Span equation);
Diagnostic undetermined(Span declaration, std::string const& unknown);
/// missing: components without an initial value.
Diagnostic initial_of_highest(ast::Reference const& reference, std::string const& state, int order, Names const& missing = {});
/// values: of each component, what it may be given.
/// What stands behind `initial y =`.
struct StartValue {
  std::string value;
  std::string declaration = {};  // of the value, where it is not declared
  bool may_be_zero = false;      // as a difference
};
Diagnostic initial_missing(Span declaration, Names const& components, std::vector<StartValue> const& values);
Diagnostic initial_twice(Span second, Span first, std::string const& component);
Diagnostic initial_moves(Span span);
/// `initial y = displacement`, a channel.
Diagnostic initial_from_channel(ast::Name const& channel, ast::Reference const& state, std::optional<Unit> const& unit);
Diagnostic not_a_state(ast::Name const& name, Names const& states, Names const& missing = {});
Diagnostic initial_of_input(ast::Name const& name);
Diagnostic channel_twice(ast::Name const& name, Span first);
Diagnostic nothing_observed(ast::Name const& model);
Diagnostic duplicate_item(ast::Name const& name, std::string const& kind, Span first);
/// What declares a parameter or an input.
enum class Declarer { model, dictionary };
/// Warnings.
Diagnostic unused_parameter(Span declaration, std::string const& parameter, bool has_prior, Declarer where = Declarer::model);
Diagnostic unused_input(Span declaration, std::string const& input, Declarer where = Declarer::model);
Diagnostic time_twice(Span second, Span first);

// samples and discrete time (E31)
Diagnostic lag_without_discrete_time(ast::Call const& call);
Diagnostic lag_count(Span span);
/// E2001: `lag(level, 1)` of a channel; past: how its earlier samples are written.
Diagnostic channel_as_quantity(ast::Name const& name, bool discrete, std::string const& past);
struct IndexedQuantity {
  std::string name;
  bool is_channel = false, in_brackets = true;
};
/// `u[t-1]` (E2707) and `u(t-1)` (E2003) in discrete time; nothing where the index counts no samples.
std::optional<Diagnostic> sample_by_index(Span span, ast::Expression const& index, IndexedQuantity const& what);
Diagnostic lags_out_of_place(ast::Call const& call);
Diagnostic primes_in_discrete_time(ast::Reference const& reference);
/// name: what stands in place of the channel, when it is a name.
Diagnostic not_a_channel(Span span, std::string const& function, std::string const& name, Names const& channels);
Diagnostic samples_in_differential_equation(ast::Call const& call);
Diagnostic change_out_of_place(ast::Call const& call, bool discrete, bool no_states);
Diagnostic own_sample(Span span, std::string const& channel);
Diagnostic own_sample_in_function(Span call, std::string const& function, std::string const& channel);
Diagnostic prediction_cycle(Span span, std::string const& channel);
Diagnostic present_prediction(Span span, std::string const& channel);
Diagnostic range_out_of_place(Span span);
Diagnostic initial_lag_missing(Span declaration, std::string const& state);
Diagnostic implicit_in_discrete_time(Span equation, std::string const& state);
Diagnostic forgotten_lag(Span equation, std::string const& state);

// data blocks (E40; the file's own contents: data/table/*_errors.hpp)
Diagnostic no_file(ast::Name const& block);
Diagnostic no_time(ast::Name const& block);
Diagnostic time_and_rate(Span second, Span first);
Diagnostic stated_twice(Span second, Span first, Subject const& what);
Diagnostic rule_missing(Span span, std::string const& input, Names const& rules);
Diagnostic unknown_rule(ast::Name const& rule, Names const& known);
/// E4117, E4118: settings of `read`; usage: "decimal = \",\"".
Diagnostic unknown_reading(ast::Name const& setting, Names const& known);
Diagnostic bad_reading(Span span, std::string const& setting, std::string const& wanted, std::string const& usage);
Diagnostic reading_contradicts(Span span, std::string const& reason);
Diagnostic not_a_time(Span span, Unit const& unit);
Diagnostic rate_not_positive(Span span);
Diagnostic bad_rows(Span span);
// owner: named("model", "duffing") or named("dictionary", "restoring")
Diagnostic input_not_bound(Span span, std::string const& input, Subject const& owner, std::string const& data);
Diagnostic no_channel_bound(Span span, Subject const& owner, std::string const& data, Names const& channels);
/// unit: of its column; may be empty.
Diagnostic unknown_input(Span span, std::string const& input, std::string const& unit, Subject const& owner, Names const& inputs);
Diagnostic unknown_channel(Span span, std::string const& channel, Subject const& owner, Names const& channels);
/// The same where the data have one column and the model another channel.
Diagnostic channel_of_other_name(Span span, std::string const& channel, Subject const& owner, std::string const& own,
                                 std::pair<std::string, std::string> const& column_and_unit);
/// rules: those under which the derivative exists.
Diagnostic rate_under_zero_order(Span rule, Span use, std::string const& input, Names const& rules);
Diagnostic unit_mismatch(Span span, Subject const& what, std::string const& column_unit, std::string const& declared_unit);

// tasks (E60)
Diagnostic unknown_item(ast::Name const& name, std::string const& kind, Names const& known);
/// What to do where the subject of a task is of another kind, which has this verb.
std::string verb_of_subject(ast::Task const& task, std::string const& kind, std::string const& verb);
/// is_data: the name is that of a data block.
Diagnostic unknown_fit(ast::Name const& name, Names const& known, bool is_data);
/// A part of something named: "data `bench` has no range `trian`".
Diagnostic unknown_member(ast::Name const& name, Subject const& owner, std::string const& kind, Names const& known);
Diagnostic unknown_option(Span span, std::string const& option, OptionOwner const& owner, Names const& known);
/// `with "map"`, `with map + mh`: an option that is neither a name nor a call, and has no key.
Diagnostic option_without_name(ast::Expression const& option, std::string const& verb);
/// E2106: `schedule = 100, 10, 1`, by the indices of the argument with the name and of the last one without.
Diagnostic list_without_parentheses(ast::Call const& call, std::size_t first, std::size_t last);
Diagnostic option_missing(ast::Task const& task, std::string const& option, std::string const& example);
Diagnostic option_kind(Span span, std::string const& option, Subject const& wanted, std::string const& example);
Diagnostic option_range(Span span, std::string const& option, double given, double least, double most);
/// Of a bare number that was hardly meant in radians.
Diagnostic angle_beyond_turn(ast::Expression const& given, std::string const& option);
/// Of an option whose 0 stands for something else.
Diagnostic option_range_or_zero(Span span, std::string const& option, double given, double least, double most);
Diagnostic option_choice(Span span, std::string const& option, std::string const& given, Names const& choices);
Diagnostic backend_missing(ast::Task const& task, Names const& known);
Diagnostic unknown_backend(ast::Name const& name, Names const& known);
Diagnostic data_missing(ast::Task const& task, std::string const& preposition);
Diagnostic data_unused(ast::Task const& task, Span data);
Diagnostic not_a_fit(ast::Name const& name, std::string const& verb);
// --- errors_averages.cpp
Diagnostic averaged_twice(ast::Name const& second, Span first);
Diagnostic selection_in_average(ast::Name const& name);
Diagnostic weights_of_one_fit(Span option, std::string const& subject);
/// reason: "`ml` has no evidence".
Diagnostic fit_without_weight(ast::Name const& fit, std::string const& backend, std::string const& reason, std::string const& help);
Diagnostic average_without_channel(ast::Name const& fit, std::string const& channel, std::string const& other,
                                   std::string const& data);
Diagnostic average_of_two_units(ast::Name const& fit, Unit const& unit, std::string const& channel, std::string const& other,
                                Unit const& other_unit);
Diagnostic average_redrawn(Span option);
Diagnostic fixed_parameter(ast::Name const& name, Span declaration);
Diagnostic value_missing(Span span, Names const& parameters);
Diagnostic sine_beyond_half_rate(Span span, double frequency, double half_rate);
Diagnostic multisine_beyond_half_rate(Span span, double highest, double half_rate);
Diagnostic multisine_without_harmonic(Span span, double lowest, double highest, double resolution);
/// random: its states are.
Diagnostic prediction_without_lags(Span span, std::string const& model, bool random);
Diagnostic nothing_measured_to_predict_from(Span span, std::string const& model);
Diagnostic other_step(Span span, double given, double declared, std::string const& model);
Diagnostic value_outside_prior(Span value, std::string const& name, Span parameter);
Diagnostic task_too_late(ast::Name const& name);

// candidate models and their selection (E65)
Diagnostic candidate_twice(Span second, Span first, std::string const& model);
/// open: how many of `models` have no probability of their own.
Diagnostic probabilities(ast::Name const& set, double sum, int open, int models);
Diagnostic not_a_probability(Span span, double value);
Diagnostic shared_by_none(ast::Name const& name, std::string const& set, Names const& known);
Diagnostic shared_by_one(ast::Name const& name, std::string const& model);
Diagnostic shared_parameter_differs(ast::Name const& name, Span first, std::string const& one, Span other, std::string const& model,
                                    bool same_unit);
Diagnostic no_candidates(ast::Name const& set);
Diagnostic candidate_without_channel(Span candidate, std::string const& model, Span channel, std::string const& other,
                                     std::string const& name);
Diagnostic channel_of_two_units(Span one, std::string const& model, Unit const& unit, Span other, std::string const& other_model,
                                Unit const& other_unit, std::string const& name);
Diagnostic distance_choice(Span span, std::string const& given, std::string const& channel);
Diagnostic distance_reads(Span span, std::string const& name);
Diagnostic distance_of_one_channel(Span span, Names const& channels, std::string const& example);
Diagnostic distance_may_be_negative(Span span, std::string const& expression);
Diagnostic distance_lacks_channel(Span span, std::string const& channel);
Diagnostic distances_of_two_kinds(Span span, std::string const& one, Unit const& unit, std::string const& other,
                                  Unit const& other_unit);
Diagnostic expressions_of_two_units(Span second, Unit const& unit, Span first, Unit const& first_unit);
Diagnostic no_weight(Span span);
/// own: the kind of task that it is for.
Diagnostic backend_of_other_verb(ast::Name const& name, std::string const& verb, TaskKind own, Names const& known);
Diagnostic arguments_of_candidates(Span span, std::string const& set);
Diagnostic model_and_candidates(ast::Name const& name, Span model);

// dictionaries and discovery (E66)
Diagnostic no_target(ast::Name const& dictionary);
Diagnostic target_twice(Span second, Span first, std::string const& text);
/// derivative: of the target, where that is a state that stands for one; else empty.
Diagnostic target_among_terms(Span target, Span term, std::string const& text, std::string const& written,
                              std::string const& derivative);
Diagnostic no_terms(ast::Name const& dictionary);
Diagnostic nothing_left_of_terms(Span target, std::string const& equation);
/// item: the term that holds the family.
Diagnostic family_inside_term(ast::Name const& family, ast::Expression const& item);
Diagnostic list_of_terms(std::string const& statement, ast::Expression const& list);
Diagnostic unknown_generator(ast::Name const& name, Names const& families);
Diagnostic generator_arguments(ast::Name const& generator, std::string const& missing, std::string const& example);
Diagnostic generator_number(Span span, std::string const& option, int most, std::string const& example);
Diagnostic target_not_linear(Span target, std::string const& text, Names const& parameters);
Diagnostic coefficient_of_two_targets(Span target, std::string const& parameter);
Diagnostic inner_prior(Span prior, std::string const& parameter, std::string const& why);
/// declared: "K [kg]".
Diagnostic inner_scales(Span term, std::string const& text, std::string const& parameter, std::string const& declared);
Diagnostic inner_in_target(Span target, std::string const& text, std::string const& parameter, std::string const& declared);
Diagnostic coefficient_inside(Span term, std::string const& text);
Diagnostic target_of_discrete_time(Span target, std::string const& text, std::string const& state);
Diagnostic present_in_term(Span term, std::string const& text, std::string const& state);
Diagnostic state_without_target(Span state, std::string const& name);
Diagnostic not_in_discrete_time(Span option, std::string const& name, std::string const& dictionary);
Diagnostic state_without_channel(Span state, std::string const& name);
Diagnostic derivative_of_nothing(ast::Name const& state, int primes);
Diagnostic derivative_without_channel(ast::Name const& state, int primes);
Diagnostic channel_bound_twice(ast::Name const& channel, Span first);
Diagnostic excludes_nothing(Span span, std::string const& text, Names const& known);
Diagnostic unit_of_no_term(Span span, std::string const& unit, Names const& possible);
Diagnostic too_many_terms(Span span, std::size_t most);
Diagnostic index_in_dictionary(ast::Reference const& reference);
Diagnostic channel_not_measured(Span data, std::string const& block, Span state, std::string const& channel, Names const& measured);

// several experiments (E63)
Diagnostic constant_of_nothing(Span span, std::string const& name, std::string const& model, Names const& known);
Diagnostic constant_of_shared(Span span, Span declaration, std::string const& parameter);
Diagnostic constant_missing(Span use, Span declaration, std::string const& parameter, std::string const& data);
/// A warning. subject: a model, or candidates.
Diagnostic solver_of_nothing(Span option, std::string const& subject);
/// predicted: what is wrong with it is not that samples count twice, but two results of one name.
Diagnostic experiment_twice(Span second, Span first, std::string const& experiment, bool predicted);
Diagnostic experiments_overlap(Span second, Span first, std::string const& one, std::string const& other);
Diagnostic shared_prior_reads_own(Span prior, std::string const& parameter, std::string const& own);

// Gaussian processes (E32)
Diagnostic not_a_process(ast::Name const& name);
Diagnostic one_covariance(Span span);
Diagnostic not_a_covariance(Span span);
Diagnostic unknown_kernel(ast::Name const& name, Names const& known);
/// given: empty where it is no name.
Diagnostic not_an_input_of_process(Span span, std::string const& given, std::string const& process, Names const& inputs);
Diagnostic kernel_input_twice(Span span, std::string const& input);
Diagnostic kernel_of_one_input(Span span, std::string const& kernel, std::size_t given);
Diagnostic hyper_parameter_count(Span span, std::string const& name, std::size_t given, std::size_t wanted);
/// input: that it belongs to, given in a unit at a place; empty: to none.
Diagnostic hyper_parameter_unit(Span span, std::string const& name, std::string const& input, Unit const& given, Unit const& wanted,
                                Span input_place, std::optional<Unit> const& of_input);
Diagnostic kernels_of_other_units(Span span, Unit const& left, Unit const& right);
Diagnostic hyper_parameter_moves(Span span, std::string const& name, std::string const& what);
Diagnostic hyper_parameter_not_positive(Span span, std::string const& name);
/// names: of the parameters that it reads.
Diagnostic hyper_parameter_never_positive(Span span, std::string const& name, std::string const& process,
                                          std::vector<std::string> const& names);
/// Of `within` and `terms`; inputs: of the process.
Diagnostic expansion_range(Span span, std::size_t inputs);
Diagnostic expansion_range_empty(Span span);
Diagnostic expansion_without_range(Span span);
Diagnostic expansion_condition_outside(Span span, std::string const& input);
Diagnostic expansion_of_number(Span span, std::string const& name);
Diagnostic expansion_beside_process(Span span, std::string const& process, std::string const& expansion);
Diagnostic expansion_by_likelihood(Span span, std::string const& model);
/// parameter: that an amplitude or a length of `function` reads, which has a prior.
Diagnostic expansion_by_optimum(Span span, std::string const& function, std::string const& parameter);
Diagnostic expansion_terms(Span span, std::size_t inputs);
Diagnostic expansion_too_large(Span span, long most);
Diagnostic expansion_too_small(Span span, std::size_t conditions);
/// what: a kernel's name, "a product of kernels".
Diagnostic no_expansion(Span span, std::string const& what);
Diagnostic expansion_of_lags(Span span, std::string const& name);
Diagnostic expansion_unit(Span span, std::string const& name, Unit const& given, Unit const& wanted);
Diagnostic process_in_differential_equation(Span span, std::string const& name);
/// what: "lagged", "the argument of another".
Diagnostic process_out_of_place(Span span, std::string const& what);
Diagnostic process_no_addend(Span span, std::string const& name, std::string const& channel);
Diagnostic process_added_twice(Span span, std::string const& name, std::string const& channel);
Diagnostic process_unobserved(Span span, std::string const& name);
Diagnostic process_with_moving_noise(Span span, std::string const& channel);
Diagnostic process_without_normal_noise(Span span, std::string const& channel, std::string const& noise);
Diagnostic process_applied_twice(Span second, Span first, std::string const& name);
Diagnostic process_of_two_channels(Span span, std::string const& name, std::string const& first, std::string const& second);
Diagnostic process_never_applied(ast::Name const& name);
Diagnostic channel_without_process(Span span, std::string const& channel);
/// verb: "simulated", "selected among".
Diagnostic process_task(Span span, std::string const& verb, std::string const& model);
Diagnostic process_beside_estimated_start(Span span, std::string const& model);
Diagnostic process_of_many_samples(Span span, std::string const& model, int most);
Diagnostic process_beside_constraints(Span span, std::string const& model);
/// rule: "in free run".
Diagnostic process_feeds_back(Span span, std::string const& rule);
Diagnostic condition_moves(Span span, std::string const& name, std::string const& what);
Diagnostic condition_count(Span span, std::string const& name, std::string const& process, std::size_t given, std::size_t wanted);
Diagnostic condition_without_derivative(Span span, std::string const& kernel);
Diagnostic process_of_one_experiment(Span span, std::string const& name, std::string const& parameter);

}  // namespace sysid::errors

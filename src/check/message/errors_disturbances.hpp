// Messages about disturbances, random initial values, filters and errors of inputs (E33).
#pragma once
#include <optional>
#include <string>

#include "check/message/subject.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid::errors {

// disturbances
Diagnostic unknown_law(ast::Call const& law, ast::Name const& name, bool discrete, Names const& known);
/// Of `white(sd = s)`.
Diagnostic sd_of_white_noise(Span argument, std::string const& name);
/// An intensity in the unit of the disturbance itself.
Diagnostic unit_of_intensity(Span argument, std::string const& name, std::string const& given, std::string const& wanted);
/// law: "white"; what: "a state".
Diagnostic law_reads(Span law, std::string const& name, std::string const& what);
/// argument: "intensity"; parameters: that it reads.
Diagnostic law_never_positive(Span declaration, std::string const& name, std::string const& argument, Names const& parameters);
/// A mean that is not 0.
Diagnostic mean_of_disturbance(Span law, std::string const& name);
Diagnostic bounds_of_disturbance(Span law, std::string const& name);
Diagnostic rate_of_disturbance(ast::Reference const& reference);
/// reader: "channel `a`", "`power`".
Diagnostic white_noise_observed(Span reader, Subject const& what, Span declaration, std::string const& disturbance);
/// part: where it stands, if it has a place.
Diagnostic not_linear_in_disturbance(Span declaration, std::string const& disturbance, std::optional<Span> const& part);
Diagnostic unused_disturbance(Span declaration, std::string const& disturbance);
/// other: "a Gaussian process".
Diagnostic disturbance_beside(Span place, Subject const& disturbance, Subject const& other, std::string const& help);

// random initial values
Diagnostic law_of_initial(ast::Call const& law, std::string const& state);
Diagnostic bounds_of_initial(ast::Call const& law, std::string const& state);
Diagnostic random_guess(Span initial, std::string const& unknown);
Diagnostic estimated_and_random_start(Span option, Span initial, std::string const& state);

// filters
Diagnostic filter_of_nothing(Span option, std::string const& model);
/// part: what is not linear, if it has a place.
Diagnostic kalman_of_nonlinear(Span option, std::string const& model, std::optional<Span> const& part);
/// help: what else the fit may do.
Diagnostic noise_of_filter(Span channel, std::string const& name, std::string const& noise, Span task, std::string const& help);
/// Where a likelihood that particles estimate will not do. what: that takes none.
Diagnostic likelihood_by_particles(Span place, Subject const& what, std::string const& help);
Diagnostic particles_of_other_filter(Span option, std::string const& filter);
/// `prediction = steps(10)` of a model whose states are known; of several models at once.
Diagnostic steps_ahead_of_known(Span option, std::string const& model);
Diagnostic steps_ahead_of_several(Span option);

// errors of inputs
Diagnostic law_of_input_error(Span law, std::string const& input, std::string const& reason);
Diagnostic input_error_refused(Span error, std::string const& input, Subject const& reason, std::optional<Label> const& place,
                               std::string const& help);
Diagnostic input_errors_differ(Span second, Span first, std::string const& input, std::string const& one, std::string const& other);

}  // namespace sysid::errors

// The noise statement of a channel, as a user would change it.
#pragma once
#include <optional>
#include <string>

#include "core/text/source.hpp"
#include "diagnostics/residuals/user_text.hpp"
#include "model/model.hpp"

namespace sysid {

/// `observe displacement ~ normal(y + displacement_offset, sd = sigma)`: the statement of `channel` with `sum` added to what
/// the noise lies about. Nothing where it is not in the text itself, but in a module.
std::optional<std::string> noise_statement_with(Source const& source, Channel const& channel, std::string const& sum);

/// `t` of `time t [s]` in the model of `channel`; where it has no such statement, a name that does not stand in it.
TimeName time_name(Source const& source, Channel const& channel);

/// `observe displacement ~ student_t(y, 4, scale = sigma)`: the same with heavy tails, of a channel with `normal(y, sd = sigma)`,
/// or with a variance or precision. Nothing where it is written otherwise, stands in a module, or has a number without unit that
/// would get another unit.
std::optional<std::string> heavy_tailed_statement(Source const& source, Channel const& channel);

/// `observe displacement ~ normal(y, sd = sqrt(sigma^2 + (relative*y)^2))`: the same with a part of the noise that is proportional
/// to what it lies about.
std::optional<std::string> proportional_statement(Source const& source, Channel const& channel, std::string const& relative);

/// `observe cases ~ negative_binomial(rate, shape = cases_shape)`: the same of a channel with `poisson(rate)`.
std::optional<std::string> overdispersed_statement(Source const& source, Channel const& channel, std::string const& shape);

}  // namespace sysid

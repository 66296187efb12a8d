// Signals that `simulate` makes for an input: `gaussian(sd = 10)`, `multisine(sd = 1, lowest = 1, highest = 50)`.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "check/checked/checked.hpp"
#include "check/expression/option_reader.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The value of `input NAME = ...`, numbers in the unit of the input; nothing when a diagnostic was added.
std::optional<InputGenerator> check_generator(ast::Option const& option, Quantity const& input, OptionReader& reader,
                                              Diagnostics& diagnostics);

/// Names of the signals, and of the arguments of one; empty for what is none.
std::vector<std::string> signal_names();
std::vector<std::string> signal_arguments(std::string_view signal);

/// A multisine has a harmonic k/(samples*step) in its band, and neither it nor a sine reaches half the rate.
void check_band(InputGenerator const& generator, SimulateTask const& task, Span place, Diagnostics& diagnostics);

}  // namespace sysid

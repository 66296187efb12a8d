// Rows of a record as an experiment.
#pragma once
#include <optional>
#include <string>

#include "data/experiment.hpp"
#include "data/record.hpp"

namespace sysid {

/// What is wrong with asking for these rows, or nothing. what: "range `train`", for the message.
std::optional<Diagnostic> check_rows(Record const& record, std::string const& what, RowRange rows,
                                     std::optional<Span> mention = std::nullopt);

/// Rows simulate_from..scored.last, of which `scored` count in the likelihood. simulate_from is 1 where simulation runs from the
/// record's first row, scored.first for a start at rest, less than that where a start is estimated. Inputs keep the shape that the
/// whole record gives them; times are those of the record. UserError when the rows are not in the record; simulate_from is
/// in 1..scored.first. E4013 where an input has no value in a row that is simulated, among the `earlier` rows before them, or where
/// its rule reads around them.
Experiment make_experiment(Record const& record, std::string name, int simulate_from, RowRange scored,
                           std::optional<Span> mention = std::nullopt, int earlier = 0);

}  // namespace sysid

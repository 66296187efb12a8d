// A second search of a short record: from its first rows, as long records are searched, where the best mode leaves motion in it.
#pragma once
#include <optional>
#include <vector>

#include "likelihood/target.hpp"
#include "result/mode.hpp"
#include "search/global/growing_search.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Whether the residuals at a mode are correlated by more than 0.3, with either sign, from one sample to the next, as those of a
/// wrong model or of a wrong period are. Of residuals above 30 medians nothing is taken: rows that carry a scale, and outliers.
bool leaves_motion(Target const& target, Mode const& mode);

/// The modes of a search on growing records with a solver that is refined twice, where `modes` of a search of the whole record
/// leave motion in it and the best of the new ones is 3 nats higher than the best of these with the finer solver. They are those
/// of `target` where the finer solver leads from these to the same place, else of the finer one. Nothing where no other mode is
/// found, the record is not to be cut or has no order in time, or the context asks to stop.
std::optional<GrownModes> second_look(Target const& target, ObjectiveKind objective_kind, ShorterRecords const& records,
                                      RunContext& context, std::vector<Mode> const& modes);

}  // namespace sysid

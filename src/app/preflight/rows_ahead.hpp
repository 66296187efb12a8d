// How much of a long record a look ahead is made along.
#pragma once
#include <cstddef>

#include "data/experiment.hpp"

namespace sysid {

/// The first rows of an experiment, until `most` of them have a sample that is scored, and every channel that has any has some: a
/// tenth of `most`, or as many as there are in `most` rows. A sensor may be switched on late, alone or beside others. Where samples
/// are few, ten times `most` rows behind the first one of the last channel end it too.
int rows_ahead(Experiment const& experiment, std::size_t most);

}  // namespace sysid

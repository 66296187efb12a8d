// `sysid data`: what a record looks like, for a person, for a program, and as a picture.
#pragma once
#include <string>

#include "data/look/record_look.hpp"
#include "report/figure/plot.hpp"

namespace sysid {

std::string record_text(RecordLook const& look);
std::string record_json(RecordLook const& look);
/// Columns over time, the first eight; of a long record the range in stretches.
plot::Figure record_figure(RecordLook const& look);

}  // namespace sysid

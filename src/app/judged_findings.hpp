// What a judgement by simulation has to say of itself.
#pragma once
#include "inference/finding.hpp"
#include "report/judged.hpp"

namespace sysid {

/// judged: with at least one structure.
Findings judged_findings(JudgedReport const& judged);

}  // namespace sysid

// The concerns of a discovery as findings: which code, which severity, what to do.
#pragma once
#include "regression/column/concern.hpp"
#include "result/finding.hpp"

namespace sysid {

/// equation: named where there are several, else empty. names: the terms or the channel of the concern.
Finding finding_of(regression::Concern const& concern, std::string const& equation, std::vector<std::string> names);

}  // namespace sysid

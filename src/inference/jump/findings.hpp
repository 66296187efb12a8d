// The findings of a reversible-jump run about itself.
#pragma once
#include "inference/backend/selector.hpp"

namespace sysid::jump {

/// Models that no chain visited, jumps that are hardly accepted, chains that disagree, and probabilities that are not precise.
/// excluded: per model, why it took no part; empty: it did.
Findings check_jumps(SelectionResult const& result, std::vector<std::string> const& excluded);

}  // namespace sysid::jump

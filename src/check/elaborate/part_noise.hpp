// The noise of a model that is used as a part of another: parameters that only this noise uses are removed.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// Leaves out of a flat model what serves the noise of its parts alone, over definitions and priors. What the whole declares itself
/// stays. noise: the names that `observe` of parts reads, with their paths, vectors as wholes.
void drop_noise_of_parts(std::vector<ast::ModelStatement>& statements, std::set<std::string> noise);

}  // namespace sysid

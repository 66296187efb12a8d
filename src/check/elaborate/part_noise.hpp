// The noise of a model that became a part of another: a model's own noise is no part of a whole.
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

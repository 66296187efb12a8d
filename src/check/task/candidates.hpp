// A set of candidate models: which they are, what each is worth before any data, and what they share.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The set, or nothing when a diagnostic was added or one of its models failed its own check. models: index by name of those of
/// `file`, absent for those that failed. Candidates without a probability share equally what the others leave.
std::optional<CandidateSet> check_candidates(ast::Candidates const& tree, std::map<std::string, std::optional<int>> const& models,
                                             CheckedFile const& file, Diagnostics& diagnostics);

}  // namespace sysid

// The distance of a selection: the rule, the weight of each channel, and expressions of the user's own.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "check/expression/option_reader.hpp"

namespace sysid {

/// What is said of the distance, absent where it is not.
struct DistanceOptions {
  ast::Option const* distance = nullptr;  // `distance = nmse`
  ast::Option const* weights = nullptr;   // `weights(displacement = 1)`
};

/// The rule for the candidates of `set` over these channels, which all candidates observe. An expression reads one channel each and
/// no name of a model, so that it means the same in all; its nodes are added to the graphs of the models of `file`. Of no use where
/// a diagnostic was added.
DistanceRule check_distance(DistanceOptions const& options, std::vector<std::string> channels, CandidateSet const& set,
                            CheckedFile& file, OptionReader& reader, Diagnostics& diagnostics);

}  // namespace sysid

// An unknown function of an equation as a file.
#pragma once
#include <string>

namespace sysid {

struct FunctionReport;

/// What the file function_NAME.csv holds: a column for each input, then mean, sd, q5, q95; units in a comment.
std::string function_csv(FunctionReport const& function);

}  // namespace sysid

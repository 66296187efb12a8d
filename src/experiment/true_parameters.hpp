// The values that made data were made with.
#pragma once
#include <string>
#include <vector>

#include "data/experiment.hpp"
#include "model/model.hpp"
#include "result/report.hpp"

namespace sysid {

/// What the head of a file that `simulate` wrote says of the parameters of a model, `# k = 18.6 [N/mm]`: in the parameter's
/// declared unit and under its name in a fit ("k[first]" where every experiment has its own). Nothing of other files, of other
/// names, and of numbers whose unit is of another dimension.
std::vector<TrueValue> true_values(std::vector<std::string> const& comments, Model const& model, std::string const& experiment);

}  // namespace sysid

// The parameters of a model that are not estimated, with the values that a file gives them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "result/fixed_value.hpp"

namespace sysid {

/// Of the model of this name in a text: `parameter m [kg] = 3.2`, and for each of the data blocks a value `per experiment`, the
/// block's own where it has one. Empty where the text has no such model.
std::vector<FixedValue> fixed_values(std::string_view text, std::string_view model, std::vector<std::string> const& data);

}  // namespace sysid

// The parameters of a model that are not estimated, with the values that a file gives them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct FixedValue {
  std::string name, value, unit;  // "added[bench]", "500", "g"
};

/// Of the model of this name in a text: `parameter m [kg] = 3.2`, and for each of the data blocks a value `per experiment`, the
/// block's own where it has one. Empty where the text has no such model.
std::vector<FixedValue> fixed_values(std::string_view text, std::string_view model, std::vector<std::string> const& data);

}  // namespace sysid

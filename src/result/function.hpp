// An unknown function of an equation, as it was found.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace sysid {

/// The function at one place over the draws, declared units.
struct FunctionPoint {
  std::vector<double> inputs;  // [D]
  double mean, sd, q5, q95;

  void set_normal(double normal_mean, double normal_sd);
};

struct FunctionReport {
  std::string name, unit;
  std::vector<std::pair<std::string, std::string>> inputs;  // name and unit
  std::vector<FunctionPoint> grid;               // over its range, the last input's fastest; of a process at samples its cuts
  std::vector<std::vector<FunctionPoint>> cuts;  // along each input, the others in the middle of what is known of them
  std::vector<std::vector<double>> visits;  // of each input: how many scored samples read each of so many equal parts of its range
};

}  // namespace sysid

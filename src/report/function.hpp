// An unknown function of an equation, as it was found: a table and a figure of it.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace sysid {

namespace plot {
struct Figure;
}

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

/// What the file function_NAME.csv holds: a column for each input, then mean, sd, q5, q95; units in a comment.
std::string function_csv(FunctionReport const& function);
/// One panel for each cut: mean and 90 % band, and along the bottom how often the record reads the function there.
plot::Figure function_figure(FunctionReport const& function);

}  // namespace sysid

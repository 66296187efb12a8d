// Functions of the states that equations of the literature have, and a dictionary may lack.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace sysid {

/// The names of the states, whether they are plain numbers, and their values [rows x states].
struct StateValues {
  std::vector<std::string> names;
  std::vector<char> plain;  // no unit: a function may be taken of it
  Eigen::MatrixXd values;
};

struct OutsideFunction {
  std::string text;
  double simplicity = 1;   // as `simplicity` (structure_prior.hpp) has it
  Eigen::VectorXd values;  // [rows]
};

/// The constant, powers up to the fifth, signs, products, and of plain states sin, cos, exp, logarithms, roots, saturations, and
/// these times another state; those that are finite in all rows, and no multiple of one of `known` [rows x terms].
std::vector<OutsideFunction> outside_functions(StateValues const& states, Eigen::MatrixXd const& known);

}  // namespace sysid

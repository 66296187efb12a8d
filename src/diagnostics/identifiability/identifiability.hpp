// What outputs can and cannot tell about parameters, from their slopes at several points: directions that change nothing,
// recognised as what they are to a person, and how far the data will narrow the rest.
#pragma once
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "diagnostics/identifiability/sensitivity.hpp"

namespace sysid {

/// The neighbourhood of one draw of the prior.
struct LocalSlopes {
  Sensitivity sensitivity;  // per unit of parameter / scale
  Eigen::VectorXd value;    // [P] SI
  Eigen::VectorXd scale;    // [P] > 0, SI
  Eigen::VectorXd spread;   // [P] > 0: prior sd there, in units of scale
};

/// A move of parameters that leaves the outputs as they are, to first order.
struct NullDirection {
  enum class Kind {
    no_influence,  // one parameter
    scaling,       // parameter p times s^coefficient: the same exponents at every draw
    sum,           // parameter p plus coefficient t (SI): the same at every draw
    general,       // differs from draw to draw; coefficients are changes in prior sds at the first draw, the largest is 1
  };
  struct Part {
    int parameter;
    double coefficient;
    double natural;  // the change in SI at the first draw, of the same move
  };
  Kind kind;
  std::vector<Part> parts;
};

struct NullSpace {
  int draws = 0;                // that could be judged
  std::vector<int> dimensions;  // of the null space, at each
  std::vector<NullDirection> directions;
};

/// At each draw columns are scaled to length 1 (what has no length has no influence), and singular values below a floor count as
/// zero. By Weyl's inequality no singular value moves by more than the Frobenius norm of the error of the matrix: that, twice, is
/// the floor. A draw whose floor is above 1e-2 cannot be judged and is left out. As many directions are named as are null at every
/// draw: first those that are the same for all in the logarithms of the parameters, then in the parameters themselves, then the
/// rest.
NullSpace find_null_space(std::span<LocalSlopes const> draws);

/// What a posterior is expected to know, were the truth at the draw: the Laplace approximation (J^T J + prior precision)^-1, the
/// prior taken as normal with its sd.
struct Expectation {
  Eigen::VectorXd shrinkage;    // [P] posterior sd / prior sd, 0 to 1
  Eigen::MatrixXd correlation;  // [P x P]
};
Expectation expect(LocalSlopes const& draw);

/// "scaling m, c and k together leaves displacement unchanged", "only the sum k + A is determined", ...: one sentence in plain
/// words, lower case, no full stop. names, units: of the parameters; per_si: SI value of one declared unit; output: "displacement".
struct ParameterWords {
  std::string name, unit;
  double scale = 1;  // SI per declared unit
};
std::string direction_words(NullDirection const& direction, std::span<ParameterWords const> parameters, std::string const& output,
                            bool driven = true);

/// "k + A", "k - 2 A", "m*c^2": what two confounded parameters leave determined.
std::string determined_combination(NullDirection const& direction, std::span<ParameterWords const> parameters);

}  // namespace sysid

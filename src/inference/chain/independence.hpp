// Independence proposals: points drawn from a fixed mixture around the modes of a density, wherever a chain stands.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"

namespace sysid::metropolis {

/// q(x) = sum over components of  weight (3/4 N(x; mean, S) + 1/4 t_6(x; mean, S)),  S = L L', over the sampler's coordinates.
/// Student's t keeps the weights p / q bounded where the tails of p are somewhat heavier than normal (Tierney 1994, sec. 2.3.3);
/// the normal part is what most posteriors near a mode are. In many dimensions the t alone would nearly never be accepted.
class Independence {
 public:
  struct Component {
    double weight = 1;           // > 0; they need not sum to 1
    Eigen::VectorXd mean;        // [P]
    Eigen::MatrixXd covariance;  // [P x P]
  };

  /// Proposes nothing.
  Independence() = default;
  /// Of a covariance that is not positive definite only the diagonal is used.
  explicit Independence(std::vector<Component> const& components);

  bool empty() const { return parts_.empty(); }
  /// Writes a draw into column `lane` of `to` [P x W].
  void draw(StreamKey key, Lanes to, int lane) const;
  /// log q of a column, all constants kept; -infinity when empty.
  double log_density(ConstLanes theta, int lane) const;
  /// The component that most likely drew a column; -1 when empty.
  int nearest(ConstLanes theta, int lane) const;

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch where it is not of dimension P.
  static Independence restore(nlohmann::json const& stored, int dimension);

 private:
  struct Part {
    double cumulative = 0;  // of the weights up to and with this one, of 1
    double log_normal = 0;  // log of weight times the constants of the normal part, and of the t part
    double log_student = 0;
    std::vector<double> mean;    // [P]
    std::vector<double> factor;  // L, lower triangle of [P x P] by rows
  };
  /// log of weight times density.
  double log_part(Part const& part, ConstLanes theta, int lane) const;
  void set_constants(std::vector<double> const& weights);

  std::size_t dimension_ = 0;
  std::vector<Part> parts_;
};

}  // namespace sysid::metropolis

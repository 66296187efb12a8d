// Independence proposals: points drawn from a fixed mixture around the modes of a density, wherever a chain stands.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"

namespace sysid::metropolis {

/// q(x) = sum over components of  weight (0.65 N(x) + 0.25 mean over j of N(x) t_3(z_j) / N(z_j) + 0.1 t_6(x)),  N and t_6 with the
/// component's mean and covariance S = L L', z_j = (x_j - mean_j) / sd_j. x are the sampler's coordinates, or the declared values.
///
/// The normal part is what most posteriors near a mode are. Student's t keeps the weights p / q bounded where the tails of p are
/// heavier (Tierney 1994, sec. 2.3.3): in the middle part those of one coordinate, with the others as they follow from it; in the
/// last those in all directions, which in many dimensions are nearly never drawn.
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
  explicit Independence(std::vector<Component> const& components, bool declared = false);

  /// Whether x are declared values.
  bool declared() const { return declared_; }
  bool empty() const { return parts_.empty(); }
  /// P.
  int dimension() const { return static_cast<int>(dimension_); }
  /// Writes a draw into each column of `to` [P x W]; keys [W]: of its numbers.
  void draw(std::span<StreamKey const> keys, Lanes to) const;
  void draw(StreamKey key, Lanes to, int lane) const { draw({&key, 1}, to.columns(lane, 1)); }
  /// log q of each column, all constants kept; -infinity when empty. out: [W].
  void log_density(ConstLanes theta, std::span<double> out) const;
  double log_density(ConstLanes theta, int lane) const;
  /// Writes an autoregressive move from column `chain` of `from` about the normal parts of the components, their mixture n, into
  /// column `lane` of `to`; returns |L^-1 (x' - x)|^2:
  ///
  ///   k with probability  weight_k N_k(x) / n(x);   x' = mean_k + sqrt(1 - step^2) (x - mean_k) + step L_k z,   z ~ N(0, I)
  ///
  /// Each N_k is stationary under its moves and these are reversible, so x' is accepted with min(1, p(x') n(x) / (p(x) n(x'))):
  /// how often depends on how far p / n is from constant, not on the dimension. Step 1 is a draw of N_k.
  ///                                          Neal 1998, Cotter, Roberts, Stuart and White 2013 (preconditioned Crank-Nicolson)
  double move_about(Stream& stream, double step, ConstLanes from, int chain, Lanes to, int lane) const;
  /// log n of a column, all constants kept; -infinity when empty.
  double log_normal_density(ConstLanes theta, int lane) const;
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
    std::vector<double> sd;      // [P]
  };
  struct Planned;
  Planned plan(StreamKey key, int lane) const;
  /// Writes a draw into its column; normals: a column of as many as it takes.
  void place(Planned const& draw, ConstLanes normals, Lanes to) const;
  /// Adds what the others move by when coordinate j moves by `sds`: x += S e_j / sd_j sds.
  void shift(Part const& part, std::size_t j, double sds, Lanes to, int lane) const;
  /// log of weight times density of each column. out: [W].
  void log_part(Part const& part, ConstLanes theta, std::span<double> out) const;
  /// The component up to which weights times normal densities at a column sum to a share of all.
  Part const& part_at(double share, ConstLanes theta, int lane) const;
  /// z = L^-1 (x - mean) [P] of a column; returns |z|^2.
  double whiten(Part const& part, ConstLanes theta, int lane, std::span<double> z) const;
  /// log of weight times normal density; -infinity where that is not finite. z [P] as above.
  double log_normal(Part const& part, ConstLanes theta, int lane, std::span<double> z) const;
  void set_constants(std::vector<double> const& weights);
  static void set_sds(Part& part);

  std::size_t dimension_ = 0;
  bool declared_ = false;
  std::vector<Part> parts_;
};

}  // namespace sysid::metropolis

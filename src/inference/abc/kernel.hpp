// Perturbation kernels of ABC-SMC: how a particle of the last population moves, and with what density a place is reached.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <string_view>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "inference/abc/plan.hpp"

namespace sysid::abc {

/// Width of a population of one model: its weighted covariance [D x D] and its range [D], in the coordinates of the walk.
struct Width {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd range;
};

/// Of particles at [D x n] with weights that sum to 1. A population that is too small or too flat to tell (fewer than D + 2
/// particles, a range of nothing, a covariance that cannot be factorised) keeps `last`.
Width width_of(ConstLanes at, std::span<double const> weight, Width const& last);

class Kernel {
 public:
  virtual ~Kernel() = default;
  /// Draws from K(. | centre), one for each of the centres' numbers [W], with the numbers of a stream each [W]. out: [D x W].
  virtual void perturb(std::span<int const> centres, std::span<Stream> streams, Lanes out) const = 0;
  /// log sum_j w_j K(x | centre_j) for x [D x W]. out: [W].
  virtual void log_density(ConstLanes x, std::span<double> out) const = 0;
};

/// Around centres at [D x n] with weights [n] that sum to 1; both must outlive the kernel.
///   gaussian             normal, covariance scale * that of the population                          Filippi et al. 2013, eq. 9
///   component_gaussian   the same, its diagonal alone
///   uniform              a box of widths scale * range, the centre in its middle                    the tutorial, Sec. 8.5
///   nearest_neighbours   normal, covariance scale * that of the centre's nearest neighbours about it   Filippi et al. 2013,
///   Sec. 3.2
struct KernelRow {
  std::string_view name;
  /// Unless `kernel_scale` is given. Twice the weighted covariance is the optimum of Filippi et al. 2013 for a population that
  /// changes slowly.
  double scale;
  std::unique_ptr<Kernel> (*make)(Plan const&, ConstLanes at, std::span<double const> weight, Width const&);
};

std::span<KernelRow const> kernels();
KernelRow const* find_kernel(std::string_view name);

}  // namespace sysid::abc

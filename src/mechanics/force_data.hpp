// The force of a link from measured samples, and from the model.
#pragma once
#include <optional>
#include <vector>

#include "mechanics/coupling.hpp"
#include "mechanics/measured_motion.hpp"
#include "result/restoring_force.hpp"

namespace sysid {

/// The force of a link by the model, SI: it pulls back, so that a spring's has the sign of its elongation.
class ForceModel {
 public:
  ForceModel(Accelerations const& accelerations, Link const& link) : accelerations_(accelerations), link_(link) {}

  Link const& link() const { return link_; }
  std::vector<Mass> const& masses() const { return accelerations_.masses(); }
  /// What pushes a mass that the link holds.
  std::optional<std::size_t> input_of_held(std::size_t k) const;
  /// Of places alone; only where there is a surface.
  double force(double elongation, double speed) const;
  /// Along the scored rows.
  RestoringForce::Path along(std::vector<std::vector<double>> const& states, Experiment const& experiment) const;
  /// At one row.
  double elongation(std::vector<double> const& states) const;
  double speed(std::vector<double> const& states) const;
  double force(std::vector<double> const& states) const;
  /// Whether the force reads its elongation and speed alone.
  bool has_surface() const { return coupled() || !mass().remembers; }
  /// What the inertia of all masses that the link holds and their inputs leave for it: sum m_k (g_k x - q_k'' + a_k(0)), the last
  /// where masses are coupled. accelerations, inputs: in the order of `link().held`.
  double balance(std::vector<double> const& accelerations, std::vector<double> const& inputs) const;

 private:
  Mass const& mass() const { return masses()[link_.mass]; }
  bool coupled() const { return !mass().neighbours.empty(); }
  double difference(std::vector<double> const& states, std::size_t Mass::*of) const;

  Accelerations const& accelerations_;
  Link const& link_;
};

/// Adds the force of the data, from accelerometers where all masses that the link holds have one, else from their displacements at
/// the least smoothing that leaves a tenth of the force's spread as noise, where that does not bend it. motions: of all masses.
void add_data(ForceModel const& link, std::vector<MeasuredMotion> const& motions, std::vector<std::vector<double>> const& states,
              Experiment const& experiment, RestoringForce& out);

}  // namespace sysid

// The masses of a model, read off its first-order system: states q with q'' = a(q, q', ..., x).
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "model/model.hpp"

namespace sysid {

/// A state whose derivative is a state, too.
struct Mass {
  std::size_t displacement, velocity;  // states
  NodeId acceleration = 0;
  NodeId at_rest = 0;                   // acceleration without the input
  NodeId gain = 0;                      // d acceleration / d input
  std::optional<std::size_t> input;     // what pushes it
  std::vector<std::size_t> neighbours;  // other masses whose states it reads
  bool remembers = false;               // it reads other states, as of a hysteresis
  bool readable = true;                 // of neither time nor data, affine in one input at most with a factor of parameters alone
};

/// Of a continuous model, in the order of its states; of others none. Derivatives are added to the graph.
std::vector<Mass> masses(Model const& model, Graph& graph);

/// The accelerations at one vector of parameters, SI.
class Accelerations {
 public:
  /// parameters: of the model [parameters x draws]; NaN where the model fixes them.
  Accelerations(Model const& model, Graph const& graph, std::vector<Mass> const& masses, ConstLanes parameters, int draw);

  /// The value of a node at states and inputs of the model.
  double value(NodeId node, std::vector<double> const& states, std::vector<double> const& inputs = {}) const;
  /// The acceleration of mass i that its link to `other`, to the ground where there is none, gives it alone: with all other links
  /// at rest.
  double by_link(std::size_t i, std::optional<std::size_t> other, double elongation, double speed) const;
  /// Acceleration per input of a mass; 0 without one.
  double gain(std::size_t i) const;

  std::vector<Mass> const& masses() const { return masses_; }
  /// States of which all are 0.
  std::vector<double> const& rest() const { return rest_; }

 private:
  Graph const& graph_;
  std::vector<Mass> const& masses_;
  std::vector<double> parameters_;
  std::vector<double> rest_;  // states
};

}  // namespace sysid

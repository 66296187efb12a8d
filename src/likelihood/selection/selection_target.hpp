// What a back end that selects among models sees of them: for each a prior that can be drawn from, and how far a simulation without
// noise lies from the data. Nothing of the language passes.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "likelihood/target.hpp"

namespace sysid {

/// How the simulation of one lane ended.
enum class Simulated : std::uint8_t {
  within,  // its distance is known and within the bound
  beyond,  // its distance is above the bound; it may have been given up before its end
  failed,  // it did not stay finite
};

/// Several models of the same data. All members may be called concurrently; lane w of a result depends on column w alone.
class SelectionTarget {
 public:
  virtual ~SelectionTarget() = default;
  virtual int size() const = 0;
  virtual std::string const& name(int model) const = 0;
  /// Prior probability; they sum to 1.
  virtual double prior_probability(int model) const = 0;
  /// The parameters that the simulation reads, in the order of the rows of theta; D of them.
  virtual std::span<ParameterInfo const> parameters(int model) const = 0;
  int dimension(int model) const { return static_cast<int>(parameters(model).size()); }

  // As Target describes them; theta [D x W] unconstrained, declared [D x W] in declared units.
  virtual void sample_prior(int model, StreamKey key, Lanes theta) const = 0;
  virtual void log_prior(int model, ConstLanes theta, std::span<double> out, bool jacobian) const = 0;
  virtual void constrain(int model, ConstLanes theta, Lanes declared) const = 0;
  virtual void unconstrain(int model, ConstLanes declared, Lanes theta) const = 0;

  /// Parameter vectors of one model, and where what becomes of them goes. distance: [W], infinite unless within.
  struct Batch {
    int model = 0;
    ConstLanes theta;
    std::span<double> distance;
    std::span<Simulated> ending;
  };
  /// Simulates all batches side by side; a lane is given up as soon as its distance must exceed `bound`.
  virtual void distances(std::span<Batch const> batches, double bound) const = 0;
  /// Where the simulation of a failed theta [D x 1] goes wrong, in the user's words, and when [s].
  virtual std::pair<std::string, double> failure(int model, ConstLanes theta) const = 0;
  /// task(0) ... task(tasks - 1) on the set's threads.
  virtual void parallel(int tasks, std::function<void(int)> const& task) const = 0;
};

}  // namespace sysid

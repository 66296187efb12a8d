// The parameters of a fit to one or several experiments: shared ones once, those declared `per experiment` once for each, with the
// joint prior over all of them; and which of them each experiment's simulations read.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "likelihood/improper_reference.hpp"
#include "likelihood/member_coordinate.hpp"
#include "likelihood/target.hpp"
#include "model/model.hpp"
#include "program/kernel.hpp"

namespace sysid {

/// An experiment as parameters see it.
struct ExperimentMember {
  std::string name;                              // the index of its own parameters; empty: they go by their plain names
  std::vector<std::optional<double>> constants;  // per model parameter, SI: what the data block fixes; empty: nothing
};

/// A row of the space. Sampled unless it has a value.
struct FittedParameter : Quantity {
  int parameter = 0;            // of the model
  int experiment = -1;          // -1: shared
  std::optional<double> value;  // SI, fixed
};

/// The name of one experiment's own: "k" in "bench" is "k[bench]", an element "k[2]" is "k[2,bench]".
std::string member_name(std::string const& name, std::string const& experiment);

/// Whether an expression of the model reads a parameter that every experiment has for itself.
bool reads_own_parameters(Model const& model, NodeId root);
/// Whether it reads a parameter that has a prior.
bool reads_estimated(Model const& model, NodeId root);

/// normal(0, sd = 1) in every experiment: z of a hierarchy that is written as `mean + spread*z`. The data know the sums alone, and
/// the priors of z how they divide.
bool is_standardised(Model const& model, Parameter const& parameter);

/// Immutable. Rows are in the user's order, a per-experiment parameter taking one row per experiment in its place, in the order of
/// the experiments. Coordinates u [D] are those of the sampled rows; `declared` [D] their values in declared units; `values` [rows]
/// all of them in SI.
class ParameterSpace {
 public:
  /// A per-experiment parameter without prior and value must be among the constants of every experiment (the checker has seen to
  /// it); where it is not, as when a model is only looked at, it is NaN. standardised: members of hierarchies, by rising
  /// coordinate, that have coordinates of their own; others are moved on the unbounded scale of their prior.
  ParameterSpace(Model model, std::vector<ExperimentMember> experiments, std::vector<MemberCoordinate> standardised = {});

  Model const& model() const { return model_; }
  std::vector<ExperimentMember> const& experiments() const { return experiments_; }
  std::vector<FittedParameter> const& rows() const { return rows_; }
  /// The rows of the coordinates; size D.
  std::vector<int> const& sampled() const { return sampled_; }
  int dimension() const { return static_cast<int>(sampled_.size()); }
  std::span<ParameterInfo const> infos() const { return infos_; }
  /// The row that an experiment reads for a parameter of the model.
  int row(int experiment, int parameter) const {
    return row_of_[static_cast<std::size_t>(experiment)][static_cast<std::size_t>(parameter)];
  }
  /// The coordinates that the value of a row reads, ascending: its own, and those of the parameters that its bounds read; none of a
  /// fixed row.
  std::vector<int> const& coordinates_of(int row) const { return coordinates_of_[static_cast<std::size_t>(row)]; }

  /// A sampled row whose prior is moved and widened by sampled ones, the width at least.
  struct Member {
    int coordinate;
    std::vector<int> population;  // coordinates that its prior's scale reads
  };
  std::vector<Member> const& members() const { return members_; }
  /// The scales of their priors [members x W] at theta [D x W], on the unbounded scale of each, SI.
  void member_scales(ConstLanes theta, Lanes out) const;
  std::vector<MemberCoordinate> const& standardised() const { return standardised_; }

  /// Of the value of a row, SI, by a coordinate.
  struct Slope {
    int row, coordinate;
  };
  /// Those that are not zero, by row and coordinate.
  std::vector<Slope> const& slopes() const { return slopes_; }
  /// Their values [slopes x W] at theta [D x W].
  void slopes(ConstLanes theta, Lanes out) const;

  // As Target describes them; theta [D x W].
  void sample_prior(StreamKey key, Lanes theta) const;
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const;
  /// log prior [W] on R^D and its gradient [D x W], to rounding; false where a prior has a function whose derivative is not known,
  /// and nothing is written.
  bool log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient) const;
  void constrain(ConstLanes theta, Lanes declared) const;
  void unconstrain(ConstLanes declared, Lanes theta) const;

  /// values [rows x W], SI, of theta [D x W] or of declared values [D x W].
  LaneArray values(ConstLanes theta) const;
  LaneArray values_of_declared(ConstLanes declared) const;
  /// From values [rows x W] the parameters of the model [parameters x W], SI, as one experiment has them.
  void select(ConstLanes values, int experiment, Lanes parameters) const;

  /// Parameters of the model [parameters x W], SI, for an experiment that is none of these: shared ones as declared [D x W], its
  /// own as its constants say or drawn from their prior given the shared ones, lane w by stream key.with_index(key.index + w).
  /// UserError where the prior is impossible.
  LaneArray of_new_experiment(ConstLanes declared, std::span<std::optional<double> const> constants, StreamKey key) const;

  /// The same with something in place of draws for each coordinate whose prior is improper. Without it `sample_prior` throws
  /// UserError (E2114) where one is.
  ParameterSpace with_references(std::vector<ImproperReference> references) const;
  std::vector<ImproperReference> const& references() const { return references_; }
  /// log density [W] on R^D of what `sample_prior` draws, which is the prior where all of it is proper.
  void log_reference(ConstLanes theta, std::span<double> out) const;

  /// What `--dump program` prints.
  std::string dump() const;

 private:
  void lay_out();
  struct Compilation;
  Compilation begin_compilation() const;
  void compile();
  void add_row(int row, Compilation& all);
  void add_inverse(int row, Distribution const& use, NodeId log_jacobian, Compilation& all);
  ImproperReference const* reference_of(int row) const;
  MemberCoordinate const* standardised(int coordinate) const;
  /// A value between its bounds, expressions of the rows that they read.
  struct Constrained {
    int row, coordinate;
    Support bounds;
    NodeId log_jacobian;
    MemberCoordinate const* member;  // null: moved on the unbounded scale
    std::optional<LocationScale> population;
  };
  /// constrained: in the order in which they read one another. value: of the rows, from the coordinates.
  void compile_slopes(Graph& graph, std::span<Constrained const> constrained, std::span<NodeId const> coordinates,
                      std::span<NodeId const> value);
  /// Draws the model parameters `order` of one lane, reading and writing parameter p at values(place(p), lane). by_reference:
  /// places are rows, and references stand for improper priors.
  template <class Place>
  void draw(std::span<int const> order, Place const& place, bool by_reference, Lanes values, int lane, Stream& stream) const;

  Model model_;
  std::vector<ExperimentMember> experiments_;
  std::vector<FittedParameter> rows_;
  std::vector<std::vector<int>> row_of_;  // [experiments][model parameters]
  std::vector<int> sampled_;
  std::vector<std::vector<int>> coordinates_of_;  // [rows]
  std::vector<ParameterInfo> infos_;
  std::vector<Slope> slopes_;
  std::vector<Member> members_;
  std::vector<MemberCoordinate> standardised_;
  std::vector<ImproperReference> references_;
  Kernel constrain_;    // u [D] -> values
  Kernel slope_;        // u [D] -> slopes
  Kernel unconstrain_;  // values -> u [D]
  Kernel scales_;       // u [D] -> scales of the members' priors
  Kernel prior_;        // u [D] -> log prior on R^D, log prior of the declared parameters
  Kernel improper_;     // u [D] -> what coordinates with an improper prior have in the first of these
  Graph densities_;     // the first of these as an expression of the coordinates
  NodeId density_ = 0;
  Lazily<std::optional<Kernel>> prior_gradient_;  // u [D] -> log prior on R^D, its gradient
};

/// The index of the parameter of the model that a coordinate moves. Its name cannot be read from the row's: `c[2,bench]` is of the
/// parameter `c[2]`, `c[2]` may be one of its own or the second experiment's `c`.
inline int parameter_of(ParameterSpace const& space, int coordinate) {
  int const row = space.sampled()[static_cast<std::size_t>(coordinate)];
  return space.rows()[static_cast<std::size_t>(row)].parameter;
}

}  // namespace sysid

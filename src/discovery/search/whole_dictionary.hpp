// The whole dictionary as one model over the records of a discovery: each coefficient a parameter that is 0 where its term is out,
// so that every set of terms is fitted without compiling anything.
#pragma once
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "discovery/found_source.hpp"
#include "discovery/search/linearised_motion.hpp"
#include "discovery/simulated_structure.hpp"
#include "discovery/validation_rows.hpp"
#include "likelihood/segments/shooting.hpp"

namespace sysid {

/// What all fits that are compared with one another have in common.
struct FitConditions {
  int halved = 0;    // how often each record is cut in two
  int substeps = 1;  // of the integrator
  NoiseShape noise;  // with the channels of the model
};

/// A set of terms fitted by multiple shooting.
struct FittedTerms {
  Terms terms;
  ShootingFit fit;
  double score = -std::numeric_limits<double>::infinity();  // log evidence and prior
  bool usable() const { return fit.finite && fit.determined; }
};

class WholeDictionary {
 public:
  /// A term of an equation, in one row with those of all others.
  struct Column {
    std::size_t equation, term;
    int parameter;
    bool always;      // part of the target
    double log_odds;  // of `log_term_odds`
  };

  WholeDictionary(FoundSource const& source, std::function<bool()> const& interrupted);

  /// Whether it is an explicit model, in fixed steps, and small enough.
  bool can_be_searched() const;

  std::vector<Column> const& columns() const { return columns_; }
  ValidatedModel const& model() const { return model_; }
  /// With the channels and inputs of the model.
  std::vector<Experiment> const& records() const { return records_; }
  /// How often a record can be cut in two.
  int most_halved() const { return most_halved_; }
  std::vector<Segment> segments(int halved) const { return cut_into_segments(records_, least_, halved); }

  Terms terms_of(FoundStructure const& structure) const;
  /// Coefficients of these terms as the regression has them.
  Eigen::VectorXd listed_values(FoundStructure const& structure, Terms const& terms) const;
  /// Of all columns; 0 for terms that are out.
  Eigen::VectorXd coefficients_of_all(FittedTerms const& fitted) const;
  Eigen::VectorXd coefficients_of(Terms const& terms, FittedTerms const& fitted) const;

  /// Of the terms that are fitted; all others are out.
  SegmentSimulation simulation(Terms const& terms, FitConditions const& conditions) const;
  /// Of starts alone, over other segments: coefficients are held at those of a fit.
  SegmentSimulation simulation(FittedTerms const& fitted, std::vector<Segment> const& parts, FitConditions const& conditions,
                               std::vector<Experiment> const& records) const;
  /// The same, of states in the place of channels: records have a column for each.
  SegmentSimulation states(FittedTerms const& fitted, std::vector<Segment> const& parts, FitConditions const& conditions,
                           std::vector<Experiment> const& records) const;
  /// What a fit leaves, with its coefficients held; of other records of the same rows.
  std::vector<SegmentSlopes> residuals(FittedTerms const& fitted, FitConditions const& conditions) const;
  std::vector<SegmentSlopes> residuals(FittedTerms const& fitted, FitConditions const& conditions,
                                       std::vector<Experiment> const& records) const;

  FittedTerms fitted(Terms const& terms, ShootingPoint from, FitConditions const& conditions) const;
  /// From these coefficients, and starts from the record.
  FittedTerms fitted(Terms const& terms, Eigen::VectorXd const& coefficients, FitConditions const& conditions);
  FittedTerms fitted(FoundStructure const& structure, FitConditions const& conditions);
  /// The channel of the model that measures a state; nothing where none does. state: the dictionary's, with its order.
  std::optional<std::size_t> channel_of(std::pair<int, int> const& state) const;
  /// Per channel of the model the state of the model that it measures; nothing where one measures anything else.
  std::optional<std::vector<int>> states_of_channels() const;
  FoundSource const& source() const { return source_; }
  /// Of what is part of the targets alone.
  FittedTerms fitted_without_terms(FitConditions const& conditions);

 private:
  ValidatedModel compiled();
  bool every_state_measured() const;
  double log_prior(Terms const& terms) const;
  SegmentSimulation simulation(Terms const& terms, Terms const& held, Eigen::VectorXd const& values,
                               FitConditions const& conditions, std::vector<Experiment> const& records,
                               std::vector<Segment> const& parts) const;
  SegmentSimulation::Settings settings(Terms const& terms, Terms const& held, Eigen::VectorXd const& values,
                                       FitConditions const& conditions) const;

  FoundSource const& source_;
  std::function<bool()> const& interrupted_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<Column> columns_;
  ValidatedModel model_;
  ValidationRows rows_;
  StartGuess guess_;
  std::vector<Experiment> records_;
  int least_ = 2, most_halved_ = 0;
};

}  // namespace sysid

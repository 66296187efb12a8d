// A discovered structure compiled for refits: its source read back as any file is, its coefficients, inputs, channels and states
// matched with those of the dictionary.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "discovery/found_source.hpp"
#include "experiment/start_guess.hpp"
#include "likelihood/segments/segments.hpp"

namespace sysid {

struct ValidatedModel {
  std::string failure;  // why it cannot be simulated; empty: all below is set
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<SimulationProgram const> centres;  // of its channels alone
  SolverSettings solver;                             // as its own fit would begin with
  struct Coefficient {
    std::size_t equation, term;  // of the dictionary
    int parameter;               // of the model
    double value, sd;            // of the regression, SI; not numbers where it does not list the support
    double start;                // where a fit begins
  };
  std::vector<Coefficient> coefficients;
  struct Inner {
    std::size_t index;  // of the dictionary's parameters inside terms
    int parameter;      // of the model
    double start;       // where a fit begins
  };
  std::vector<Inner> inner;                   // that stand in the model; they follow the coefficients in a fit
  std::vector<double> others;                 // all parameters of the model, as SegmentSimulation::Settings has them
  std::vector<std::size_t> inputs, channels;  // per input and channel of the model that of the dictionary
  std::vector<std::pair<int, int>> states;    // per state of the model: the dictionary's, and the order of its derivative

  std::vector<int> fitted() const;
  Eigen::VectorXd begin() const;
  /// An experiment with the columns of the dictionary as one with those of the model.
  Experiment view(Experiment const& of_dictionary) const;
  /// Starts of segments [states x segments], SI.
  Eigen::MatrixXd starts(std::vector<Segment> const& segments, StartGuess& guess) const;
};

ValidatedModel validated_model(FoundSource const& source, FoundStructure const& structure);

}  // namespace sysid

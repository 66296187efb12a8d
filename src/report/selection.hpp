// What a selection among models adds to a report: its tables, its part of summary.json, its CSV files.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inference/selector.hpp"

namespace sysid {

struct Report;
struct ReportTable;

/// A model's posterior by its likelihood, for comparison.
struct LikelihoodCheck {
  double log_evidence = 0;  // Laplace's, all constants kept; -infinity: no finite optimum was found
  double probability = 0;   // among the models
  std::string solver;       // "rk4(substeps = 2)": under which both are; empty where nothing is solved
  bool given_up =
      false;  // the climb to its mode, 30 nats and more below the most probable model: the evidence is where that was seen
};

struct SelectionReport {
  SelectionResult result;
  std::string distance;                                     // "nmse"
  std::vector<std::optional<LikelihoodCheck>> likelihoods;  // per model; empty: not asked for
  std::vector<std::vector<Summary>> polished;               // per model: from chains on the likelihood; may be empty
  std::vector<Draws> polished_draws;                        // per model
  std::optional<double> floor;                              // what noise alone leaves of the distance
  std::string floor_words;                                  // of which noise
  std::vector<WeightedSummary> shared;                      // over all models that have them
  struct Unmoved {
    std::string name, unit, prior, why;  // "log_uniform(1e-7, 1e-3)"
  };
  std::vector<Unmoved> shared_unmoved;  // shared names that no particle has: their prior stands
  std::uint64_t resampling_seed = 0;

  /// The most probable model.
  int leader() const;
};

/// "bouc_wen(n=2)": a model's name for files.
std::string model_file_name(std::string const& model);

std::vector<ReportTable> selection_tables(SelectionReport const& selection);
/// {NAME: {probability, share, died_in_population, parameters, ...}}.
nlohmann::ordered_json models_json(SelectionReport const& selection);
nlohmann::ordered_json populations_json(SelectionReport const& selection);

/// File names and contents: populations.csv; per model with particles particles_MODEL.csv (weight__, distance__, population__, then
/// parameters) and draws_MODEL.csv (as many particles resampled to equal weights, in the form of Stan's CSV).
std::vector<std::pair<std::string, std::string>> selection_files(Report const& report);

/// Particles resampled to equal weights as draws of one chain; declared units.
Draws resampled_draws(SelectedModel const& model, std::uint64_t seed);

/// The most probable model's particles, resampled, as a report of their own: what figures of draws read.
Report leading_model(Report const& report);

}  // namespace sysid

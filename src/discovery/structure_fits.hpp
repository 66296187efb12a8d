// Structures fitted to the motion over common segments of the records, as long as the best of them can follow.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "discovery/simulated_structure.hpp"
#include "likelihood/segments/shooting.hpp"

namespace sysid {

struct StructureFitSettings {
  std::vector<Experiment> records;             // with the dictionary's columns
  std::vector<double> noise_sd;                // per channel of the dictionary, as the regression took it
  std::vector<double> log_prior;               // per structure
  std::span<InnerParameter const> inner = {};  // of the dictionary
  int least = 2;                               // rows of the shortest segments
  NoiseShape noise = {};                       // with the dictionary's channels
  int substeps = 1;                            // of fixed steps, to begin with
  ExecutionOptions execution;
  std::shared_ptr<ThreadPool> pool;
  std::function<bool()> interrupted;
};

/// From the regression's coefficients over the shortest segments; then neighbours are joined as long as the structure that leads
/// follows: its fit converges, no channel's residual sd grows by more than half, and neighbouring motions do not part too far. The
/// first one leads, then the best by log posterior; the others are taken along. At the end each is fitted to the last digits; where
/// the leading one, or a shorter one near it, does not converge then, as in chaotic motion, all go back to segments of half the
/// length. Structures whose solver takes one simulation after the other share an allowance of simulated rows, so that the same are
/// given up on any machine.
class StructureFits {
 public:
  /// models: those with a failure are left alone; must outlive this.
  StructureFits(std::vector<ValidatedModel> const& models, StartGuess& guess, StructureFitSettings settings);

  void run();

  /// Why structure m is not validated; empty: it is, and has a fit.
  std::string const& failure(std::size_t m) const;
  ShootingFit const& fit(std::size_t m) const { return fits_[m].fit; }
  /// Log evidence and prior; -infinity where it is not validated.
  double log_posterior(std::size_t m) const;
  /// What a fit that did not converge had reached of it: no less is its own. -infinity for all others.
  double log_posterior_reached(std::size_t m) const;
  /// At its fit; -infinity where one leaves the support of its prior.
  double log_prior_of_inner(std::size_t m) const;
  std::vector<Segment> segments() const { return segments(halved_); }
  /// No record could be cut less.
  bool whole() const { return halved_ == 0; }
  SolverSettings solver(std::size_t m) const;
  /// With the channels of structure m.
  NoiseShape noise(std::size_t m) const;
  /// Its solver takes one simulation after the other: hundreds of times what lanes cost.
  bool one_by_one(std::size_t m) const;
  /// It is not validated because its allowance was spent.
  bool given_up(std::size_t m) const { return one_by_one(m) && spent_[m] > allowance_; }
  /// Coefficients by the rows of each record before `ends` alone.
  ShootingFit fit_before(std::size_t m, std::vector<int> const& ends) const;

 private:
  struct Fitted {
    int halved = -1;  // the level it stands at
    ShootingFit fit;
    std::string failure;
  };

  std::vector<Segment> segments(int halved) const { return cut_into_segments(settings_.records, settings_.least, halved); }
  SegmentSimulation simulation(std::size_t m, std::vector<Segment> const& segments, bool starts_alone = false) const;
  double rows_of_round(std::size_t m) const;
  std::function<bool()> stop(std::size_t m);
  ShootingOptions options(std::size_t m, bool last);
  bool validated(std::size_t m) const { return failure(m).empty(); }
  void begin(std::size_t m);
  ShootingPoint longer(Fitted const& from, std::vector<Segment> const& parts) const;
  Fitted at(std::size_t m, Fitted const& from, int halved, bool last);
  bool neighbours_part(std::size_t m, Fitted const& fitted) const;
  void climb_alone(std::size_t m);
  void climb_to(std::size_t m, int halved);
  void climb();
  double reached(std::size_t m) const;
  std::optional<std::size_t> best() const;
  void refine();
  bool settle();
  bool go_back();
  void name_failures();

  std::vector<ValidatedModel> const& models_;
  StartGuess& guess_;
  StructureFitSettings settings_;
  std::vector<Fitted> fits_;
  std::vector<std::vector<Fitted>> shorter_;  // per structure what it was fitted to on the way, shortest segments first
  int most_halvings_ = 0, halved_ = 0;
  int substeps_ = 1;           // at least
  double allowance_ = 0;       // rows that each of those that are taken one by one may simulate
  std::vector<double> spent_;  // of it, per structure
};

}  // namespace sysid

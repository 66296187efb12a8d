// Delays of the inputs of a fit, and whether another rule between their samples fits better.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "data/experiment.hpp"
#include "likelihood/target.hpp"
#include "model/model.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// What a fit makes of other experiments.
struct FitOfExperiments {
  std::function<std::unique_ptr<Target>(std::vector<Experiment>)> target;
  /// Log densities of the samples that are scored, one series for each experiment and channel, at declared values [P] of the
  /// sampled parameters; empty where samples are not independent of one another.
  std::function<std::vector<std::vector<double>>(std::vector<Experiment> const&, std::vector<double> const&)> log_densities;
};

/// What the fit leaves of an experiment.
struct LeftByFit {
  bool coloured = false;  // its residuals are correlated in time or with an input
  double squares = 0;     // sum of the squared residuals, in sds of the noise
};

/// Every input of every experiment under each other rule between its samples, and half a sample earlier and later: a short search
/// follows the mode to each. Where half a sample explains more, clearly or in an experiment whose residuals are coloured, the
/// search goes on from it in whole samples, up to five, until a further one explains less. All five in both directions are tried
/// of an input that changes much from sample to sample, if residuals are coloured or if a disturbance may have whitened them. What
/// explains the record clearly better is a warning, `input_rule` or `input_timing`, at most one for an input of an experiment.
/// Clearly better, with G the gain in log posterior and n the scored samples of the experiment:
///
///   G > 20 and G > 0.2 n,   or, of a rule,   G > 10 and a steady gain
///   of whole samples   G > 20,   G > 0.35 n   and   G > 0.25 sum r^2
///
/// so that whole samples remove half of the squared residuals r, whether the noise is estimated or stated: a delay that is longer
/// than five samples has gains at wrong shifts, which remove less.
///
/// Of `linear` on an input that is smooth by its samples (cut_by_lines) also a warning: `cubic` that explains the record as well,
/// G > -3, and moves a parameter by more than one of its sds.
///
/// In discrete time, where nothing is read between samples, every input is shifted by one to five whole samples, in all experiments
/// together and, where that is not clearly better, in each alone; clearly better is there
///
///   G > 20   and   (G > 0.2 n  or  a steady gain)
///
/// without the first and the last five samples, of which a shifted record lacks some. So there is at most one `input_timing` for
/// an input in all experiments, or one in each of them.
///
/// Steady (steady_gain): the gain of the log likelihood comes from all parts of the record, those where the inputs differ little
/// counting as less. A gain that is chance, however correlated the residuals are in time, comes from few parts of it. Where an
/// input repeats itself and the residuals are coloured no gain counts as steady, since an error of the model repeats itself with
/// it. mode: the best one of the density that `objective_kind` names. left: of each experiment.
Findings check_inputs(FitOfExperiments const& fit, Model const& model, std::vector<Experiment> const& experiments,
                      ObjectiveKind objective_kind, Mode const& mode, std::vector<LeftByFit> left, std::uint64_t seed,
                      Ledger& ledger);

}  // namespace sysid

// Compiles candidates for their data, and builds their two targets: distances, and the likelihood of each.
#include "app/selection/candidate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/exact_steps.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"
#include "data/scored_samples.hpp"
#include "model/simulated_parameters.hpp"

namespace sysid {
namespace {

/// The distance rule in terms of the channels of candidate k.
DistanceMeasure measure_of(DistanceRule const& rule, std::size_t k, Model const& model) {
  DistanceMeasure measure;
  measure.kind = rule.kind == DistanceRule::Kind::nmse   ? DistanceKind::nmse
                 : rule.kind == DistanceRule::Kind::rmse ? DistanceKind::rmse
                                                         : DistanceKind::mean;
  measure.unit = rule.unit;
  for (Channel const& channel : model.channels) {
    auto const found = std::find(rule.channels.begin(), rule.channels.end(), channel.name);
    auto const c = static_cast<std::size_t>(found - rule.channels.begin());
    bool const known = found != rule.channels.end();
    measure.weights.push_back(known ? rule.weights[c] : 0);
    if (measure.kind == DistanceKind::mean)
      measure.expressions.push_back(known ? std::optional(rule.expressions[k][c]) : std::nullopt);
  }
  return measure;
}

/// A weight that no sample would carry is refused: the distance would be that of the other channels alone.
void refuse_idle_weights(DistanceRule const& rule, Candidate const& candidate) {
  auto const& channels = candidate.compiled->model.channels;
  for (std::string const& name : rule.weighted) {
    auto const channel = std::find_if(channels.begin(), channels.end(), [&](Channel const& each) { return each.name == name; });
    auto const c = static_cast<std::size_t>(channel - channels.begin());
    bool const sampled = std::any_of(candidate.data.begin(), candidate.data.end(), [&](ExperimentData const& each) {
      std::vector<double> const& measured = each.experiment.measured[c];
      for (std::size_t i = 0; i < measured.size(); ++i)
        if (each.experiment.scored[i] != 0 && std::isfinite(measured[i])) return true;
      return false;
    });
    if (!sampled)
      throw UserError({Severity::error,
                       "E6517",
                       fmt::format("channel `{}` has a weight, but no sample in the scored rows", name),
                       std::nullopt,
                       {},
                       "remove its weight, or score rows in which it is measured"});
  }
}

}  // namespace

std::vector<Candidate> prepare_candidates(Session& session, SelectTask const& what, CandidateSet const& set) {
  std::vector<Candidate> all;
  for (std::size_t k = 0; k < set.models.size(); ++k) {
    Candidate candidate;
    candidate.what = &set.models[k];
    Model const& written = session.file.models[static_cast<std::size_t>(what.fits[k].model)];
    candidate.data = load_experiments(session, what.fits[k].experiments, written, what.fits[k].start, what.fits[k].prediction,
                                      what.fits[k].solver);
    SuitedTask suited = with_exact_steps(what.fits[k], written, candidate.data);
    if (suited.growing > 0) session.notices << exact_notice(candidate.what->name, what.fits[k].solver, suited);
    candidate.fit = std::move(suited.task);
    FitTask const& fit = candidate.fit;
    candidate.compiled = session.compiled(fit, fit.solver.method);
    Model const& model = candidate.compiled->model;
    candidate.space = parameter_space(model, fit.experiments);
    candidate.simulated = parameter_space(without_noise_parameters(model), fit.experiments);
    candidate.measure = measure_of(what.distance, k, model);
    all.push_back(std::move(candidate));
  }
  return all;
}

ModelSelectionTarget selection_target(Session const& session, SelectTask const& what, std::vector<Candidate> const& candidates,
                                      bool finer) {
  refuse_idle_weights(what.distance, candidates.front());
  std::vector<SelectionCandidate> all;
  for (Candidate const& each : candidates) {
    TargetOptions options;
    options.solver = finer ? each.fit.solver.finer() : each.fit.solver;
    options.start_rows = start_rows(each.fit.start);
    options.execution = session.abandonable();
    options.describe = [&session, model = each.fit.model](NodeId node, Graph const& graph) {
      return session.describe(model, graph, node);
    };
    all.push_back({each.what->name, each.what->probability, each.compiled, each.simulated, experiments_of(each.data), each.measure,
                   std::move(options)});
  }
  return ModelSelectionTarget(std::move(all));
}

std::unique_ptr<ModelTarget> likelihood_target(Session& session, Candidate const& candidate, std::vector<Experiment> experiments,
                                               SolverSettings const& solver, ExecutionOptions const& execution) {
  auto const compiled =
      solver.method == candidate.fit.solver.method ? candidate.compiled : session.compiled(candidate.fit, solver.method);
  return make_fit_target(session, candidate.fit, compiled, candidate.space, std::move(experiments), solver, execution);
}

std::unique_ptr<ModelTarget> likelihood_target(Session& session, Candidate const& candidate, SolverSettings const& solver,
                                               ExecutionOptions const& execution) {
  return likelihood_target(session, candidate, experiments_of(candidate.data), solver, execution);
}

void require_same_samples(std::vector<Candidate> const& candidates, Span place) {
  Candidate const& first = candidates.front();
  auto const& channels = first.compiled->model.channels;
  for (Candidate const& other : candidates)
    for (std::size_t e = 0; e < first.data.size(); ++e)
      for (std::size_t c = 0; c < channels.size(); ++c) {
        auto const& own = other.compiled->model.channels;
        auto const same = std::ranges::find(own, channels[c].name, &Channel::name);
        if (same == own.end()) continue;
        auto const d = static_cast<std::size_t>(same - own.begin());
        Experiment const &a = first.data[e].experiment, &b = other.data[e].experiment;
        for (int row = std::min(a.first_row, b.first_row);; ++row) {
          auto const i = static_cast<std::size_t>(row - a.first_row), j = static_cast<std::size_t>(row - b.first_row);
          bool const in_a = row >= a.first_row, in_b = row >= b.first_row;
          if ((in_a && i >= a.scored.size()) || (in_b && j >= b.scored.size())) break;
          if ((in_a && a.is_scored(c, i)) == (in_b && b.is_scored(d, j))) continue;
          throw UserError(
              {Severity::error,
               "E6520",
               fmt::format("`{}` and `{}` score different samples: `{}` of row {} of {}, for example, enters only one of "
                           "the likelihoods",
                           first.compiled->model.name, other.compiled->model.name, channels[c].name, row, a.name),
               Label{place, {}},
               {},
               "models with lags leave out the first rows, and rows after missing samples: select rows that all can "
               "score, or compare models with the same longest lag"});
        }
      }
}

double log_unit(Candidate const& candidate, Candidate const& first) {
  double term = 0;
  for (Channel const& channel : candidate.compiled->model.channels) {
    auto const& others = first.compiled->model.channels;
    auto const same = std::find_if(others.begin(), others.end(), [&](Channel const& each) { return each.name == channel.name; });
    if (same == others.end() || !channel.unit || !same->unit || channel.unit->scale == same->unit->scale) continue;
    auto const c = static_cast<std::size_t>(&channel - candidate.compiled->model.channels.data());
    double samples = 0;
    for (ExperimentData const& each : candidate.data) samples += scored_count(each.experiment, c);
    term += samples * elementary::log(same->unit->scale / channel.unit->scale);
  }
  return term;
}

}  // namespace sysid

// One compiled model; what a fit takes is which of its parameters are free.
#include "discovery/search/whole_dictionary.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "discovery/structure_prior.hpp"
#include "likelihood/segments/segment_starts.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double least_gain = 1e-2;  // of log likelihood in fits
constexpr int most_fit_rounds = 30;
constexpr double most_work = 2e7;  // simulated rows of a linearisation
constexpr int least_segment = 8;   // rows, where every state is measured
constexpr int most_segments = 64;  // of each experiment then

int length_of(Experiment const& experiment) { return static_cast<int>(experiment.time.size()); }

}  // namespace

WholeDictionary::WholeDictionary(FoundSource const& source, std::function<bool()> const& interrupted)
    : source_(source),
      interrupted_(interrupted),
      pool_(make_pool(source.execution)),
      model_(compiled()),
      rows_(validation_rows(source.data, {}, std::max(1, static_cast<int>(model_.states.size())), source.discovery.half_width)),
      guess_(source.dictionary.numbers, rows_.records, source.discovery.noise_sd) {
  if (!model_.failure.empty()) return;
  for (Experiment const& each : rows_.records) records_.push_back(model_.view(each));
  least_ = rows_.least;
  if (every_state_measured()) {
    least_ = std::max(least_segment, 2 * static_cast<int>(model_.states.size() + 1));
    for (Experiment const& each : records_) least_ = std::max(least_, length_of(each) / most_segments);
    least_ = std::min(least_, rows_.least);
  }
  for (Experiment const& each : records_) most_halved_ = std::max(most_halved_, halvings(length_of(each), least_));
}

ValidatedModel WholeDictionary::compiled() {
  CheckedDictionary const& dictionary = source_.dictionary;
  FoundStructure all;
  std::deque<regression::Support> supports;
  for (std::size_t e = 0; e < dictionary.equations.size(); ++e) {
    regression::Support& support = supports.emplace_back();
    std::vector<DictionaryTerm> const& terms = dictionary.equations[e].terms;
    for (std::size_t j = 0; j < terms.size(); ++j)
      if (is_offered(source_.discovery.equations[e], j)) support.terms.push_back(static_cast<int>(j));
    auto const count = static_cast<Eigen::Index>(support.terms.size());
    support.coefficient = Eigen::VectorXd::Ones(count);
    support.covariance = Eigen::MatrixXd::Identity(count, count);
    all.equations.push_back(&support);
  }
  ValidatedModel model = validated_model(source_, all);
  std::vector<std::vector<double>> odds;
  for (std::size_t e = 0; e < dictionary.equations.size(); ++e)
    odds.push_back(log_term_odds(dictionary.equations[e].terms, source_.discovery.equations[e]));
  for (ValidatedModel::Coefficient const& each : model.coefficients)
    columns_.push_back({each.equation, each.term, each.parameter, dictionary.equations[each.equation].terms[each.term].in_target,
                        odds[each.equation][each.term]});
  return model;
}

bool WholeDictionary::can_be_searched() const {
  if (!model_.failure.empty() || !model_.solver.row().in_program || !model_.solver.fixed_step()) return false;
  double count = 0;
  for (Experiment const& each : records_) count += length_of(each);
  return count * static_cast<double>(1 + columns_.size() + model_.states.size()) < most_work;
}

bool WholeDictionary::every_state_measured() const {
  return std::all_of(model_.states.begin(), model_.states.end(),
                     [&](std::pair<int, int> const& state) { return channel_of(state).has_value(); });
}

std::optional<std::size_t> WholeDictionary::channel_of(std::pair<int, int> const& state) const {
  auto const found = std::find_if(model_.channels.begin(), model_.channels.end(), [&](std::size_t c) {
    regression::Channel const& channel = source_.dictionary.numbers.channels[c];
    return channel.state == state.first && channel.order == state.second;
  });
  if (found == model_.channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - model_.channels.begin());
}

std::optional<std::vector<int>> WholeDictionary::states_of_channels() const {
  std::vector<int> out;
  for (std::size_t const c : model_.channels) {
    regression::Channel const& channel = source_.dictionary.numbers.channels[c];
    auto const state = std::find(model_.states.begin(), model_.states.end(), std::pair(channel.state, channel.order));
    if (state == model_.states.end()) return std::nullopt;
    out.push_back(static_cast<int>(state - model_.states.begin()));
  }
  return out;
}

Terms WholeDictionary::terms_of(FoundStructure const& structure) const {
  Terms terms;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    std::vector<int> const& in = structure.equations[columns_[j].equation]->terms;
    if (std::binary_search(in.begin(), in.end(), static_cast<int>(columns_[j].term))) terms.push_back(static_cast<int>(j));
  }
  return terms;
}

Eigen::VectorXd WholeDictionary::listed_values(FoundStructure const& structure, Terms const& terms) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Column const& of = columns_[static_cast<std::size_t>(terms[i])];
    regression::Support const& support = *structure.equations[of.equation];
    auto const place = std::lower_bound(support.terms.begin(), support.terms.end(), static_cast<int>(of.term));
    values(static_cast<Eigen::Index>(i)) = support.coefficient(place - support.terms.begin());
  }
  return values;
}

Eigen::VectorXd WholeDictionary::coefficients_of_all(FittedTerms const& fitted) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns_.size()));
  for (std::size_t i = 0; i < fitted.terms.size(); ++i)
    all(fitted.terms[i]) = fitted.fit.point.coefficients(static_cast<Eigen::Index>(i));
  return all;
}

Eigen::VectorXd WholeDictionary::coefficients_of(Terms const& terms, FittedTerms const& fitted) const {
  Eigen::VectorXd const all = coefficients_of_all(fitted);
  Eigen::VectorXd values(static_cast<Eigen::Index>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) values(static_cast<Eigen::Index>(i)) = all(terms[i]);
  return values;
}

SegmentSimulation WholeDictionary::simulation(Terms const& terms, FitConditions const& conditions) const {
  return simulation(terms, {}, {}, conditions, records_, segments(conditions.halved));
}

SegmentSimulation WholeDictionary::simulation(FittedTerms const& fitted, std::vector<Segment> const& parts,
                                              FitConditions const& conditions, std::vector<Experiment> const& records) const {
  return simulation({}, fitted.terms, fitted.fit.point.coefficients, conditions, records, parts);
}

SegmentSimulation WholeDictionary::states(FittedTerms const& fitted, std::vector<Segment> const& parts,
                                          FitConditions const& conditions, std::vector<Experiment> const& records) const {
  SegmentSimulation::Settings of_states = settings({}, fitted.terms, fitted.fit.point.coefficients, conditions);
  of_states.centres = compile_states(*model_.compiled);
  of_states.noise = {};
  return SegmentSimulation(model_.compiled, records, parts, std::move(of_states));
}

// held: terms at these values. All that is neither is out.
SegmentSimulation WholeDictionary::simulation(Terms const& terms, Terms const& held, Eigen::VectorXd const& values,
                                              FitConditions const& conditions, std::vector<Experiment> const& records,
                                              std::vector<Segment> const& parts) const {
  return SegmentSimulation(model_.compiled, records, parts, settings(terms, held, values, conditions));
}

SegmentSimulation::Settings WholeDictionary::settings(Terms const& terms, Terms const& held, Eigen::VectorXd const& values,
                                                      FitConditions const& conditions) const {
  SegmentSimulation::Settings settings{
      {}, model_.others, 0, model_.solver, source_.execution, pool_, model_.centres, conditions.noise};
  settings.solver.substeps = conditions.substeps;
  for (Column const& each : columns_) settings.others[static_cast<std::size_t>(each.parameter)] = 0;
  for (std::size_t i = 0; i < held.size(); ++i)
    settings.others[static_cast<std::size_t>(columns_[static_cast<std::size_t>(held[i])].parameter)] =
        values(static_cast<Eigen::Index>(i));
  for (int const j : terms) settings.fitted.push_back(columns_[static_cast<std::size_t>(j)].parameter);
  return settings;
}

std::vector<SegmentSlopes> WholeDictionary::residuals(FittedTerms const& fitted, FitConditions const& conditions) const {
  return residuals(fitted, conditions, records_);
}

std::vector<SegmentSlopes> WholeDictionary::residuals(FittedTerms const& fitted, FitConditions const& conditions,
                                                      std::vector<Experiment> const& records) const {
  return simulation(fitted, segments(conditions.halved), conditions, records)
      .residuals({Eigen::VectorXd(), fitted.fit.point.starts});
}

double WholeDictionary::log_prior(Terms const& terms) const {
  double sum = 0;
  for (int const j : terms) sum += columns_[static_cast<std::size_t>(j)].log_odds;
  return sum;
}

FittedTerms WholeDictionary::fitted(Terms const& terms, ShootingPoint from, FitConditions const& conditions) const {
  FittedTerms out;
  out.terms = terms;
  out.fit = fit_by_shooting(simulation(terms, conditions), std::move(from),
                            {.gain = least_gain, .most_rounds = most_fit_rounds, .interrupted = interrupted_});
  if (out.usable()) out.score = out.fit.log_evidence + log_prior(terms);
  return out;
}

FittedTerms WholeDictionary::fitted(Terms const& terms, Eigen::VectorXd const& coefficients, FitConditions const& conditions) {
  ShootingPoint point{Eigen::VectorXd(), model_.starts(segments(conditions.halved), guess_)};
  std::vector<double> noise;
  for (std::size_t const c : model_.channels) noise.push_back(source_.discovery.noise_sd[c]);
  fit_starts(simulation({}, terms, coefficients, conditions, records_, segments(conditions.halved)), point, noise, interrupted_);
  point.coefficients = coefficients;
  return fitted(terms, std::move(point), conditions);
}

FittedTerms WholeDictionary::fitted(FoundStructure const& structure, FitConditions const& conditions) {
  Terms const terms = terms_of(structure);
  return fitted(terms, listed_values(structure, terms), conditions);
}

FittedTerms WholeDictionary::fitted_without_terms(FitConditions const& conditions) {
  Terms terms;
  for (std::size_t j = 0; j < columns_.size(); ++j)
    if (columns_[j].always) terms.push_back(static_cast<int>(j));
  return fitted(terms, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(terms.size())), conditions);
}

}  // namespace sysid

// Windows of burn-in, and what each says of the independence moves.
#include "inference/chain/independence_learning.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/lanes.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/candidates.hpp"
#include "inference/evidence/mixture.hpp"
#include "search/laplace.hpp"

namespace sysid::metropolis {
namespace {

/// Iterations; shorter ones tell little of a covariance.
constexpr std::uint64_t shortest_window = 100;
/// Cycles from one trial to the next where independence moves are not accepted.
constexpr std::uint64_t trial_interval = 8;
/// Laplace's shares may be far off: each mode is visited.
constexpr double least_weight = 0.02;

/// Archived states, per coordinate, that a candidate over declared values is made from at least.
constexpr std::size_t least_archived = 10;
/// Those that several components are fitted to.
constexpr std::size_t most_fitted = 1000;

/// Parameters; with more, places along a ridge cost a part of the run.
constexpr int most_of_ridge = 24;
/// Windows in which other mixtures can show what they are worth.
constexpr std::uint64_t windows_before_ridge = 5;

/// Independence moves that a chain spends in one place, and windows in which there was such a place, that tell of mass which the
/// mixture hardly reaches; a single one is met by chance.
constexpr double too_long = 500;
constexpr std::uint64_t enough_windows = 2;

/// Acceptance of independence moves from which on no scouts are sent.
constexpr double near_normal = 0.7;
/// Independence moves that it takes to lead away from a place where a scout has been: if chains were as often in such places as
/// they should be, the mixture that is fitted to their states would lead there.
constexpr double long_for_scouts = 50;
/// By chance none of them is in a tail that holds a hundredth of the mass.
constexpr std::uint64_t most_scoutings = 2, windows_between_scoutings = 3;
/// What two more windows lengthen burn-in by: each is a third of what lies before it.
constexpr double two_windows = 16.0 / 9.0;

constexpr int most_moves = 15;
/// Independence moves that a chain spends in one place at most, between two moves of the random walk that lead out of it.
constexpr double longest_wait = 30;
/// Acceptance of independence moves by which every other move is one, however thin the mixture is somewhere: it costs there half of
/// the local moves.
constexpr double worth_half = 0.25;
/// Acceptance of independence moves by which others are not needed.
constexpr double enough_acceptance = 0.5;

/// A normal distribution over theta as one over the declared values, to first order about its mean.
Independence::Component over_declared(Target const& target, Independence::Component const& component) {
  constexpr double step = 1e-3;  // of a width
  Eigen::Index const dimension = component.mean.size();
  LaneArray theta(static_cast<int>(dimension), static_cast<int>(2 * dimension + 1)), declared(theta.rows(), theta.width());
  Eigen::VectorXd const width = component.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  for (int p = 0; p < theta.rows(); ++p)
    for (int w = 0; w < theta.width(); ++w)
      theta(p, w) = component.mean(p) + (w == 2 * p ? step * width(p) : w == 2 * p + 1 ? -step * width(p) : 0);
  target.constrain(theta, declared);
  Eigen::MatrixXd slope(dimension, dimension);
  for (int p = 0; p < theta.rows(); ++p)
    for (int k = 0; k < theta.rows(); ++k) {
      double const apart = 2 * step * width(k);
      slope(p, k) = apart > 0 ? (declared(p, 2 * k) - declared(p, 2 * k + 1)) / apart : p == k ? 1 : 0;
    }
  return {component.weight, column(declared, theta.width() - 1), slope * component.covariance * slope.transpose()};
}

/// Whether all components have a width in every direction.
bool usable(std::span<Independence::Component const> components) {
  return std::all_of(components.begin(), components.end(), [](Independence::Component const& each) {
    return each.mean.allFinite() && each.covariance.allFinite() && (each.covariance.diagonal().array() > 0).all();
  });
}

}  // namespace

void IndependenceLearning::Fit::add(double log_posterior, double log_q, bool first) {
  double const log_weight = log_posterior - log_q;
  log_density += log_q;
  log_highest = first ? log_weight : std::max(log_highest, log_weight);
  log_inverse = first ? -log_weight : log_of_sum(log_inverse, -log_weight);
}

IndependenceLearning::IndependenceLearning(Target const& target, std::vector<Mode> const& modes,
                                           std::vector<int> component_of_chain)
    : component_of_chain_(std::move(component_of_chain)) {
  std::vector<Independence::Component> components, declared;
  for (Mode const& mode : modes) {
    weights_.push_back(std::max(mode.share, least_weight));
    components.push_back({weights_.back(), theta_of(mode), covariance_of(mode)});
    declared.push_back(over_declared(target, components.back()));
  }
  mixtures_[0] = Independence(components);
  if (usable(declared)) mixtures_[3] = Independence(declared, true);
  archives_.assign(modes.size(), StateArchive(target.dimension()));
}

// A move of the random walk is worth 0.33 / P independent draws at best (Gelman, Roberts and Gilks 1996), an independence move at
// most its chance of being accepted. But in a place that the mixture hardly reaches a chain stays for long, and the walk must lead
// out of it, in at least half of the moves. Between separate modes nothing but independence moves leads.
int IndependenceLearning::worth() const {
  bool const sometimes = acceptance_ >= (weights_.size() > 1 ? 0.01 : worth_half);
  int const few = sometimes ? 1 : 0;
  if (acceptance_ < 0.1) return few;
  int const by_acceptance = acceptance_ >= enough_acceptance ? most_moves : acceptance_ >= 0.25 ? 7 : 3;
  return std::max(few, std::min(by_acceptance, static_cast<int>(longest_wait / longest_stay_)));
}

bool IndependenceLearning::too_few() const { return active() && windows_ > 0 && acceptance_ < enough_acceptance; }

bool IndependenceLearning::wants_ridge() const {
  return active() && (too_few() || long_stays_ >= enough_windows) && windows_ >= windows_before_ridge && !ridge_seen_ &&
         weights_.size() == 1 && mixture().dimension() <= most_of_ridge;
}

bool IndependenceLearning::wants_ridge_moves() const {
  int const dimension = mixture().dimension();
  return long_stays_ >= enough_windows && windows_ > windows_before_ridge && !wants_ridge() && dimension > 1 &&
         dimension <= most_of_ridge;
}

bool IndependenceLearning::wants_scouts(std::uint64_t end) const {
  return active() && acceptance_ < near_normal && windows_ > windows_before_ridge && !wants_ridge() && weights_.size() == 1 &&
         long_stays_ < enough_windows && mixture().dimension() <= most_of_ridge && archives_.front().size() > 0 &&
         scoutings_ < most_scoutings && windows_ >= next_scouting_ &&
         two_windows * static_cast<double>(iterations_) <= static_cast<double>(end);
}

std::optional<std::size_t> IndependenceLearning::see_scouts(Target const& target, State const& walked) {
  ++scoutings_;
  next_scouting_ = windows_ + windows_between_scoutings;
  double const far = log_mean_weight_ + elementary::log(long_for_scouts);
  std::vector<double> const weights = log_weights(target, walked);
  std::vector<std::size_t> back;
  std::optional<std::size_t> farthest;
  for (std::size_t w = 0; w < weights.size(); ++w) {
    if (!(walked.log_prior[w] + walked.log_likelihood[w] >= usual_density_)) continue;
    back.push_back(w);
    if (weights[w] > far && (!farthest || weights[w] > weights[*farthest])) farthest = w;
  }
  if (farthest) {
    mass_found_ = true;
    long_stays_ = std::max(long_stays_, enough_windows);
  }
  walked_ = LaneArray(walked.theta.rows(), static_cast<int>(back.size()));
  for (int p = 0; p < walked_.rows(); ++p)
    for (int w = 0; w < walked_.width(); ++w) walked_(p, w) = walked.theta(p, static_cast<int>(back[static_cast<std::size_t>(w)]));
  return farthest;
}

void IndependenceLearning::see_ridge(Independence const& mixture, double worth, bool complete) {
  ridge_seen_ = true;
  if (worth <= acceptance_) return;
  if (!complete) {
    long_stays_ = std::max(long_stays_, enough_windows);
    return;
  }
  on_ridge_ = true;
  if (!mass_found_) long_stays_ = 0;  // they were those of another mixture
  mixtures_.fill({});
  mixtures_[0] = mixture;
}

int IndependenceLearning::moves_in_burn_in() const {
  if (!active()) return 0;
  if (windows_ == 0) return 3;
  int const moves = worth();
  return moves > 0 ? moves : cycles_ % trial_interval == 0 ? 1 : 0;
}

int IndependenceLearning::moves() const { return active() && windows_ > 0 ? worth() : 0; }

std::vector<double> IndependenceLearning::log_weights(Target const& target, State const& state) const {
  Framed const states = framed(target, mixture().declared(), state.theta);
  std::vector<double> log_q(states.log_slope.size());
  mixture().log_density(states.x, log_q);
  for (std::size_t w = 0; w < log_q.size(); ++w)
    log_q[w] = state.log_prior[w] + state.log_likelihood[w] - log_q[w] - states.log_slope[w];
  return log_q;
}

std::vector<char> IndependenceLearning::away(Target const& target, State const& state) const {
  std::vector<char> is_away(component_of_chain_.size(), 0);
  if (weights_.size() < 2) return is_away;
  Framed const states = framed(target, mixture().declared(), state.theta);
  for (std::size_t w = 0; w < is_away.size(); ++w)
    is_away[w] = mixture().nearest(states.x, static_cast<int>(w)) != component_of_chain_[w];
  return is_away;
}

void IndependenceLearning::archive(State const& state, std::span<char const> away) {
  for (std::size_t w = 0; w < away.size(); ++w)
    if (away[w] == 0)
      archives_[static_cast<std::size_t>(component_of_chain_[w])].add(state.theta, static_cast<int>(w), iterations_);
  for (StateArchive& each : archives_) each.thin();
}

std::optional<Independence::Component> IndependenceLearning::declared(Target const& target, std::size_t component) const {
  StateArchive const& archive = archives_[component];
  LaneArray const theta = archive.picked(archive.early(), archive.size());
  if (theta.width() < static_cast<int>(least_archived) * theta.rows()) return std::nullopt;
  LaneArray values(theta.rows(), theta.width());
  target.constrain(theta, values);
  Eigen::MatrixXd states(values.rows(), values.width());
  for (int p = 0; p < values.rows(); ++p)
    for (int n = 0; n < values.width(); ++n) states(p, n) = values(p, n);
  Eigen::VectorXd const mean = states.rowwise().mean();
  states.colwise() -= mean;
  Eigen::MatrixXd const covariance = states * states.transpose() / static_cast<double>(states.cols());
  return Independence::Component{weights_[component], mean, covariance};
}

void IndependenceLearning::learn(Target const& target, State const& state, Info const& info, std::span<char const> away) {
  ++iterations_;
  ++window_.iterations;
  archive(state, away);
  Framed const plain = framed(target, false, state.theta);
  Framed const declared = sees_declared() ? framed(target, true, state.theta) : Framed{};
  std::array<std::vector<double>, mixture_count> log_q;
  for (std::size_t m = 0; m < mixtures_.size(); ++m) {
    log_q[m].assign(info.size(), 0.0);
    if (!compared(m)) continue;
    Framed const& frame = mixtures_[m].declared() ? declared : plain;
    mixtures_[m].log_density(frame.x, log_q[m]);
    for (std::size_t w = 0; w < info.size(); ++w) log_q[m][w] += frame.log_slope[w];
  }
  for (std::size_t chain = 0; chain < info.size(); ++chain) {
    double const density = state.log_prior[chain] + state.log_likelihood[chain];
    bool finite = std::isfinite(density);
    for (auto const& each : log_q) finite = finite && std::isfinite(each[chain]);
    if (finite) {
      for (std::size_t m = 0; m < mixtures_.size(); ++m) window_.fits[m].add(density, log_q[m][chain], window_.states == 0);
      ++window_.states;
      window_.density += density;
      window_.square += density * density;
    }
    if (info[chain].kind != MoveKind::independent) continue;
    window_.acceptance += info[chain].acceptance_probability;
    ++window_.moves;
  }
}

bool IndependenceLearning::end_cycle(Target const& target, std::span<Adaptation const> groups, std::uint64_t seed) {
  ++cycles_;
  if (window_.iterations < std::max(shortest_window, iterations_ / 4)) return false;
  std::size_t best = 0;
  for (std::size_t m = 1; m < mixtures_.size(); ++m)
    if (compared(m) && window_.fits[m].log_density > window_.fits[best].log_density) best = m;
  mixtures_[0] = mixtures_[best];
  if (window_.states > 0) {
    // E w over q is 1 / E(1 / w) over p, of which the states are.
    Fit const& fit = window_.fits[best];
    log_mean_weight_ = elementary::log(static_cast<double>(window_.states)) - fit.log_inverse;
    longest_stay_ = elementary::exp(fit.log_highest - log_mean_weight_);
    double const mean = window_.density / static_cast<double>(window_.states);
    usual_density_ = mean - std::sqrt(std::max(0.0, window_.square / static_cast<double>(window_.states) - mean * mean));
    if (windows_ + 1 >= windows_before_ridge && longest_stay_ > too_long) ++long_stays_;
  }
  if (window_.moves > 0) acceptance_ = window_.acceptance / static_cast<double>(window_.moves);
  ++windows_;
  window_ = {};
  propose_mixtures(target, groups, seed);
  return true;
}

Independence IndependenceLearning::several(std::uint64_t seed) const {
  LaneArray const of_chains = archives_.front().picked(archives_.front().early(), most_fitted);
  LaneArray states(of_chains.rows(), of_chains.width() + walked_.width());
  // Scouts are spread evenly among the others: the last third of the columns decides how many components there are.
  for (int n = 0, scouts = 0; n < states.width(); ++n) {
    bool const of_scout = static_cast<long>(n + 1) * walked_.width() / states.width() > scouts;
    for (int p = 0; p < states.rows(); ++p) states(p, n) = of_scout ? walked_(p, scouts) : of_chains(p, n - scouts);
    if (of_scout) ++scouts;
  }
  marginal::Mixture const fitted = marginal::fit_mixture({}, states, seed, {});
  std::vector<Independence::Component> components;
  for (marginal::Mixture::Part const& part : fitted.parts())
    components.push_back({part.normal + part.student, part.shape.centre, part.shape.root * part.shape.root.transpose()});
  return components.empty() || !usable(components) ? Independence() : Independence(components);
}

void IndependenceLearning::propose_mixtures(Target const& target, std::span<Adaptation const> groups, std::uint64_t seed) {
  if (on_ridge_) return;
  std::vector<Independence::Component> plain, over_values;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    for (Adaptation const& group : groups)
      if (component_of_chain_[static_cast<std::size_t>(group.chains().front())] == static_cast<int>(k))
        plain.push_back({weights_[k], group.mean(), group.covariance()});
    if (!sees_declared()) continue;
    if (auto component = declared(target, k)) over_values.push_back(std::move(*component));
  }
  // Modes without a chain have nothing new: a candidate that lost them would lose the posterior's mass there.
  mixtures_[1] = plain.size() == weights_.size() && usable(plain) ? Independence(plain) : Independence();
  mixtures_[2] = over_values.size() == weights_.size() && usable(over_values) ? Independence(over_values, true) : Independence();
  mixtures_[4] = too_few() && weights_.size() == 1 ? several(seed) : Independence();
}

nlohmann::json IndependenceLearning::store() const {
  nlohmann::json mixtures = nlohmann::json::array(), archives = nlohmann::json::array();
  for (Independence const& mixture : mixtures_) mixtures.push_back(mixture.store());
  for (StateArchive const& each : archives_) archives.push_back(each.store());
  std::vector<double> sums{window_.acceptance, acceptance_,     longest_stay_, log_mean_weight_,
                           usual_density_,     window_.density, window_.square};
  for (Fit const& fit : window_.fits) sums.insert(sums.end(), {fit.log_density, fit.log_highest, fit.log_inverse});
  return {{"component_of_chain", component_of_chain_},
          {"weights", checkpoint::encode(std::span<double const>(weights_))},
          {"mixtures", mixtures},
          {"archives", archives},
          {"walked", {{"count", walked_.width()}, {"states", checkpoint::encode(walked_)}}},
          {"ridge", {ridge_seen_, on_ridge_, mass_found_}},
          {"scoutings", {scoutings_, next_scouting_}},
          {"long_stays", long_stays_},
          {"counts", {window_.iterations, window_.states, window_.moves, iterations_, cycles_, windows_}},
          {"sums", checkpoint::encode(std::span<double const>(sums))}};
}

bool IndependenceLearning::fits(int chains) const {
  auto const known = [&](int component) { return component >= 0 && static_cast<std::size_t>(component) < weights_.size(); };
  std::size_t const count = weights_.empty() ? 0 : static_cast<std::size_t>(chains);
  return component_of_chain_.size() == count && std::all_of(component_of_chain_.begin(), component_of_chain_.end(), known);
}

IndependenceLearning IndependenceLearning::restore(nlohmann::json const& stored, int dimension, int chains) {
  IndependenceLearning all;
  all.component_of_chain_ = stored.at("component_of_chain").get<std::vector<int>>();
  all.weights_ = checkpoint::decode(stored.at("weights"));
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  std::vector<double> const sums = checkpoint::decode(stored.at("sums"), 7 + 3 * mixture_count);
  if (counts.size() != 6 || stored.at("mixtures").size() != all.mixtures_.size() ||
      stored.at("archives").size() != all.weights_.size() || !all.fits(chains))
    throw checkpoint::Mismatch("its independence moves differ in form");
  for (std::size_t m = 0; m < all.mixtures_.size(); ++m)
    all.mixtures_[m] = Independence::restore(stored.at("mixtures").at(m), dimension);
  for (nlohmann::json const& each : stored.at("archives")) all.archives_.push_back(StateArchive::restore(each, dimension));
  if (int const walked = stored.at("walked").at("count").get<int>(); walked > 0)
    all.walked_ = checkpoint::decode(stored.at("walked").at("states"), dimension, walked);
  all.window_ = {counts[0], counts[1], counts[2], {}, sums[0], sums[5], sums[6]};
  for (std::size_t m = 0; m < all.window_.fits.size(); ++m)
    all.window_.fits[m] = {sums[7 + 3 * m], sums[8 + 3 * m], sums[9 + 3 * m]};
  all.ridge_seen_ = stored.at("ridge").at(0).get<bool>();
  all.on_ridge_ = stored.at("ridge").at(1).get<bool>();
  all.mass_found_ = stored.at("ridge").at(2).get<bool>();
  all.scoutings_ = stored.at("scoutings").at(0).get<std::uint64_t>();
  all.next_scouting_ = stored.at("scoutings").at(1).get<std::uint64_t>();
  all.iterations_ = counts[3];
  all.cycles_ = counts[4];
  all.windows_ = counts[5];
  all.long_stays_ = stored.at("long_stays").get<std::uint64_t>();
  all.acceptance_ = sums[1];
  all.longest_stay_ = sums[2];
  all.log_mean_weight_ = sums[3];
  all.usual_density_ = sums[4];
  return all;
}

}  // namespace sysid::metropolis

// Recording chains and turning the record into draws.
#include "inference/chain/chain_record.hpp"

#include <algorithm>
#include <limits>

#include "inference/backend/checkpoint.hpp"

namespace sysid {

ChainRecord::ChainRecord(int dimension, int chains) : dimension_(dimension), traces_(static_cast<std::size_t>(chains)) {}

void ChainRecord::count_burn_in(metropolis::Info const& info) {
  for (std::size_t w = 0; w < traces_.size(); ++w) count_burn_in(static_cast<int>(w), info[w]);
}

void ChainRecord::count_burn_in(int chain, metropolis::Move const& move) {
  Trace& trace = traces_[static_cast<std::size_t>(chain)];
  ++trace.burnt;
  trace.accepted_burning += move.accepted ? 1 : 0;
}

void ChainRecord::add(int chain, metropolis::State const& state, metropolis::Move const& move, bool keep) {
  auto const w = static_cast<std::size_t>(chain);
  Trace& trace = traces_[w];
  ++trace.sampled;
  trace.accepted += move.accepted ? 1 : 0;
  if (!keep) return;
  for (int p = 0; p < dimension_; ++p) trace.theta.push_back(state.theta(p, chain));
  trace.log_prior.push_back(state.log_prior[w]);
  trace.log_likelihood.push_back(state.log_likelihood[w]);
  trace.acceptance.push_back(move.acceptance_probability);
}

void ChainRecord::add(int chain, std::span<double const> theta, double log_prior, double log_likelihood,
                      metropolis::Move const& move) {
  Trace& trace = traces_[static_cast<std::size_t>(chain)];
  ++trace.sampled;
  trace.accepted += move.accepted ? 1 : 0;
  trace.theta.insert(trace.theta.end(), theta.begin(), theta.end());
  trace.log_prior.push_back(log_prior);
  trace.log_likelihood.push_back(log_likelihood);
  trace.acceptance.push_back(move.acceptance_probability);
}

std::vector<double> ChainRecord::acceptance_rate() const {
  std::vector<double> rate;
  for (Trace const& trace : traces_) {
    bool const after = trace.sampled > 0;
    double const count = static_cast<double>(std::max<std::uint64_t>(1, after ? trace.sampled : trace.burnt));
    rate.push_back(static_cast<double>(after ? trace.accepted : trace.accepted_burning) / count);
  }
  return rate;
}

double ChainRecord::mean_acceptance() const {
  double sum = 0;
  for (double const rate : acceptance_rate()) sum += rate;
  return traces_.empty() ? 0 : sum / static_cast<double>(traces_.size());
}

std::vector<std::uint64_t> ChainRecord::distinct_states() const {
  std::vector<std::uint64_t> distinct;
  for (Trace const& trace : traces_) distinct.push_back(trace.accepted + 1);
  return distinct;
}

void ChainRecord::write(Target const& target, std::uint64_t thin, bool unthinned, FitResult& result) const {
  Draws& draws = result.draws;
  for (ParameterInfo const& parameter : target.parameters()) {
    draws.names.push_back(parameter.name);
    draws.units.push_back(parameter.unit);
  }
  draws.parameter_count = dimension_;
  draws.chains.assign(traces_.size(), {});
  if (unthinned) result.unthinned.assign(static_cast<std::size_t>(dimension_), ChainValues(traces_.size()));
  std::size_t records = std::numeric_limits<std::size_t>::max();
  for (Trace const& trace : traces_) records = std::min(records, trace.log_prior.size());
  for (std::size_t w = 0; w < traces_.size(); ++w) write_chain(target, traces_[w], records, thin, unthinned, w, result);
}

void ChainRecord::write_chain(Target const& target, Trace const& trace, std::size_t records, std::uint64_t thin, bool unthinned,
                              std::size_t chain, FitResult& result) const {
  constexpr std::size_t block = 1024;
  Chain& draws = result.draws.chains[chain];
  for (std::size_t first = 0; first < records; first += block) {
    std::size_t const count = std::min(block, records - first);
    LaneArray theta(dimension_, static_cast<int>(count)), declared(theta.rows(), theta.width());
    for (std::size_t i = 0; i < count; ++i)
      for (int p = 0; p < dimension_; ++p)
        theta(p, static_cast<int>(i)) =
            trace.theta[(first + i) * static_cast<std::size_t>(dimension_) + static_cast<std::size_t>(p)];
    target.constrain(theta, declared);
    for (int p = 0; unthinned && p < dimension_; ++p) {
      auto& values = result.unthinned[static_cast<std::size_t>(p)][chain];
      values.insert(values.end(), declared.row(p).begin(), declared.row(p).end());
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < count; ++i)
      if ((first + i + 1) % thin == 0) kept.push_back(i);
    LaneArray kept_theta(dimension_, static_cast<int>(kept.size()));
    for (int p = 0; p < dimension_; ++p)
      for (std::size_t k = 0; k < kept.size(); ++k) kept_theta(p, static_cast<int>(k)) = theta(p, static_cast<int>(kept[k]));
    std::vector<double> declared_prior(kept.size());
    target.log_prior(kept_theta, declared_prior, false);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      std::size_t const i = kept[k];
      draws.values.emplace_back();
      for (int p = 0; p < dimension_; ++p) draws.values.back().push_back(declared(p, static_cast<int>(i)));
      draws.log_prior.push_back(declared_prior[k]);
      draws.log_likelihood.push_back(trace.log_likelihood[first + i]);
      draws.log_density.push_back(trace.log_prior[first + i] + trace.log_likelihood[first + i]);
      draws.acceptance.push_back(trace.acceptance[first + i]);
    }
  }
}

nlohmann::json ChainRecord::store() const {
  auto const block = [](std::vector<double> const& v) { return checkpoint::encode(std::span<double const>(v)); };
  nlohmann::json traces = nlohmann::json::array();
  for (Trace const& trace : traces_)
    traces.push_back({{"burnt", trace.burnt},
                      {"accepted_burning", trace.accepted_burning},
                      {"sampled", trace.sampled},
                      {"accepted", trace.accepted},
                      {"theta", block(trace.theta)},
                      {"log_prior", block(trace.log_prior)},
                      {"log_likelihood", block(trace.log_likelihood)},
                      {"acceptance", block(trace.acceptance)}});
  return traces;
}

ChainRecord ChainRecord::restore(nlohmann::json const& stored, int dimension, int chains) {
  ChainRecord record(dimension, chains);
  if (stored.size() != record.traces_.size()) throw checkpoint::Mismatch("its chains differ in number or dimension");
  for (std::size_t w = 0; w < record.traces_.size(); ++w) {
    nlohmann::json const& from = stored.at(w);
    Trace& trace = record.traces_[w];
    trace.burnt = from.at("burnt").get<std::uint64_t>();
    trace.accepted_burning = from.at("accepted_burning").get<std::uint64_t>();
    trace.sampled = from.at("sampled").get<std::uint64_t>();
    trace.accepted = from.at("accepted").get<std::uint64_t>();
    trace.theta = checkpoint::decode(from.at("theta"));
    trace.log_prior = checkpoint::decode(from.at("log_prior"));
    trace.log_likelihood = checkpoint::decode(from.at("log_likelihood"));
    trace.acceptance = checkpoint::decode(from.at("acceptance"));
    std::size_t const records = trace.log_prior.size();
    if (trace.theta.size() != records * static_cast<std::size_t>(dimension) || trace.log_likelihood.size() != records ||
        trace.acceptance.size() != records)
      throw checkpoint::Mismatch("its draws are truncated");
  }
  return record;
}

}  // namespace sysid

// Recording chains and turning the record into draws.
#include "inference/chain_record.hpp"

#include <algorithm>

#include "inference/checkpoint.hpp"

namespace sysid {

ChainRecord::ChainRecord(int dimension, int chains)
    : dimension_(dimension),
      chains_(chains),
      accepted_burning_(static_cast<std::size_t>(chains), 0),
      accepted_(static_cast<std::size_t>(chains), 0) {}

void ChainRecord::count_burn_in(metropolis::Info const& info) {
  ++burnt_;
  for (std::size_t w = 0; w < accepted_burning_.size(); ++w) accepted_burning_[w] += info.accepted[w] ? 1 : 0;
}

void ChainRecord::add(metropolis::State const& state, metropolis::Info const& info, bool keep) {
  ++sampled_;
  for (std::size_t w = 0; w < accepted_.size(); ++w) accepted_[w] += info.accepted[w] ? 1 : 0;
  if (!keep) return;
  for (int p = 0; p < dimension_; ++p) {
    auto const row = state.theta.row(p);
    theta_.insert(theta_.end(), row.begin(), row.end());
  }
  log_prior_.insert(log_prior_.end(), state.log_prior.begin(), state.log_prior.end());
  log_likelihood_.insert(log_likelihood_.end(), state.log_likelihood.begin(), state.log_likelihood.end());
  acceptance_.insert(acceptance_.end(), info.acceptance_probability.begin(), info.acceptance_probability.end());
}

std::vector<double> ChainRecord::acceptance_rate() const {
  auto const& accepted = sampled_ > 0 ? accepted_ : accepted_burning_;
  double const count = static_cast<double>(std::max<std::uint64_t>(1, sampled_ > 0 ? sampled_ : burnt_));
  std::vector<double> rate;
  for (std::uint64_t const a : accepted) rate.push_back(static_cast<double>(a) / count);
  return rate;
}

double ChainRecord::mean_acceptance() const {
  double sum = 0;
  for (double const rate : acceptance_rate()) sum += rate;
  return chains_ > 0 ? sum / chains_ : 0;
}

std::vector<std::uint64_t> ChainRecord::distinct_states() const {
  std::vector<std::uint64_t> distinct;
  for (std::uint64_t const a : accepted_) distinct.push_back(a + 1);
  return distinct;
}

void ChainRecord::write(Target const& target, std::uint64_t thin, bool unthinned, FitResult& result) const {
  auto const width = static_cast<std::size_t>(chains_);
  auto const rows = static_cast<std::size_t>(dimension_);
  std::size_t const records = width == 0 ? 0 : log_prior_.size() / width;
  Draws& draws = result.draws;
  for (ParameterInfo const& parameter : target.parameters()) {
    draws.names.push_back(parameter.name);
    draws.units.push_back(parameter.unit);
  }
  draws.parameter_count = dimension_;
  draws.chains.assign(width, {});
  if (unthinned) result.unthinned.assign(rows, ChainValues(width));

  // Several iterations share a batch, so that lanes are full.
  std::size_t const block = std::max<std::size_t>(1, 1024 / std::max<std::size_t>(1, width));
  for (std::size_t first = 0; first < records; first += block) {
    std::size_t const count = std::min(block, records - first);
    LaneArray theta(dimension_, static_cast<int>(count * width)), declared(theta.rows(), theta.width());
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t p = 0; p < rows; ++p)
        for (std::size_t w = 0; w < width; ++w)
          theta(static_cast<int>(p), static_cast<int>(i * width + w)) = theta_[((first + i) * rows + p) * width + w];
    target.constrain(theta, declared);
    std::vector<double> declared_prior(count * width);
    target.log_prior(theta, declared_prior, false);
    for (std::size_t i = 0; i < count; ++i) {
      bool const kept = (first + i + 1) % thin == 0;
      for (std::size_t w = 0; w < width; ++w) {
        auto const lane = static_cast<int>(i * width + w);
        for (std::size_t p = 0; unthinned && p < rows; ++p) result.unthinned[p][w].push_back(declared(static_cast<int>(p), lane));
        if (!kept) continue;
        Chain& chain = draws.chains[w];
        std::size_t const at = (first + i) * width + w;
        chain.values.emplace_back();
        for (int p = 0; p < dimension_; ++p) chain.values.back().push_back(declared(p, lane));
        chain.log_prior.push_back(declared_prior[static_cast<std::size_t>(lane)]);
        chain.log_likelihood.push_back(log_likelihood_[at]);
        chain.log_density.push_back(log_prior_[at] + log_likelihood_[at]);
        chain.acceptance.push_back(acceptance_[at]);
      }
    }
  }
}

nlohmann::json ChainRecord::store() const {
  auto const block = [](std::vector<double> const& v) { return checkpoint::encode(std::span<double const>(v)); };
  return {{"burnt", burnt_},
          {"sampled", sampled_},
          {"accepted_burning", accepted_burning_},
          {"accepted", accepted_},
          {"theta", block(theta_)},
          {"log_prior", block(log_prior_)},
          {"log_likelihood", block(log_likelihood_)},
          {"acceptance", block(acceptance_)}};
}

ChainRecord ChainRecord::restore(nlohmann::json const& stored, int dimension, int chains) {
  ChainRecord record(dimension, chains);
  record.burnt_ = stored.at("burnt").get<std::uint64_t>();
  record.sampled_ = stored.at("sampled").get<std::uint64_t>();
  record.accepted_burning_ = stored.at("accepted_burning").get<std::vector<std::uint64_t>>();
  record.accepted_ = stored.at("accepted").get<std::vector<std::uint64_t>>();
  record.theta_ = checkpoint::decode(stored.at("theta"));
  record.log_prior_ = checkpoint::decode(stored.at("log_prior"));
  record.log_likelihood_ = checkpoint::decode(stored.at("log_likelihood"));
  record.acceptance_ = checkpoint::decode(stored.at("acceptance"));
  auto const width = static_cast<std::size_t>(chains);
  std::size_t const numbers = record.log_prior_.size();
  if (record.accepted_.size() != width || record.accepted_burning_.size() != width || numbers % width != 0 ||
      record.theta_.size() != numbers * static_cast<std::size_t>(dimension) || record.log_likelihood_.size() != numbers ||
      record.acceptance_.size() != numbers)
    throw checkpoint::Mismatch("its draws are cut short");
  return record;
}

}  // namespace sysid

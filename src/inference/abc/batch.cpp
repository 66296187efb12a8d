// Proposals of one model are simulated together, whatever their order in the batch.
#include "inference/abc/batch.hpp"

#include <fmt/format.h>

#include "core/numeric/not_finite.hpp"

namespace sysid::abc {

Batch::Batch(SelectionTarget const& candidates, Proposals const& proposals, std::uint64_t first, int count, double threshold)
    : candidates_(candidates), proposed_(proposals.make(first, count)) {
  std::size_t const models = proposed_.x.size();
  lanes_.resize(models);
  theta_.resize(models);
  distance_.resize(models);
  ending_.resize(models);
  std::vector<SelectionTarget::Batch> batches;
  for (std::size_t m = 0; m < models; ++m) {
    sort_out(m);
    if (theta_[m].width() > 0) batches.push_back({static_cast<int>(m), theta_[m], distance_[m], ending_[m]});
  }
  candidates_.distances(batches, threshold);
}

/// Chooses what lies inside the prior's support.
void Batch::sort_out(std::size_t model) {
  std::vector<int> inside;  // columns
  for (double const log_prior : proposed_.log_prior[model]) {
    bool const is_inside = log_prior > -infinity;
    lanes_[model].push_back(is_inside ? static_cast<int>(inside.size()) : -1);
    if (is_inside) inside.push_back(static_cast<int>(lanes_[model].size()) - 1);
  }
  LaneArray const& all = proposed_.theta[model];
  LaneArray& theta = theta_[model] = LaneArray(all.rows(), static_cast<int>(inside.size()));
  for (int d = 0; d < theta.rows(); ++d)
    for (int w = 0; w < theta.width(); ++w) theta(d, w) = all(d, inside[static_cast<std::size_t>(w)]);
  distance_[model].resize(inside.size());
  ending_[model].resize(inside.size());
}

void Batch::find_failed_places(std::size_t from, std::size_t to, int& wanted, std::size_t most, std::vector<Place>& found) const {
  for (std::size_t i = from; i < to && wanted > 0 && found.size() < most; ++i) {
    if (!is_simulated(i)) continue;
    if (ending(i) == Simulated::within) --wanted;
    if (ending(i) == Simulated::failed) found.push_back(candidates_.failure(static_cast<int>(model(i)), theta(i)));
  }
}

void Batch::keep(std::size_t i, Particles& particles) const {
  std::size_t const m = model(i);
  int const column = proposed_.column[i];
  particles.add(proposed_.x[m], column, proposed_.log_prior[m][static_cast<std::size_t>(column)],
                distance_[m][static_cast<std::size_t>(lane(i))]);
}

void Batch::note_failure(std::size_t i, Place const* place, Ledger& ledger) const {
  auto const m = static_cast<int>(model(i));
  LaneArray declared(theta(i).rows(), 1);
  candidates_.constrain(m, theta(i), declared);
  std::vector<double> example;
  std::vector<std::string> names;
  for (int d = 0; d < declared.rows(); ++d) {
    example.push_back(declared(d, 0));
    names.push_back(candidates_.parameters(m)[static_cast<std::size_t>(d)].name);
  }
  std::string const where = place != nullptr ? fmt::format("{} of `{}`", place->first, candidates_.name(m))
                                             : fmt::format("`{}`{}", candidates_.name(m), Ledger::not_traced);
  ledger.add_failure(FailureClass::non_finite, where, place != nullptr ? place->second : not_a_number, std::move(example), 1,
                     std::move(names));
}

}  // namespace sysid::abc

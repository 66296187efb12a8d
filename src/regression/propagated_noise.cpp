// One more projection, of a moved record.
#include "regression/propagated_noise.hpp"

#include "core/numeric/random.hpp"

namespace sysid::regression {

std::vector<Columns> noise_of_columns(Dictionary const& dictionary, std::span<Experiment const> experiments, Form const& form,
                                      Settings const& settings, Projection const& projection, std::uint64_t seed) {
  constexpr double part = 0.1;
  Dictionary stated = dictionary;  // a smoother that goes by the noise goes by the same
  for (std::size_t c = 0; c < stated.channels.size(); ++c) stated.channels[c].noise_sd = projection.noise_sd()[c];
  std::vector<Experiment> moved(experiments.begin(), experiments.end());
  for (std::size_t e = 0; e < moved.size(); ++e)
    for (std::size_t c = 0; c < stated.channels.size(); ++c) {
      Stream stream({seed, Purpose::probe, e, c});
      for (double& value : moved[e].measured[c]) value += part * *stated.channels[c].noise_sd * stream.normal();
    }
  std::unique_ptr<Projection> const other = form.project(stated, moved, settings);
  std::vector<Columns> noise;
  for (int e = 0; e < static_cast<int>(dictionary.equations.size()); ++e) {
    Columns const &here = projection.columns(e), &there = other->columns(e);
    Columns& difference = noise.emplace_back();
    if (any_fatal(projection.concerns(e)) || any_fatal(other->concerns(e)) || here.known.size() != there.known.size()) continue;
    difference.known = (there.known - here.known) / part;
    difference.terms = (there.terms - here.terms) / part;
  }
  return noise;
}

}  // namespace sysid::regression

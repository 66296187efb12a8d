// particles_MODEL.csv, draws_MODEL.csv and polished_MODEL_N.csv to groups.
#include "exchange/selection_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/session/stored_draws.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "exchange/draws_group.hpp"
#include "report/file/selection.hpp"
#include "report/file/task_folder.hpp"
#include "result/selection.hpp"

namespace sysid {
namespace {

/// Names and units of a candidate's parameters, from their summaries.
Draws parameters_of(nlohmann::ordered_json const& summaries) {
  Draws draws;
  for (auto const& [name, summary] : summaries.items()) {
    draws.names.push_back(name);
    draws.units.push_back(summary.value("unit", std::string()));
  }
  draws.parameter_count = static_cast<int>(draws.names.size());
  return draws;
}

void add_weighted(InferenceData& data, std::filesystem::path const& path, Draws particles) {
  std::vector<double> weight, distance, population;
  particles.chains.emplace_back();
  for (std::vector<double> const& row : read_draws_rows(path, {"weight__", "distance__", "population__"}, particles.names)) {
    weight.push_back(row[0]);
    distance.push_back(row[1]);
    population.push_back(row[2]);
    particles.chains.front().values.emplace_back(row.begin() + 3, row.end());
  }
  NetcdfGroup group("weighted_posterior"), stats("weighted_sample_stats");
  add_draws(group, particles);
  add_chain_dimensions(stats, 1, weight.size());
  stats.add({"weight", {"chain", "draw"}, std::move(weight), {}});
  stats.add({"distance", {"chain", "draw"}, std::move(distance), {}});
  stats.add({"population", {"chain", "draw"}, std::move(population), {}});
  data.add(std::move(group));
  data.add(std::move(stats));
}

}  // namespace

std::vector<LivingCandidate> living_candidates(StoredResult const& stored) {
  std::vector<std::string> names;
  auto const models = stored.summary.value("models", nlohmann::ordered_json::object());
  for (auto const& [name, model] : models.items()) names.push_back(name);
  std::vector<std::string> const file_names = model_file_names(names);
  std::vector<LivingCandidate> living;
  for (std::size_t m = 0; m < names.size(); ++m)
    if (std::filesystem::exists(stored.folder / model_draws_file(file_names[m]))) living.push_back({names[m], file_names[m]});
  return living;
}

std::vector<CandidateData> stored_candidates(StoredResult const& stored) {
  std::vector<CandidateData> candidates;
  for (auto const& [name, file] : living_candidates(stored)) {
    nlohmann::ordered_json const& model = stored.summary["models"][name];
    CandidateData candidate{name, file, 0, {provenance(stored), {}, {}}};
    for (auto& [key, value] : candidate.data.attributes)
      if (key == "model") value = name;
    candidate.data.attributes.emplace_back("model_probability", shortest(model.value("probability", 0.0)));
    Draws const parameters = parameters_of(model.value("parameters", nlohmann::ordered_json::object()));
    Draws resampled = parameters;
    resampled.chains.push_back(read_chain(stored.folder / model_draws_file(file), resampled.names));
    NetcdfGroup posterior("posterior");
    add_draws(posterior, resampled);
    candidate.data.add(std::move(posterior));
    auto const particles = stored.folder / particles_file(file);
    bool const by_distance = std::filesystem::exists(particles);
    if (by_distance) add_weighted(candidate.data, particles, parameters);
    // Chains on the likelihood know parameters of the noise, too.
    Draws refined = parameters_of(model.value("polished", nlohmann::ordered_json::object()));
    for (std::size_t c = 0; std::filesystem::exists(stored.folder / refined_file(file, c)); ++c)
      refined.chains.push_back(read_chain(stored.folder / refined_file(file, c), refined.names));
    if (!refined.chains.empty() && !refined.names.empty()) {
      NetcdfGroup group("polished_posterior");
      add_draws(group, refined);
      candidate.data.add(std::move(group));
    }
    candidate.data.omitted.push_back(
        fmt::format("posterior_predictive, log_likelihood, prior, prior_predictive: {}",
                    by_distance ? "a selection by distance does not estimate the noise" : "a selection does not compute them"));
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

void add_candidate_data(Session& session, int select, std::vector<CandidateData>& candidates) {
  selected_candidates(session, select);  // refuses results of another text or other data
  SelectTask const& what = std::get<SelectTask>(session.file.tasks[static_cast<std::size_t>(select)].what);
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(what.candidates)];
  for (std::size_t k = 0; k < set.models.size(); ++k)
    for (CandidateData& candidate : candidates)
      if (candidate.name == set.models[k].name) {
        candidate.place = k;
        add_data(session, what.fits[k], candidate.data);
      }
}

}  // namespace sysid

// Stored draws as they are, and the data beside them.
#include "exchange/inference_data.hpp"

#include "exchange/draws_group.hpp"
#include "exchange/sample_groups.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

Attributes provenance(StoredResult const& stored) {
  return {{"inference_library", "sysid"},
          {"inference_library_version", stored.summary.at("versions").value("sysid", std::string())},
          {"task", stored.task()},
          {"what", stored.what()},
          {"model", stored.summary.value("model", std::string())},
          {"seed", std::to_string(stored.seed())}};
}

InferenceData stored_inference_data(StoredResult const& stored) {
  InferenceData data{provenance(stored), {}, {}};
  Draws const draws = stored_draws(stored);
  NetcdfGroup posterior("posterior"), stats("sample_stats");
  add_draws(posterior, draws);
  add_chain_dimensions(stats, draws.chains.size(), draws.chains.front().values.size());
  auto const add = [&](char const* name, std::vector<double> Chain::*member) {
    std::vector<double> values;
    for (Chain const& chain : draws.chains) values.insert(values.end(), (chain.*member).begin(), (chain.*member).end());
    stats.add({name, {"chain", "draw"}, std::move(values), {}});
  };
  add("lp", &Chain::log_density);
  add("acceptance_rate", &Chain::acceptance);
  add("log_prior", &Chain::log_prior);
  add("log_likelihood", &Chain::log_likelihood);
  data.add(std::move(posterior));
  data.add(std::move(stats));
  return data;
}

void add_data(Session& session, FitTask const& fit, InferenceData& data) {
  Model const& model = session.file.models[static_cast<std::size_t>(fit.model)];
  NetcdfGroup observed("observed_data"), constant("constant_data");
  auto const experiments = load_experiments(session, fit.experiments, model, fit.start, fit.prediction);
  for (ExperimentData const& each : experiments) {
    std::string const label = experiments.size() > 1 ? each.experiment.name : std::string();
    RowsOfExperiment const rows = scored_rows(each.experiment, model.dynamics, label);
    for (NetcdfGroup* group : {&observed, &constant}) add_rows(*group, each.experiment, rows);
    add_measured(observed, model, each.experiment, rows, "", label);
    add_inputs(constant, model, each.experiment, rows, label);
    add_constants(constant, model, each.use, label);
  }
  data.add(std::move(observed));
  data.add(std::move(constant));
}

}  // namespace sysid

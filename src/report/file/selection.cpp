// Models, populations and parameters in columns.
#include "report/file/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "core/text/told_apart.hpp"
#include "core/text/words.hpp"
#include "report/file/csv.hpp"
#include "report/file/number_or_null.hpp"
#include "report/file/task_folder.hpp"
#include "report/text/summary_text.hpp"
#include "result/report.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

/// Three decimals; more where they would read as certain.
std::string model_probability_text(double p) {
  if (p == 0 || p == 1) return fmt::format("{}", p);
  if (p < 1e-6) return "< 1e-6";
  if (p < 0.0005) return fmt::format("{:.1g}", p);
  return p > 0.9995 ? "> 0.999" : fmt::format("{:.3f}", p);
}

/// Against other models: 0 and 1 are rounded then, since an approximate density is positive under each.
std::string compared_probability_text(double p) {
  return model_probability_text(std::clamp(p, std::numeric_limits<double>::min(), std::nextafter(1.0, 0.0)));
}

ReportTable model_table(SelectionReport const& selection) {
  auto const compared =
      std::count_if(selection.likelihoods.begin(), selection.likelihoods.end(), [](auto const& l) { return l.has_value(); });
  bool const checked = compared > 0;
  auto* const by_likelihood = compared > 1 ? &compared_probability_text : &model_probability_text;
  ReportTable table{"models",
                    "Probability: sum of the particles' weights. Share: fraction of the particles (Worden et al., eq. 8.21); it "
                    "is a probability only in population 1.",
                    {"model", "prior", "probability", "share", "died in population"},
                    {}};
  if (checked) table.header.push_back("by likelihood");
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) {
    SelectedModel const& model = selection.result.models[m];
    table.rows.push_back({model.name, model_probability_text(model.prior), model_probability_text(model.probability),
                          model_probability_text(model.share), model.died_in > 0 ? fmt::format("{}", model.died_in) : "-"});
    if (checked) table.rows.back().push_back(selection.likelihoods[m] ? by_likelihood(selection.likelihoods[m]->probability) : "-");
  }
  return table;
}

std::string error_text(double error) {
  return error == 0 ? "-" : error < 1e-6 ? "< 1e-6" : significant(error, error < 0.01 ? 1 : 2);
}

ReportTable jump_table(SelectionReport const& selection) {
  JumpRecord const& jumps = *selection.result.jumps;
  ReportTable table{
      "models",
      "Probability: from the acceptance probabilities of the jumps; errors are one standard error. log BF: log Bayes factor "
      "against the most "
      "probable model. log evidence: by importance sampling, from the same proposals. Jumps: accepted fraction, to "
      "and from the model.",
      {"model", "prior", "probability", "error", "log BF", "error", "log evidence", "error", "jumps to", "jumps from"},
      {}};
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) {
    SelectedModel const& model = selection.result.models[m];
    JumpRecord::OfModel const& of = jumps.models[m];
    bool const visited = std::isfinite(of.log_bayes_factor), weighed = std::isfinite(of.log_evidence);
    table.rows.push_back({model.name, model_probability_text(model.prior),
                          visited ? compared_probability_text(model.probability) : "0", visited ? error_text(of.error) : "-",
                          visited ? fmt::format("{:.2f}", of.log_bayes_factor) : "-", visited ? error_text(of.factor_error) : "-",
                          weighed ? fmt::format("{:.2f}", of.log_evidence) : "-", weighed ? error_text(of.evidence_error) : "-",
                          visited ? fmt::format("{:.2f}", of.accepted_in) : "-",
                          visited ? fmt::format("{:.2f}", of.accepted_out) : "-"});
  }
  return table;
}

ReportTable population_table(SelectionReport const& selection) {
  ReportTable table{"populations",
                    "The column of each model contains its probability, the sum of the weights of its particles.",
                    {"", "threshold", "simulations", "acceptance", "ess"},
                    {}};
  for (SelectedModel const& model : selection.result.models) table.header.push_back(model.name);
  for (std::size_t t = 0; t < selection.result.populations.size(); ++t) {
    PopulationRecord const& record = selection.result.populations[t];
    table.rows.push_back({fmt::format("{}", t + 1), std::isfinite(record.threshold) ? significant(record.threshold, 4) : "none",
                          fmt::format("{}", record.simulated), significant(record.acceptance(), 2), significant(record.ess, 3)});
    for (auto const& model : record.models)
      table.rows.back().push_back(model.particles == 0 ? "-" : model_probability_text(model.probability));
  }
  return table;
}

void add_row(ReportTable& table, Summary const& s, std::string const& from) {
  SummaryText const t = format_summary(s);
  table.rows.push_back({s.name, s.unit, t.mean, t.sd, t.q5, t.median, t.q95});
  if (!from.empty()) table.rows.back().push_back(from);
}

bool is_refined(SelectionReport const& selection, std::size_t m) {
  return m < selection.refined.size() && !selection.refined[m].empty();
}

ReportTable parameter_table(SelectionReport const& selection, std::size_t m) {
  SelectedModel const& model = selection.result.models[m];
  bool const refined = is_refined(selection, m);
  ReportTable table{
      "parameters of " + model.name,
      selection.result.jumps ? "" : "The sd of the particles depends on the threshold and is not that of the posterior.",
      {"", "unit", "mean", "sd", "q5", "median", "q95"},
      {}};
  if (refined) table.header.push_back("from");
  if (!model.absent.empty())
    table.caption +=
        fmt::format("{}Not in this model, so left at their priors: {}.", table.caption.empty() ? "" : "\n", listed(model.absent));
  for (WeightedSummary const& s : model.summaries)
    if (!model.is_absent(s.name)) add_row(table, as_summary(s, effective_particles(model.weight)), refined ? "particles" : "");
  if (refined)
    for (Summary const& s : selection.refined[m])
      if (!model.is_absent(s.name)) add_row(table, s, "likelihood");
  return table;
}

double effective_of(SelectionResult const& result) {
  if (!result.jumps) return result.populations.back().ess;
  std::size_t draws = 0;
  for (SelectedModel const& model : result.models) draws += model.weight.size();
  return static_cast<double>(draws);
}

ReportTable shared_table(SelectionReport const& selection) {
  ReportTable table{"shared parameters",
                    "Averaged over the models that have them, weighted by the probabilities of the models.",
                    {"", "unit", "mean", "sd", "q5", "median", "q95"},
                    {}};
  if (!selection.result.jumps) table.caption += " These are averages of particles, whose spread depends on the threshold.";
  for (WeightedSummary const& s : selection.shared) add_row(table, as_summary(s, effective_of(selection.result)), "");
  return table;
}

Json weighted_json(WeightedSummary const& s) {
  return {{"unit", s.unit}, {"mean", s.mean}, {"median", s.median}, {"sd", s.sd}, {"q5", s.q5}, {"q95", s.q95}};
}

std::string populations_csv(Report const& report) {
  SelectionReport const& selection = *report.selection;
  std::string out = csv_head(report) + "population,threshold,proposals,simulations,failed,accepted,ess";
  for (SelectedModel const& model : selection.result.models)
    for (char const* what : {"probability", "share", "proposals", "nearest"})
      out += "," + csv_field(fmt::format("{} {}", model.name, what));
  out += '\n';
  for (std::size_t t = 0; t < selection.result.populations.size(); ++t) {
    PopulationRecord const& r = selection.result.populations[t];
    out += fmt::format("{},{},{},{},{},{},{}", t + 1, shortest(r.threshold), r.proposed, r.simulated, r.failed, r.accepted,
                       shortest(r.ess));
    for (std::size_t m = 0; m < r.models.size(); ++m)
      out += fmt::format(",{},{},{},{}", shortest(r.models[m].probability), shortest(r.share(static_cast<int>(m))),
                         r.models[m].proposed, shortest(r.models[m].nearest));
    out += '\n';
  }
  return out;
}

std::string particles_csv(Report const& report, SelectedModel const& model) {
  auto const population =
      model.died_in > 0 ? static_cast<std::size_t>(model.died_in - 1) : report.selection->result.populations.size();
  std::string out = csv_head(report, model.name) + fmt::format("# candidate = {}\nweight__,distance__,population__", model.name);
  for (ParameterInfo const& parameter : model.parameters) out += "," + csv_field(stan_name(parameter.name));
  out += '\n';
  for (std::size_t j = 0; j < model.weight.size(); ++j) {
    out += fmt::format("{},{},{}", shortest(model.weight[j]), shortest(model.distance[j]), population);
    for (int d = 0; d < model.declared.rows(); ++d) out += "," + shortest(model.declared(d, static_cast<int>(j)));
    out += '\n';
  }
  return out;
}

/// Draws of a model of next to no probability are kept, but are no result.
bool hardly_visited(SelectionResult const& result, std::size_t m) { return result.jumps && result.models[m].probability < 0.01; }

Json jumps_json(SelectionReport const& selection) {
  JumpRecord const& jumps = *selection.result.jumps;
  Json out = {{"chains", jumps.chains}, {"samples", jumps.samples}, {"burn_in", jumps.burn_in}};
  std::uint64_t simulations = 0;
  for (auto const& each : jumps.models) simulations += each.simulations;
  out["simulations"] = simulations;
  return out;
}

void add_jumps(JumpRecord::OfModel const& of, Json& entry) {
  entry["probability_error"] = of.error;
  entry["log_bayes_factor"] = number_or_null(of.log_bayes_factor);
  entry["log_bayes_factor_error"] = number_or_null(of.factor_error);
  entry["log_evidence"] = number_or_null(of.log_evidence);
  entry["log_evidence_error"] = number_or_null(of.evidence_error);
  entry["proposals_worth"] = of.worth;
  entry["visits"] = of.visits;
  entry["log_bias"] = of.bias;
  entry["jumps_accepted"] = {{"to", of.accepted_in}, {"from", of.accepted_out}, {"within", of.accepted_within}};
  entry["simulations"] = of.simulations;
  if (!of.solver.empty()) entry["solver"] = of.solver;
}

}  // namespace

std::vector<std::string> model_file_names(std::vector<std::string> const& models) {
  std::vector<std::string> names;
  for (std::string const& model : models) {
    std::string& name = names.emplace_back();
    for (char const c : model)
      if (c == '.' || c == '(' || c == ')' || c == '=' || c == ',' || c == '_' || c == '-' ||
          std::isalnum(static_cast<unsigned char>(c)))
        name += c;
  }
  return told_apart(std::move(names));
}

std::vector<std::string> model_file_names(SelectionResult const& selection) {
  std::vector<std::string> names;
  for (SelectedModel const& model : selection.models) names.push_back(model.name);
  return model_file_names(names);
}

std::vector<ReportTable> selection_tables(SelectionReport const& selection) {
  std::vector<ReportTable> tables;
  if (selection.result.jumps)
    tables = {jump_table(selection)};
  else
    tables = {model_table(selection), population_table(selection)};
  for (std::size_t m = 0; m < selection.result.models.size(); ++m)
    if (selection.result.models[m].died_in == 0 && !hardly_visited(selection.result, m) &&
        (!selection.result.models[m].summaries.empty() || is_refined(selection, m)))
      tables.push_back(parameter_table(selection, m));
  if (!selection.shared.empty()) tables.push_back(shared_table(selection));
  if (!selection.shared_unmoved.empty()) {
    ReportTable table{"shared parameters whose posterior equals their prior", "", {"", "unit", "prior", "because"}, {}};
    for (auto const& each : selection.shared_unmoved) table.rows.push_back({each.name, each.unit, each.prior, each.why});
    tables.push_back(std::move(table));
  }
  return tables;
}

nlohmann::ordered_json models_json(SelectionReport const& selection) {
  Json out = Json::object();
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) {
    SelectedModel const& model = selection.result.models[m];
    Json& entry = out[model.name];
    entry = {{"prior", model.prior}, {"probability", model.probability}};
    if (selection.result.jumps) {
      add_jumps(selection.result.jumps->models[m], entry);
    } else {
      entry["share"] = model.share;
      entry["died_in_population"] = model.died_in > 0 ? Json(model.died_in) : Json(nullptr);
    }
    if (model.died_in > 0) entry["died_by_chance"] = model.by_chance;
    for (auto const& [name, value] : model.simulated_with)
      std::visit([&, key = name](auto const& each) { entry["simulated_with"][key] = each; }, value);
    if (m < selection.likelihoods.size() && selection.likelihoods[m]) {
      LikelihoodCheck const& check = *selection.likelihoods[m];
      entry["laplace"] = {{"log_evidence", check.log_evidence}, {"probability", check.probability}};
      if (!check.solver.empty()) entry["laplace"]["solver"] = check.solver;
      if (check.given_up) entry["laplace"]["given_up"] = true;
    }
    entry["parameters"] = Json::object();
    if (model.died_in > 0) continue;
    for (WeightedSummary const& s : model.summaries) entry["parameters"][s.name] = weighted_json(s);
    if (!is_refined(selection, m)) continue;
    for (Summary const& s : selection.refined[m])
      entry["polished"][s.name] = {
          {"unit", s.unit}, {"mean", s.mean},         {"median", s.median},    {"sd", s.sd}, {"q5", s.q5}, {"q95", s.q95},
          {"rhat", s.rhat}, {"ess_bulk", s.ess_bulk}, {"ess_tail", s.ess_tail}};
  }
  return out;
}

nlohmann::ordered_json populations_json(SelectionReport const& selection) {
  Json out = Json::object();
  if (selection.result.jumps) {
    out = jumps_json(selection);
  } else {
    out["count"] = selection.result.populations.size();
    std::uint64_t simulated = 0;
    for (PopulationRecord const& each : selection.result.populations) simulated += each.simulated;
    out["simulations"] = simulated;
    out["distance"] = selection.distance;
    out["threshold"] = selection.result.threshold;
    out["next_threshold"] = selection.result.next_threshold;
    out["noise_floor"] = selection.floor ? Json(*selection.floor) : Json(nullptr);
    out["ess"] = selection.result.populations.back().ess;
    out["stopped_by"] = selection.result.stopped_by;
  }
  if (!selection.shared.empty())
    for (WeightedSummary const& s : selection.shared) out["shared"][s.name] = weighted_json(s);
  for (auto const& each : selection.shared_unmoved)
    out["shared"][each.name] = {{"unit", each.unit}, {"prior", each.prior}, {"because", each.why}};
  return out;
}

std::vector<std::pair<std::string, std::string>> selection_files(Report const& report) {
  SelectionReport const& selection = *report.selection;
  bool const by_distance = !selection.result.jumps;
  std::vector<std::pair<std::string, std::string>> files;
  if (by_distance) files.emplace_back("populations.csv", populations_csv(report));
  std::vector<std::string> const names = model_file_names(selection.result);
  for (std::size_t m = 0; m < selection.result.models.size(); ++m) {
    SelectedModel const& model = selection.result.models[m];
    if (model.weight.empty()) continue;
    if (by_distance) files.emplace_back(particles_file(names[m]), particles_csv(report, model));
    if (model.died_in > 0) continue;
    Report of_model;
    of_model.version = report.version;
    of_model.task = report.task;
    of_model.what = report.what;
    of_model.model_name = model.name;
    of_model.seed = report.seed;
    of_model.settings = report.settings;
    of_model.data = report.data;
    of_model.draws = resampled_draws(model, selection.resampling_seed);
    files.emplace_back(model_draws_file(names[m]), draws_csv(of_model, 0));
    if (m >= selection.refined_draws.size()) continue;
    of_model.draws = selection.refined_draws[m];
    for (std::size_t c = 0; c < of_model.draws.chains.size(); ++c)
      files.emplace_back(refined_file(names[m], c), draws_csv(of_model, static_cast<int>(c)));
  }
  return files;
}

}  // namespace sysid

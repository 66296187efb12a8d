// JSON by nlohmann's ordered objects: order of insertion, round-trip decimals.
#include "report/file/summary_json.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"
#include "report/file/calibration.hpp"
#include "report/file/discovery.hpp"
#include "report/file/selection.hpp"
#include "report/file/task_folder.hpp"
#include "report/text/report_text.hpp"
#include "report/text/states_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sysid {

namespace {

using Json = nlohmann::ordered_json;

Json facts(Facts const& facts) {
  Json out = Json::object();
  for (auto const& [name, value] : facts) std::visit([&, &key = name](auto const& v) { out[key] = v; }, value);
  return out;
}

Json score_object(std::vector<Score> const& scores) {
  Json out = Json::object();
  for (Score const& score : scores) out[text_of(score.name)] = score.value;
  return out;
}

Json parameters(std::vector<Summary> const& summaries) {
  Json out = Json::object();
  for (Summary const& s : summaries) {
    out[s.name] = {{"unit", s.unit},
                   {"mean", s.mean},
                   {"median", s.median},
                   {"sd", s.sd},
                   {"mad", s.mad},
                   {"q5", s.q5},
                   {"q95", s.q95},
                   {"rhat", s.rhat},
                   {"ess_bulk", s.ess_bulk},
                   {"ess_tail", s.ess_tail},
                   {"mcse_mean", s.mcse_mean}};
    if (!s.without_sd.empty()) out[s.name]["without_sd"] = s.without_sd;
  }
  return out;
}

/// How the sds of an optimum come about; of what has none stands why.
void add_sd_methods(Report const& report, Json& out) {
  auto const derived = [&](std::string const& name) {
    auto const first = report.draws.names.begin() + report.draws.parameter_count;
    return std::find(first, report.draws.names.end(), name) != report.draws.names.end();
  };
  for (Summary const& s : report.summary)
    if (std::isfinite(s.sd)) out[s.name]["sd_by"] = derived(s.name) ? "delta_method" : "laplace";
}

/// Where draws were thinned, `parameters` are of all iterations: those of the kept ones, which other programs take from the files.
Json kept_draws(Report const& report) {
  std::vector<Summary> summaries;
  ConvergenceTables tables;
  for (std::size_t c = 0; c < report.draws.names.size(); ++c) {
    ChainValues values;
    for (Chain const& chain : report.draws.chains) {
      values.emplace_back();
      for (auto const& draw : chain.values) values.back().push_back(draw[c]);
    }
    summaries.push_back(summarise(report.draws.names[c], report.draws.units[c], values, tables));
  }
  return parameters(summaries);
}

bool thinned(Report const& report) {
  for (auto const& [name, value] : report.settings)
    if (auto const* thin = std::get_if<std::int64_t>(&value); name == "thin" && thin != nullptr) return *thin > 1;
  return false;
}

Json named_values(std::vector<double> const& values, std::vector<std::string> const& names) {
  Json out = Json::object();
  for (std::size_t i = 0; i < values.size() && i < names.size(); ++i) out[names[i]] = values[i];
  return out;
}

/// What a fit says of its model as a whole.
Json evidence(Evidence const& evidence) {
  if (!evidence.log_evidence) return {{"log_evidence", nullptr}, {"reason", evidence.reason}};
  Json out = {{"log_evidence", *evidence.log_evidence}, {"method", word(evidence.method)}};
  if (evidence.error) {
    out["standard_error"] = *evidence.error;
    out["effective_draws"] = std::round(evidence.effective);
    out["simulations"] = evidence.simulations;
  }
  if (!evidence.doubt.empty()) out["not_confirmed"] = evidence.doubt;
  out["laplace"] = evidence.laplace ? Json(*evidence.laplace) : Json(nullptr);
  if (!evidence.laplace && !evidence.without_laplace.empty()) out["without_laplace"] = evidence.without_laplace;
  out["along_axes"] = std::round(1e3 * evidence.along_axes) / 1e3 + 0.0;  // how rough Laplace's is, no more; never -0
  out["modes"] = evidence.modes;
  SampledEvidence const& sampled = evidence.sampled;
  if (evidence.method != EvidenceMethod::laplace) return out;
  bool const known = sampled.state == SampledEvidence::State::known;
  if (sampled.differs() || (known && std::fabs(evidence.along_axes) > 0.1)) {
    out["by_draws"] = std::round(1e3 * sampled.above) / 1e3 + 0.0;
    out["by_draws_error"] = std::round(1e3 * sampled.error) / 1e3;
  } else if (sampled.state == SampledEvidence::State::unknown) {
    out["by_draws"] = nullptr;
  }
  return out;
}

Json log_score(LogScore const& score) {
  return {{"elpd", score.sum}, {"error", score.error}, {"monte_carlo_error", score.monte_carlo_error}, {"samples", score.samples}};
}

Json left_out(LogScore const& score, std::vector<LeftOutBlocks> const& blocks) {
  Json out = log_score(score);
  for (LeftOutBlocks const& each : blocks)
    out["records"].push_back({{"name", each.experiment},
                              {"first_row", each.first_row},
                              {"last_row", each.last_row},
                              {"blocks", each.asked},
                              {"own_draws", each.own_draws},
                              {"pareto_k", each.pareto_k}});
  return out;
}

/// Predictive scores and information criteria: the latter on the scale of the deviance, the former in nats.
Json criteria(Criteria const& criteria) {
  Json out = Json::object();
  if (auto const& mode = criteria.at_mode)
    out = {{"at", mode->of_likelihood ? "maximum of the likelihood" : "mode of the posterior"},
           {"log_likelihood", mode->log_likelihood},
           {"parameters", mode->parameters},
           {"samples", mode->samples},
           {"aic", mode->aic()},
           {"bic", mode->bic()}};
  if (auto const& deviance = criteria.deviance) {
    auto const p_d = deviance->p_d();
    out["dic"] = {{"value", p_d ? Json(deviance->mean + *p_d) : Json(nullptr)},
                  {"p_d", p_d ? Json(*p_d) : Json(nullptr)},
                  {"value_by_variance", deviance->mean + deviance->p_v()},
                  {"p_v", deviance->p_v()}};
  }
  if (!criteria.reason.empty()) out["reason"] = criteria.reason;
  if (!criteria.loo) return out;
  out["draws"] = criteria.draws;
  out["in_time"] = criteria.in_time;
  ParetoCounts const& k = criteria.pareto_counts;
  out["waic"] = {
      {"elpd", criteria.waic->sum}, {"error", criteria.waic->error}, {"p", criteria.p_waic}, {"unstable", criteria.unstable_waic}};
  out["loo"] = log_score(*criteria.loo);
  out["loo"]["p"] = criteria.p_loo;
  out["loo"]["pareto_k"] = {{"largest", criteria.worst_k},
                            {"to_0.5", k[0]},
                            {"to_0.7", k[1]},
                            {"to_1", k[2]},
                            {"above_1", k[3]},
                            {"limit", largest_k(criteria.draws)},
                            {"above_limit", criteria.doubtful}};
  if (criteria.block) out["leave_block_out"] = left_out(*criteria.block, criteria.blocks);
  if (!criteria.futures.empty())
    out["leave_future_out"] = criteria.future ? left_out(*criteria.future, criteria.futures) : Json(nullptr);
  return out;
}

/// By factor on the width; null where the draws do not tell.
Json prior_widths(std::vector<PriorWidth> const& effects) {
  Json out = {{"factors", Json::array()}, {"parameters", Json::object()}};
  auto const rounded = [](double value) { return std::round(1e3 * value) / 1e3 + 0.0; };
  for (PriorWidth const& each : effects) {
    if (each.parameter == effects.front().parameter) out["factors"].push_back(each.factor);
    Json& entry = each.parameter.empty() ? out["all"] : out["parameters"][each.parameter];
    entry["change"].push_back(each.change ? Json(rounded(*each.change)) : Json(nullptr));
    entry["error"].push_back(each.change ? Json(rounded(each.error)) : Json(nullptr));
  }
  return out;
}

Json ledger(Ledger const& ledger, std::vector<std::string> const& names) {
  Json failures = Json::array();
  for (Failure const& failure : ledger.failures())
    failures.push_back({{"class", name(failure.kind)},
                        {"where", failure.where},
                        {"count", failure.count},
                        {"time", std::isnan(failure.time) ? Json(nullptr) : Json(failure.time)},
                        {"example", named_values(failure.example, failure.names.empty() ? names : failure.names)}});
  return {{"solves", ledger.solves()}, {"failed", ledger.failed()}, {"failures", failures}};
}

/// Per channel of each experiment; of a single one at the top as well.
Json fit(std::vector<FitLine> const& lines) {
  Json out = Json::object(), channels = Json::object();
  for (FitLine const& line : lines) {
    if (lines.size() == 1 || line.channel.empty()) out = score_object(line.scores);
    if (!line.channel.empty()) channels[line.experiment][line.channel] = score_object(line.scores);
  }
  if (!channels.empty()) out["channels"] = channels;
  return out;
}

/// Those of a maximum-likelihood fit beside particles apart.
Json fit(Report const& report) {
  std::vector<FitLine> found = fit_lines(report), optimum;
  auto const rest = std::stable_partition(found.begin(), found.end(), [](FitLine const& each) { return each.optimum_of.empty(); });
  optimum.assign(rest, found.end());
  found.erase(rest, found.end());
  Json out = fit(found);
  if (!optimum.empty()) out["maximum_likelihood"] = fit(optimum);
  return out;
}

Json scores(AverageScores const& scores) {
  return {{"log_score", scores.log_score}, {"nmse", scores.nmse}, {"rmse", scores.rmse}, {"coverage_95", scores.coverage_95}};
}

/// Members by their weights, and on each channel of each record the scores of the average beside theirs.
Json average(AverageReport const& average) {
  Json out = {
      {"weights", word(average.weights)}, {"members", Json::array()}, {"scores", Json::object()}, {"variance", Json::object()}};
  for (AveragedMember const& member : average.members) {
    out["members"].push_back({{"fit", member.fit}, {"model", member.model}, {"weight", member.weight}, {"draws", member.draws}});
    if (member.error) out["members"].back()["weight_error"] = *member.error;
    if (!member.counted.empty()) out["members"].back()["counted_with"] = member.counted;
  }
  for (AveragedChannel const& channel : average.channels) {
    Json& entry = out["scores"][channel.experiment][channel.channel];
    entry = {{"samples", channel.samples}, {"average", scores(channel.average)}, {"members", Json::object()}};
    for (std::size_t k = 0; k < channel.members.size(); ++k) entry["members"][average.members[k].fit] = scores(channel.members[k]);
  }
  for (VarianceShares const& each : average.shares)
    out["variance"][each.experiment][each.quantity] = {
        {"unit", each.unit}, {"sd", each.sd}, {"parameter", each.parameter}, {"model", each.model}, {"noise", each.noise}};
  return out;
}

/// Random states and disturbances along each record, as large as they are and as surely as they are known.
Json states(Report const& report) {
  Json out = Json::object();
  std::vector<std::string> const files = states_files(report);
  for (std::size_t e = 0; e < report.states.size(); ++e) {
    Json& along = out[report.states[e].experiment];
    along = {{"file", files[e]}, {"draws", 0}, {"quantities", Json::object()}};
    for (PredictedQuantity const& each : report.states[e].quantities) {
      StateSize const size = size_of(each);
      along["draws"] = each.response.draws - each.response.excluded;
      along["quantities"][each.name] = {
          {"unit", each.unit}, {"mean_between_samples", each.average}, {"rms", size.rms}, {"sd", size.sd}};
    }
  }
  return out;
}

/// Those that do not apply say why.
Json checks(std::vector<CheckRecord> const& records) {
  Json out = Json::array();
  for (CheckRecord const& each : records) {
    out.push_back({{"name", each.name}, {"ran", each.skipped.empty()}});
    if (!each.skipped.empty()) out.back()["reason"] = each.skipped;
  }
  return out;
}

Json findings_json(Findings const& all) {
  Json out = Json::array();
  for (Finding const& finding : all)
    out.push_back({{"severity", severity_word(finding.severity)},
                   {"code", word(finding.code)},
                   {"names", finding.names},
                   {"message", finding.message},
                   {"help", finding.help}});
  return out;
}

Json modes_json(Report const& report) {
  Json out = Json::array();
  for (Mode const& mode : report.modes)
    out.push_back({{"log_density", mode.log_density},
                   {"log_mass", mode.log_mass},
                   {"share", mode.share},
                   {"values", named_values(mode.declared, report.sampled_names)},
                   {"sd", named_values(mode.sd, report.sampled_names)}});
  return out;
}

Json data_json(std::vector<DataInfo> const& all) {
  Json out = Json::array();
  for (DataInfo const& each : all)
    out.push_back({{"name", each.name},
                   {"file", each.file},
                   {"sha256", each.sha256},
                   {"rows", each.rows},
                   {"scored", each.scored},
                   {"scored_rows", each.scored_rows},
                   {"samples_sha256", each.samples_sha256},
                   {"inputs_sha256", each.inputs_sha256},
                   {"notes", each.notes}});
  return out;
}

/// The user's text may hold any bytes: what is not UTF-8 is replaced, never thrown.
std::string dump(Json const& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string summary_json(Report const& report, FileDigests const& files) {
  Json out;
  out["task"] = report.task;
  out["what"] = report.what;
  out["verb"] = report.verb;
  out["prediction_rule"] = report.prediction_rule;
  out["measured_past"] = report.measured_past;
  out["lags"] = report.lags;
  out["model"] = report.model_name;
  out["parameters"] = parameters(report.summary);
  if (report.draws.is_optimum()) add_sd_methods(report, out["parameters"]);
  if (thinned(report) && report.draws.total() > 1) out["kept_draws"] = kept_draws(report);
  if (report.selection) {
    out["models"] = models_json(*report.selection);
    out[report.selection->result.jumps ? "jumps" : "populations"] = populations_json(*report.selection);
  }
  if (report.discovery) out["discovery"] = discovery_json(*report.discovery);
  if (report.average) out["average"] = average(*report.average);
  if (report.calibration) out["calibration"] = calibration_json(*report.calibration);
  if (has_verdict(report)) out["verdict"] = {{"pass", grade(report) != Severity::error}, {"text", verdict_headline(report)}};
  out["findings"] = findings_json(report.findings);
  if (!report.checks.empty()) out["checks"] = checks(report.checks);
  out["fit"] = fit(report);
  out["modes"] = modes_json(report);
  if (report.evidence) {
    out["evidence"] = evidence(*report.evidence);
    if (!report.prior_widths.empty()) out["evidence"]["prior_widths"] = prior_widths(report.prior_widths);
    out["parameter_count"] = report.draws.parameter_count;
    out["noise"] = report.noise;
  }
  if (report.criteria) out["criteria"] = criteria(*report.criteria);
  if (!report.states.empty()) out["states"] = states(report);
  for (ReportTable const& table : report.tables) out["tables"][table.title] = {{"header", table.header}, {"rows", table.rows}};
  out["ledger"] = ledger(report.ledger, report.sampled_names);
  out["seed"] = report.seed;
  out["versions"] = facts(report.versions);
  out["versions"]["form"] = stored_form;
  out["versions"]["files"] = files;
  out["versions"]["summary_sha256"] = unsealed();
  out["data"] = data_json(report.data);
  out["settings"] = facts(report.settings);
  return sealed_summary(dump(out));
}

std::string timing_json(Report const& report) { return dump(facts(report.timing)); }

}  // namespace sysid

// Reads stored summaries into tables, and rejects results that cannot be compared.
#include "app/comparison/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "app/comparison/compare_scores.hpp"
#include "app/comparison/compared_evidence.hpp"
#include "app/session/made_from.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "model/lags.hpp"
#include "report/file/replacement.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

constexpr double rough = 0.5;  // nats

struct StoredSummary {
  fs::path folder;
  std::string name;
  json summary;
  std::string model;               // as it is called here
  std::optional<Finding> earlier;  // that it was made from a fit which has been run again

  bool is(std::string_view verb) const { return summary.value("verb", std::string()) == verb; }
  int lags() const { return summary.value("lags", 0); }
  int warnings() const {
    json const findings = summary.value("findings", json::array());
    return static_cast<int>(std::count_if(findings.begin(), findings.end(),
                                          [](json const& each) { return each.value("severity", "") == "warning"; })) +
           (earlier ? 1 : 0);
  }
  bool pass() const { return !summary.contains("verdict") || summary["verdict"].value("pass", true); }
};

UserError not_comparable(std::string message, Help help) {
  return UserError(result_error("", std::move(message), std::move(help)));
}
UserError not_comparable(std::string message, std::string help) {
  return UserError({Severity::error, "", std::move(message), std::nullopt, {}, std::move(help)});
}

StoredSummary read_summary(fs::path const& folder) {
  StoredSummary result{folder,
                       folder.lexically_normal().filename().string(),
                       json::parse(read_whole_summary(folder)),
                       {},
                       made_from_earlier(folder)};
  if (result.name.empty()) result.name = folder.lexically_normal().parent_path().filename().string();
  interpreted(folder / "summary.json", [&] { return result.is(""); });
  result.model = interpreted(folder / "summary.json", [&] {
    std::size_t const averaged = result.summary.value("average", json::object()).value("members", json::array()).size();
    return averaged > 0 ? fmt::format("average of {}", averaged) : result.summary.value("model", std::string());
  });
  return result;
}

/// Those of one folder: its own, or of a whole run those of its tasks, by name.
std::vector<StoredSummary> results_in(fs::path const& folder) {
  if (!fs::is_directory(folder)) throw no_results_folder(folder);
  std::vector<StoredSummary> found;
  if (summary_stands(folder)) {
    found.push_back(read_summary(folder));
  } else {
    std::set<fs::path> tasks;
    for (fs::directory_entry const& entry : fs::directory_iterator(folder))
      if (summary_stands(entry.path())) tasks.insert(entry.path());
    for (fs::path const& task : tasks) found.push_back(read_summary(task));
  }
  std::vector<std::string> others;  // results without an evidence or an error of prediction
  for (StoredSummary const& each : found)
    if (!each.is("fit") && !each.is("predict"))
      others.push_back(fmt::format("the {} `{}`",
                                   each.is("select")       ? "selection"
                                   : each.is("calibrate")  ? "calibration"
                                   : each.is("crosscheck") ? "crosscheck"
                                   : each.is("track")      ? "track"
                                                           : "discovery",
                                   each.name));
  std::erase_if(found, [](StoredSummary const& each) { return !each.is("fit") && !each.is("predict"); });
  if (found.empty() && !others.empty())
    throw not_comparable(
        fmt::format("`{}` contains {}, but no result of a fit or a prediction", folder.string(), fmt::join(others, ", ")),
        fmt::format("`sysid report {}` shows these results; `compare` compares only fits and predictions", folder.string()));
  if (found.empty())
    throw not_comparable(fmt::format("`{}` contains no result of a fit or a prediction", folder.string()),
                         "give folders of tasks, such as results/posterior, or of whole runs, such as results");
  return found;
}

/// Tasks of one name are told apart by their folders.
void tell_apart(std::vector<StoredSummary>& results) {
  std::map<std::string, int> count;
  for (StoredSummary const& each : results) ++count[each.name];
  for (StoredSummary& each : results)
    if (count[each.name] > 1) each.name = each.folder.string();
}

/// "flume.train, rows 101..500 (400 scored)".
std::string data_text(StoredSummary const& result) {
  std::string text;
  for (json const& data : result.summary.at("data"))
    text += fmt::format("{}{}, rows {} ({} scored)", text.empty() ? "" : "; ", data.value("name", ""),
                        data.value("scored_rows", ""), data.value("scored", 0));
  return text;
}

/// Digests of the samples in any order: a likelihood is their product.
std::vector<std::string> samples_of(StoredSummary const& result) {
  std::vector<std::string> all;
  for (json const& data : result.summary.at("data")) {
    std::string const digest = data.value("samples_sha256", "");
    if (digest.empty())
      throw not_comparable(fmt::format("`{}` does not record which samples it was fitted to", result.folder.string()),
                           run_again("it was written by an earlier program: "));
    all.push_back(digest);
  }
  std::sort(all.begin(), all.end());
  return all;
}

void require_same_samples(StoredSummary const& one, StoredSummary const& other) {
  if (samples_of(one) == samples_of(other)) return;
  std::string const message = fmt::format("`{}` and `{}` are fitted to different samples: {} and {}", one.name, other.name,
                                          data_text(one), data_text(other));
  if (data_text(one) != data_text(other)) {
    bool const looks_back = one.lags() > 0 || other.lags() > 0;
    throw not_comparable(
        message,
        looks_back
            ? "evidences can be compared only for the same samples: begin the fitted rows after the longest lag of all models"
            : "evidences can be compared only for the same samples: give folders of fits to the same rows");
  }
  throw not_comparable(message + " of other files, channels or units",
                       "evidences can be compared only for the same samples: give folders of fits to the same samples");
}

std::string noise_text(json const& summary) {
  std::string text;
  for (json const& name : summary.value("noise", json::array())) {
    json const& parameter = summary.at("parameters").value(name.get<std::string>(), json::object());
    if (!parameter.contains("mean") || !parameter["mean"].is_number()) continue;
    text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", name.get<std::string>(),
                        significant(parameter["mean"].get<double>(), 3), unit_after_number(parameter.value("unit", "")));
  }
  return text;
}

ComparedFit compared_fit(StoredSummary const& result) {
  json const& summary = result.summary;
  ComparedFit fit;
  fit.name = result.name;
  fit.model = result.model;
  fit.pass = result.pass();
  fit.warnings = result.warnings();
  fit.parameters = summary.value("parameter_count", 0);
  fit.noise = noise_text(summary);
  json const evidence = summary.value("evidence", json::object());
  if (evidence.contains("log_evidence") && evidence["log_evidence"].is_number()) {
    fit.log_evidence = evidence["log_evidence"].get<double>();
    fit.not_confirmed = evidence.value("not_confirmed", "");
    if (evidence.contains("standard_error")) {  // what the axes say is of Laplace's approximation
      fit.error = evidence["standard_error"].get<double>();
      return fit;
    }
    double const along = evidence.value("along_axes", 0.0);
    json const by_draws = evidence.value("by_draws", json(along));  // absent: they confirm it, or were not drawn
    double const off = by_draws.is_number() ? by_draws.get<double>() : along;
    if (std::fabs(off) >= rough) fit.rough = off;
    fit.rough_by_draws = evidence.contains("by_draws") && by_draws.is_number();
  } else {
    fit.without = evidence.value("reason", std::string("the run was interrupted"));
  }
  return fit;
}

std::string model_text(StoredSummary const& result) {
  return result.summary.value("versions", json::object()).value("model_sha256", "");
}

/// A model, how its likelihood reads the record, and the inputs that it is given: fits that agree in it are of one and the same
/// model.
struct Identity {
  std::string text, start, prediction_rule, files, inputs;

  friend bool operator==(Identity const&, Identity const&) = default;
  std::string whole() const { return json({text, start, prediction_rule, files, inputs}).dump(); }
};

Identity identity(StoredSummary const& result) {
  std::vector<std::string> files, inputs;  // in any order
  for (json const& data : result.summary.at("data")) {
    files.push_back(data.value("sha256", ""));
    inputs.push_back(data.value("inputs_sha256", ""));
  }
  std::sort(files.begin(), files.end());
  std::sort(inputs.begin(), inputs.end());
  return {model_text(result), result.summary.value("settings", json::object()).value("start_state", ""),
          result.summary.value("prediction_rule", ""), json(files).dump(), json(inputs).dump()};
}

/// In what they differ.
std::string difference_of(std::vector<Identity> const& identities) {
  struct Part {
    std::string Identity::*member;
    char const* words;
  };
  std::vector<std::string> parts;
  for (Part const& part : {Part{&Identity::text, "the text of the model"}, Part{&Identity::start, "the start"},
                           Part{&Identity::prediction_rule, "the prediction rule"}, Part{&Identity::files, "the data files"},
                           Part{&Identity::inputs, "the inputs, constants or the rule between samples"}})
    if (std::ranges::any_of(identities, [&](Identity const& each) { return each.*part.member != identities.front().*part.member; }))
      parts.emplace_back(part.words);
  return listed(parts);
}

/// Which fits of models of one name are not of the same, as an equation before and after a change.
std::vector<std::string> models_of_one_name(std::vector<StoredSummary> const& results) {
  std::vector<std::string> notes;
  std::set<std::string> told;
  for (StoredSummary const& first : results) {
    if (!told.insert(first.model).second) continue;
    std::vector<Identity> identities;  // one entry each per model of this name
    std::vector<std::string> fits;
    for (StoredSummary const& each : results) {
      if (each.model != first.model) continue;
      Identity const own = identity(each);
      auto const known = std::find(identities.begin(), identities.end(), own);
      if (known == identities.end()) {
        identities.push_back(own);
        fits.push_back(each.name);
      } else {
        fits[static_cast<std::size_t>(known - identities.begin())] += ", " + each.name;
      }
    }
    if (fits.size() > 1)
      notes.push_back(
          fmt::format("the fits of `{}` differ in {}: {}", first.model, difference_of(identities), fmt::join(fits, "; ")));
  }
  return notes;
}

std::string kind_of(json const& summary) {
  std::string const rule = summary.value("prediction_rule", "");
  if (rule == prediction_name(PredictionRule::free_run)) return "free run";
  if (rule == prediction_name(PredictionRule::one_step)) return "one step";
  if (rule == prediction_name(PredictionRule::as_written)) return summary.value("measured_past", false) ? "one step" : "free run";
  return rule;  // none, a number of steps, or mixed_kinds
}

void add_predictions(StoredSummary const& result, std::vector<ComparedPrediction>& predictions) {
  json const channels = result.summary.value("fit", json::object()).value("channels", json::object());
  for (json const& data : result.summary.at("data")) {
    std::string const experiment = data.value("name", "");
    json const of_experiment = channels.value(experiment, json::object());
    for (auto const& [channel, scores] : of_experiment.items()) {
      if (!scores.contains("nmse") || !scores["nmse"].is_number()) continue;
      ComparedPrediction each{result.name,
                              result.model,
                              kind_of(result.summary),
                              channel + " on " + experiment,
                              data.value("scored_rows", ""),
                              scores["nmse"].get<double>(),
                              {},
                              result.pass(),
                              result.warnings(),
                              data.value("samples_sha256", "")};
      if (scores.contains("coverage_95") && scores["coverage_95"].is_number()) each.coverage = scores["coverage_95"].get<double>();
      // An average of one-step predictions and free runs is neither, and stands with others of its kind.
      auto const same = [&](ComparedPrediction const& other) {
        return other.samples == each.samples && other.on == each.on && (other.kind == mixed_kinds) == (each.kind == mixed_kinds);
      };
      auto const last = std::find_if(predictions.rbegin(), predictions.rend(), same);
      predictions.insert(last == predictions.rend() ? predictions.end() : last.base(), std::move(each));
    }
  }
}

/// All that is read of a summary, once.
void require_readable(StoredSummary const& result) {
  interpreted(result.folder / "summary.json", [&] {
    (void)result.lags();
    (void)data_text(result);
    (void)identity(result);
    for (json const& data : result.summary.at("data")) (void)data.value("samples_sha256", "");
    std::vector<ComparedPrediction> predictions;
    add_predictions(result, predictions);
    if (result.is("fit")) (void)compared_fit(result);
    return true;
  });
}

}  // namespace

Comparison compare(std::vector<fs::path> const& folders, ModelNames const& model_of) {
  std::vector<StoredSummary> results;
  for (fs::path const& folder : folders)
    for (StoredSummary& each : results_in(folder)) {
      bool const known = std::any_of(results.begin(), results.end(),
                                     [&](StoredSummary const& other) { return fs::equivalent(other.folder, each.folder); });
      if (!known) results.push_back(std::move(each));
    }
  if (model_of)
    for (StoredSummary& each : results) each.model = model_of(each.name, each.model);
  for (StoredSummary const& each : results) require_readable(each);
  tell_apart(results);
  Comparison comparison;
  std::vector<StoredSummary> fits;
  for (StoredSummary const& each : results) {
    if (each.is("predict")) {
      add_predictions(each, comparison.predictions);
      if (each.earlier) comparison.notes.push_back(fmt::format("{}: {}: {}", each.name, each.earlier->message, each.earlier->help));
    } else {
      fits.push_back(each);
      require_same_samples(fits.front(), each);
      comparison.fits.push_back(compared_fit(each));
    }
  }
  if (!fits.empty()) comparison.data = data_text(fits.front());
  std::vector<ScoredFit> scored;
  for (StoredSummary const& each : fits)
    if (auto found = scored_fit(each.name, each.model, each.folder, each.summary)) {
      found->identity = identity(each).whole();
      scored.push_back(std::move(*found));
    }
  comparison.scores = compare_scores(scored);
  if (!comparison.scores.left_out.empty())
    comparison.notes.push_back(fmt::format("predictive scores: {} left out, because the scored samples are not those of `{}`",
                                           quoted(comparison.scores.left_out), scored.front().name));
  std::vector<std::string> models;
  std::vector<json> evidences;
  for (StoredSummary const& each : fits) {
    models.push_back(identity(each).whole());
    evidences.push_back(each.summary.value("evidence", json::object()));
  }
  weigh_models(models, comparison.fits);
  for (std::string& note : disagreements(models, comparison.fits)) comparison.notes.push_back(std::move(note));
  for (std::string& note : prior_width_notes(models, comparison.fits, evidences)) comparison.notes.push_back(std::move(note));
  for (std::string& note : models_of_one_name(fits)) comparison.notes.push_back(std::move(note));
  return comparison;
}

}  // namespace sysid

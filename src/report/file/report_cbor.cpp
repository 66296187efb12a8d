// One list of members for each type serves writing and reading: what is written is what is read.
#include "report/file/report_cbor.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "report/file/sealed_cbor.hpp"
#include "report/file/stored_files.hpp"

namespace nlohmann {

// None, or a list of one: a null would read as a number that is none.
template <class T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& out, std::optional<T> const& value) {
    out = json::array();
    if (value) out.push_back(*value);
  }
  static void from_json(json const& stored, std::optional<T>& value) {
    value.reset();
    if (!stored.empty()) value = stored.at(0).template get<T>();
  }
};

template <>
struct adl_serializer<sysid::SettingValue> {
  static void to_json(json& out, sysid::SettingValue const& value) {
    std::visit([&](auto const& each) { out = each; }, value);
  }
  static void from_json(json const& stored, sysid::SettingValue& value) {
    if (stored.is_boolean())
      value = stored.get<bool>();
    else if (stored.is_number_integer())
      value = stored.get<std::int64_t>();
    else if (stored.is_number())
      value = stored.get<double>();
    else if (stored.is_array())
      value = stored.get<std::vector<double>>();
    else
      value = stored.get<std::string>();
  }
};

template <>
struct adl_serializer<sysid::Finding> {
  static void to_json(json& out, sysid::Finding const& value) {
    out = {{"severity", value.severity},
           {"code", sysid::word(value.code)},
           {"names", value.names},
           {"message", value.message},
           {"help", value.help}};
  }
  static sysid::Finding from_json(json const& stored) {
    auto const code = sysid::finding_code(stored.at("code").get<std::string>());
    if (!code) throw json::other_error::create(501, "a finding without a row", &stored);
    return {*code, stored.at("severity").get<sysid::Severity>(), stored.at("names").get<std::vector<std::string>>(),
            stored.at("message").get<std::string>(), stored.at("help").get<std::string>()};
  }
};

template <>
struct adl_serializer<sysid::Score> {
  static void to_json(json& out, sysid::Score const& score) {
    out = {{"name", sysid::text_of(score.name)}, {"value", score.value}};
  }
  static sysid::Score from_json(json const& stored) {
    auto name = sysid::score_name(stored.at("name").get<std::string>());
    if (!name) throw json::other_error::create(501, "a score without a row", &stored);
    return {std::move(*name), stored.at("value").get<double>()};
  }
};

}  // namespace nlohmann

namespace sysid {

using json = nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PriorNumbers, distribution, arguments, lower, upper, scale)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PriorInfo, name, unit, text, numbers, q5, q95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FixedValue, name, value, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TrueValue, name, unit, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DataInfo, name, file, sha256, rows, scored, scored_rows, samples_sha256, inputs_sha256, notes,
                                   true_parameters)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FitLine, experiment, channel, unit, scores, optimum_of)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportTable, title, caption, header, rows)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Summary, name, unit, mean, median, sd, mad, q5, q95, rhat, ess_bulk, ess_tail, mcse_mean,
                                   coefficient, without_sd)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Mode, declared, sd, log_density, log_mass, share, hits)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SampledEvidence, state, above, error, effective, draws)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Evidence, log_evidence, reason, along_axes, modes, of_likelihood, sampled, method, error,
                                   effective, simulations, laplace, without_laplace, doubt)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LogScore, sum, error, samples, monte_carlo_error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ScoreAtMode, log_likelihood, parameters, samples, of_likelihood)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Deviance, mean, variance, at_mean)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LeftOutBlocks, experiment, pareto_k, asked, first_row, last_row, own_draws)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Criteria, at_mode, deviance, reason, draws, waic, loo, block, future, p_waic, p_loo,
                                   unstable_waic, doubtful, pareto_counts, worst_k, in_time, blocks, futures)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PriorWidth, parameter, factor, change, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Failure, kind, where, count, time, example, names)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FunctionPoint, inputs, mean, sd, q5, q95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PredictedInput, name, unit, values)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RestoringForce::Path, displacement, velocity, force)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RestoringForce, experiment, name, displacement, displacement_unit, velocity, velocity_unit,
                                   force_unit, per_mass, model, data, half_width, accelerometer, why_no_data, grid_displacement,
                                   grid_velocity, surface)

void to_json(json& out, Ledger const& ledger) { out = {{"solves", ledger.solves()}, {"failures", ledger.failures()}}; }
void from_json(json const& stored, Ledger& ledger) {
  ledger.add_solves(stored.at("solves").get<std::uint64_t>());
  for (Failure const& each : stored.at("failures").get<std::vector<Failure>>())
    ledger.add_failure(each.kind, each.where, each.time, each.example, each.count, each.names);
}

// --- What has columns in a CSV file: here stands how long each is, 0 where there is none.

namespace {

/// A column takes a line of its file for each number: more are no column, and would fill the memory before that is seen.
std::size_t length_of(json const& stored) {
  constexpr std::size_t most = 200'000'000;
  auto const length = stored.get<std::size_t>();
  if (length > most) throw json::other_error::create(501, "a column longer than any file", &stored);
  return length;
}

std::vector<double> column_of(json const& length) { return std::vector<double>(length_of(length), std::nan("")); }

/// Writes members one after the other; of a column its length.
class Writer {
 public:
  explicit Writer(json& out) : out_(out) {}
  template <class T>
  Writer& operator()(char const* name, T const& value) {
    out_[name] = value;
    return *this;
  }
  Writer& length(char const* name, std::vector<double> const& column) { return (*this)(name, column.size()); }

 private:
  json& out_;
};

/// Reads what a Writer wrote; columns are filled later.
class Reader {
 public:
  explicit Reader(json const& stored) : stored_(stored) {}
  template <class T>
  Reader& operator()(char const* name, T& value) {
    stored_.at(name).get_to(value);
    return *this;
  }
  Reader& length(char const* name, std::vector<double>& column) {
    column = column_of(stored_.at(name));
    return *this;
  }

 private:
  json const& stored_;
};

}  // namespace

void to_json(json& out, Chain const& chain) {
  out = {chain.values.size(), chain.log_prior.size(), chain.log_likelihood.size(), chain.log_density.size(),
         chain.acceptance.size()};
}
void from_json(json const& stored, Chain& chain) {
  chain.values.resize(length_of(stored.at(0)));
  chain.log_prior = column_of(stored.at(1));
  chain.log_likelihood = column_of(stored.at(2));
  chain.log_density = column_of(stored.at(3));
  chain.acceptance = column_of(stored.at(4));
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Draws, names, units, chains, parameter_count)

void to_json(json& out, Band const& band) {
  out = {{"draws", band.draws}, {"left_out", band.excluded}, {"length", band.mean.size()}};
}
void from_json(json const& stored, Band& band) {
  stored.at("draws").get_to(band.draws);
  stored.at("left_out").get_to(band.excluded);
  for (auto* column : {&band.mean, &band.sd, &band.lower, &band.upper}) *column = column_of(stored.at("length"));
}

template <class Way, class Quantity>
void quantity_members(Way way, Quantity& quantity) {
  way("name", quantity.name)("unit", quantity.unit)("response", quantity.response)("noisy", quantity.noisy);
  way.length("measured", quantity.measured);
}
void to_json(json& out, PredictedQuantity const& quantity) {
  quantity_members(Writer(out), quantity);
  if (VarianceParts const& parts = quantity.variance; !parts.parameter.empty())
    out["variance"] = {parts.parameter.size(), parts.model.size(), parts.noise.size()};
  if (quantity.average) out["average"] = true;
  if (quantity.logarithmic) out["logarithmic"] = true;
  if (!quantity.alarms.empty()) out["alarms"] = quantity.alarms;
}
void from_json(json const& stored, PredictedQuantity& quantity) {
  quantity_members(Reader(stored), quantity);
  quantity.average = stored.value("average", false);
  quantity.logarithmic = stored.value("logarithmic", false);
  quantity.alarms = stored.value("alarms", std::vector<double>());
  if (!stored.contains("variance")) return;
  quantity.variance.parameter = column_of(stored.at("variance").at(0));
  quantity.variance.model = column_of(stored.at("variance").at(1));
  quantity.variance.noise = column_of(stored.at("variance").at(2));
}

template <class Way, class Along>
void prediction_members(Way way, Along& prediction) {
  way("experiment", prediction.experiment)("time_unit", prediction.time_unit)("time_scale", prediction.time_scale);
  way("rows", prediction.rows)("quantities", prediction.quantities)("inputs", prediction.inputs);
  way.length("length", prediction.time);
}
void to_json(json& out, Prediction const& prediction) { prediction_members(Writer(out), prediction); }
void from_json(json const& stored, Prediction& prediction) {
  prediction_members(Reader(stored), prediction);
  prediction.scored.assign(prediction.time.size(), 0);
}

template <class Way, class Function>
void function_members(Way way, Function& function) {
  way("name", function.name)("unit", function.unit)("inputs", function.inputs)("cuts", function.cuts)("visits", function.visits);
}
void to_json(json& out, FunctionReport const& function) {
  function_members(Writer(out), function);
  out["grid"] = function.grid.size();
}
void from_json(json const& stored, FunctionReport& function) {
  function_members(Reader(stored), function);
  double const none = std::nan("");
  function.grid.assign(length_of(stored.at("grid")), {std::vector<double>(function.inputs.size(), none), none, none, none, none});
}

// --- selections

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ParameterInfo, name, unit, lower, upper)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WeightedSummary, name, unit, mean, sd, median, q5, q95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PopulationRecord::OfModel, proposed, failed, particles, probability, nearest)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PopulationRecord, threshold, proposed, simulated, failed, accepted, ess, models)

template <class Way, class Candidate>
void candidate_members(Way way, Candidate& model) {
  way("name", model.name)("prior", model.prior)("probability", model.probability)("share", model.share);
  way("died_in", model.died_in)("by_chance", model.by_chance)("parameters", model.parameters)("summaries", model.summaries);
  way.length("particles", model.weight);
}
void to_json(json& out, SelectedModel const& model) {
  candidate_members(Writer(out), model);
  if (!model.absent.empty()) out["absent"] = model.absent;
  if (!model.simulated_with.empty()) out["simulated_with"] = model.simulated_with;
}
void from_json(json const& stored, SelectedModel& model) {
  candidate_members(Reader(stored), model);
  model.absent = stored.value("absent", std::vector<std::string>());
  model.simulated_with = stored.value("simulated_with", Facts());
  model.distance = model.weight;
  model.declared = LaneArray(static_cast<int>(model.parameters.size()), static_cast<int>(model.weight.size()));
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JumpRecord::OfModel, error, log_bayes_factor, factor_error, log_evidence, evidence_error, visits,
                                   bias, accepted_in, accepted_out, accepted_within, worth, spread, simulations, solver)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JumpRecord, chains, samples, burn_in, models)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SelectionResult, models, populations, jumps, threshold, next_threshold, stopped_by, ran_out)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LikelihoodCheck, log_evidence, probability, solver, given_up)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SelectionReport::Unmoved, name, unit, prior, why)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SelectionReport, result, distance, likelihoods, refined, refined_draws, floor, floor_words,
                                   shared, shared_unmoved, resampling_seed)

// --- discoveries

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ValidatedChannel, channel, unit, sd, residual, noise, growth, one_step, horizon, free_run)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ValidatedCoefficient, target, term, name, unit, regression, regression_sd, value, sd, of_target,
                                   inside)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ValidatedStructure, terms, equations, of_regression, failure, given_up, log_evidence, log_prior,
                                   probability, residual_over_noise, draws, bounded, follows, coefficients, channels)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ValidationReport, structures, segments, shortest, longest, whole, step, horizon, horizon_rows,
                                   window_rows, held_out, held_out_seen, solver)
void to_json(json& out, TermFate const& fate) { out = word(fate); }
void from_json(json const& stored, TermFate& fate) {
  auto const read = term_fate(stored.get<std::string>());
  if (!read) throw json::other_error::create(501, "a fate of a term that there is not", &stored);
  fate = *read;
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveredTerm, text, unit, name, fate, kept, coefficient, sd, measure, measure_error, mean,
                                   mean_sd, contribution, inflation)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveredSupport, terms, probability, probability_error, log_evidence)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveredEquation, target, equation, terms, supports, explained, noise_ratio, own_noise, unit,
                                   moving_average, rows, exact, converged)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveryReport::Noise, channel, unit, sd, given)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveryReport::Inner, name, unit, prior, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveryReport::Excluded, term, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DifferenceForecast, target, unit, sd, one_step, free_run, expected)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiscoveryReport, selector, derivatives, measure, windows, half_width, noise, inner, equations,
                                   excluded, validation, forecast_rows, forecasts, answer, source)

// --- calibrations

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TruePlace, truth, mean, sd, below, rank)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Replication, number, seed, redrawn, failure, failed, warned, independent, solves, settled,
                                   places)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CalibratedQuantity, name, unit, ranks, covered_50, covered_90, covered_95, mean_z, sd_z,
                                   contraction, chi_squared_p, ecdf_p, adjusted_p, shape)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FiredCheck, code, failed, warned)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CalibrationReport, replications, draws, bins, quantities, records, checks, band_low, band_high)

// --- the whole

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report, version, task, what, verb, prediction_rule, measured_past, lags, model_name, model_title,
                                   equations, formulas, model_text, resolved_text, priors, fixed, data, draws, summary, verdict,
                                   findings, fit, predictions, modes, sampled_names, evidence, criteria, prior_widths, noise,
                                   functions, forces, tables, selection, discovery, calibration, ledger, seed, place, command,
                                   unseeded, settings, versions)

namespace {

/// Raised when members keep their names and change their meaning. Other members tell themselves: the bytes are whole and do not
/// fit.
constexpr int form = 6;

/// Records of before have the findings below the headline.
std::string headline_alone(std::string const& stored) { return stored.substr(0, stored.find('\n')); }

}  // namespace

std::string record_bytes(Report const& report) {
  json content = report;
  if (!report.states.empty()) content["states"] = report.states;  // those of before have none
  if (report.discovery && !report.discovery->free_runs.empty()) content["free_runs"] = report.discovery->free_runs;
  return sealed_cbor(content, form);
}

Report read_record(std::string const& bytes, std::filesystem::path const& path) {
  UserError const other = unusable_result(fmt::format("`{}` was written by another version of sysid", path.string()));
  json stored;
  switch (open_cbor(bytes, form, stored)) {
    case Seal::damaged:
      throw unusable_result(fmt::format("`{}` is damaged", path.string()));
    case Seal::other_form:
      throw other;
    case Seal::whole:
      break;
  }
  try {
    Report report = stored.get<Report>();
    report.verdict = headline_alone(report.verdict);
    if (stored.contains("states")) stored.at("states").get_to(report.states);
    for (Prediction& each : report.states) each.smoothed = true;
    if (report.discovery && stored.contains("free_runs")) stored.at("free_runs").get_to(report.discovery->free_runs);
    return report;
  } catch (json::exception const&) {
    throw other;
  } catch (std::length_error const&) {
    throw other;
  } catch (...) {  // lengths that are allowed one by one may be too many together
    throw_damaged(path);
  }
}

}  // namespace sysid

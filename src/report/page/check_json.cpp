// The page of `sysid check` for a program: one JSON object.
#include <nlohmann/json.hpp>
#include <sstream>

#include "report/page/check_page.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

Json lines(std::vector<DeclaredLine> const& declared) {
  Json out = Json::array();
  for (DeclaredLine const& line : declared) out.push_back({{"name", line.name}, {"unit", line.unit}, {"text", line.text}});
  return out;
}

Json model_object(ModelPage const& model) {
  Json out = {{"name", model.name},         {"title", model.title},          {"equations", model.equations},
              {"unknowns", model.unknowns}, {"states", lines(model.states)}, {"inputs", lines(model.inputs)}};
  if (!model.disturbances.empty()) out["disturbances"] = lines(model.disturbances);
  out["channels"] = lines(model.channels);
  out["parameters"] = lines(model.parameters);
  out["derived"] = lines(model.derived);
  out["unchecked_units"] = model.unchecked;
  return out;
}

Json dictionary_object(DictionaryPage const& dictionary) {
  Json equations = Json::array();
  for (DictionaryPage::Equation const& equation : dictionary.equations)
    equations.push_back({{"target", equation.target}, {"unit", equation.unit}, {"terms", lines(equation.terms)}});
  return {{"name", dictionary.name},
          {"title", dictionary.title},
          {"states", lines(dictionary.states)},
          {"inputs", lines(dictionary.inputs)},
          {"equations", std::move(equations)},
          {"left_out", dictionary.excluded}};
}

Json coverage_object(CoveragePage const& data) {
  Json inputs = Json::array(), channels = Json::array();
  for (CoveragePage::Input const& input : data.inputs)
    inputs.push_back(
        {{"name", input.name}, {"rule", input.rule}, {"constant", input.constant}, {"band_hz", {input.low, input.high}}});
  for (CoveragePage::Channel const& channel : data.channels)
    channels.push_back({{"name", channel.name},
                        {"unit", channel.unit},
                        {"measured", channel.measured},
                        {"missing", channel.missing},
                        {"range", channel.range}});
  return {{"name", data.name},
          {"file", data.file},
          {"made_by", data.made_by},
          {"rows", data.rows},
          {"first", data.first},
          {"last", data.last},
          {"scored", data.scored},
          {"start_rows", data.start_rows},
          {"rate_hz", data.rate > 0 ? Json(data.rate) : Json(nullptr)},
          {"equal_steps", data.equal},
          {"gaps", data.gaps},
          {"inputs", inputs},
          {"channels", channels}};
}

Json prior_object(PriorPage const& prior) {
  Json failures = Json::array(), channels = Json::array();
  for (Failure const& failure : prior.failures)
    failures.push_back({{"class", name(failure.kind)}, {"where", failure.where}, {"count", failure.count}, {"time", failure.time}});
  for (PriorPage::Channel const& channel : prior.channels)
    channels.push_back({{"name", channel.name},
                        {"unit", channel.unit},
                        {"range_q5", channel.low},
                        {"range_median", channel.middle},
                        {"range_q95", channel.high},
                        {"measured_range", channel.measured}});
  return {{"draws", prior.draws},
          {"failed", prior.failed},
          {"failed_as_stated", prior.failed_as_stated},
          {"failed_explicit", prior.failed_explicit},
          {"stiff_tried", prior.stiff_tried},
          {"stiff_followed", prior.stiff_followed},
          {"failures", failures},
          {"failures_not_traced", prior.untraced},
          {"channels", channels}};
}

Json information_object(InformationPage const& page) {
  Json parameters = Json::array(), moves = Json::array();
  for (InformationPage::Line const& line : page.lines) {
    Json each = {{"name", line.name}, {"unit", line.unit}, {"relative", line.relative}, {"prior_width", line.prior_width}};
    if (line.instead.empty())
      each["expected_sd"] = {line.low, line.high};
    else
      each["instead"] = line.instead;
    parameters.push_back(std::move(each));
  }
  for (auto const& [solver, move] : page.moves) moves.push_back({{"solver", solver}, {"move_sd", move}});
  return {{"draws", page.draws},
          {"rows", page.rows},
          {"rank", {page.rank_low, page.rank_high}},
          {"noise", page.noise},
          {"parameters", parameters},
          {"null_directions", page.null_directions},
          {"ridges", page.ridges},
          {"solvers", moves},
          {"taken_solver", page.taken},
          {"exact_solver", page.exact},
          {"advised_solver", page.advised},
          {"found_move_sd", page.found_move ? Json(*page.found_move) : Json(nullptr)},
          {"response_move", page.response_move ? Json(*page.response_move) : Json(nullptr)}};
}

Json findings_array(Findings const& findings) {
  Json out = Json::array();
  for (Finding const& finding : findings)
    out.push_back({{"severity", finding.severity == Severity::error     ? "error"
                                : finding.severity == Severity::warning ? "warning"
                                                                        : "note"},
                   {"code", word(finding.code)},
                   {"names", finding.names},
                   {"message", finding.message},
                   {"help", finding.help}});
  return out;
}

Json process_object(ProcessPage const& page) {
  Json lines = Json::array();
  for (ProcessPage::Line const& line : page.lines) {
    Json each = {{"name", line.name},    {"what", line.what},           {"unit", line.unit},
                 {"q5", line.prior.low}, {"median", line.prior.middle}, {"q95", line.prior.high}};
    if (line.inputs)
      each["inputs"] = {{"range", line.inputs->range}, {"spacing", line.inputs->spacing}, {"places", line.inputs->places}};
    lines.push_back(std::move(each));
  }
  return {{"channel", page.channel},         {"unit", page.unit},   {"draws", page.draws},
          {"failed", page.failed},           {"rows", page.rows},   {"repeated_rows", page.repeated},
          {"filtered", page.filtered},       {"bytes", page.bytes}, {"seconds", page.seconds},
          {"measured_sd", page.measured_sd}, {"priors", lines}};
}

void add_preflight(PreflightPage const& preflight, Json& out) {
  out["prior"] = preflight.prior ? prior_object(*preflight.prior) : Json(nullptr);
  out["information"] = preflight.information ? information_object(*preflight.information) : Json(nullptr);
  out["processes"] = Json::array();
  for (ProcessPage const& process : preflight.processes) out["processes"].push_back(process_object(process));
  if (!preflight.disturbances.empty()) out["disturbances"] = preflight.disturbances;
  out["left_out"] = preflight.not_examined;
}

// A fit has its preflight page in the object of the task, a selection one for each candidate in `candidates`.
Json task_object(TaskPage const& task) {
  Json data = Json::array(), candidates = Json::array();
  for (CoveragePage const& coverage : task.coverage) data.push_back(coverage_object(coverage));
  Json out = {{"name", task.name}, {"what", task.what}, {"data", data}};
  Findings findings = task.findings;
  PreflightPage own;
  for (PreflightPage const& preflight : task.preflights) {
    if (preflight.candidate.empty()) {
      own = preflight;
      findings = task.all_findings();
      continue;
    }
    Json candidate = {{"name", preflight.candidate}};
    add_preflight(preflight, candidate);
    candidate["findings"] = findings_array(preflight.findings);
    candidates.push_back(std::move(candidate));
  }
  add_preflight(own, out);
  out["findings"] = findings_array(findings);
  out["candidates"] = std::move(candidates);
  return out;
}

}  // namespace

std::string check_json(CheckPage const& page, std::string const& messages) {
  Json models = Json::array(), dictionaries = Json::array(), tasks = Json::array(), said = Json::array();
  std::istringstream lines(messages);
  for (std::string line; std::getline(lines, line);) said.push_back(Json::parse(line));
  for (ModelPage const& model : page.models) models.push_back(model_object(model));
  for (DictionaryPage const& dictionary : page.dictionaries) dictionaries.push_back(dictionary_object(dictionary));
  for (TaskPage const& task : page.tasks) tasks.push_back(task_object(task));
  Json const all = {{"file", page.file}, {"messages", said}, {"models", models}, {"dictionaries", dictionaries}, {"tasks", tasks}};
  // The user's text may hold any bytes; what is not finite is null.
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sysid

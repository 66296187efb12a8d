// Sentences, and what is read back.
#include "app/task/discovery_conclusions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"
#include "diagnostics/verdict.hpp"
#include "discovery/discovery_findings.hpp"
#include "discovery/discovery_verdict.hpp"
#include "load/load.hpp"

namespace sysid {
namespace {

bool is_validated(DiscoveryReport const& discovery) {
  return discovery.validation && discovery.validation->structures.front().failure.empty();
}

// A channel at rest is a channel that is constant.
void say_once(CheckedDictionary const& dictionary, Findings& findings) {
  if (std::none_of(findings.begin(), findings.end(), [](Finding const& each) { return each.code == FindingCode::record_at_rest; }))
    return;
  std::erase_if(findings, [&](Finding const& each) {
    return each.code == FindingCode::column_constant &&
           std::any_of(dictionary.measured.channels.begin(), dictionary.measured.channels.end(),
                       [&](Channel const& channel) { return channel.name == each.names.front(); });
  });
}

}  // namespace

void add_regression_findings(CheckedDictionary const& dictionary, regression::Discovery const& found,
                             std::vector<DiscoveredEquation> const& described, Validation const* validation, Findings& findings) {
  for (std::size_t e = 0; e < found.equations.size(); ++e) {
    regression::FoundEquation const& equation = found.equations[e];
    for (regression::Concern const& concern : equation.concerns) {
      std::vector<std::string> names;
      for (int const term : concern.terms) names.push_back(dictionary.equations[e].terms[static_cast<std::size_t>(term)].text);
      Finding finding = finding_of(concern, found.equations.size() > 1 ? equation.name : "", std::move(names));
      if (concern.input >= 0) {
        std::string const& input = dictionary.measured.inputs[static_cast<std::size_t>(concern.input)].name;
        finding.names = {input};
        if (concern.kind == regression::Concern::Kind::other_rule) finding.names.emplace_back(rule_name(concern.rule));
        finding.message = fmt::format("input {}: {}", input, finding.message);
      }
      if (validation != nullptr)
        temper_by_form(validation->report, concern, validation->order.front().equations[e]->terms, finding);
      else
        temper_by_terms(concern, equation.chosen.terms, finding);
      if (std::find(findings.begin(), findings.end(), finding) == findings.end()) findings.push_back(std::move(finding));
    }
    if (validation == nullptr)
      for (Finding& each : undecided_terms(equation, described[e])) findings.push_back(std::move(each));
  }
  say_once(dictionary, findings);
}

Findings interpolation_findings(std::vector<std::string> const& records, bool simulated) {
  Findings findings;
  for (std::string const& name : records)
    findings.push_back(
        {FindingCode::steps_interpolated,
         simulated ? Severity::note : Severity::warning,
         {name},
         fmt::format("the time steps of `{}` are unequal: the regression uses the record interpolated to equal steps{}", name,
                     simulated ? ", the simulation uses the samples at their own times" : ""),
         fmt::format("{}if it was sampled regularly, write `step` or `rate` in place of `time` in the data block",
                     simulated ? "" : "take the coefficients and sds as approximate; ")});
  return findings;
}

Findings filling_findings(std::vector<std::string> const& records, bool simulated) {
  Findings findings;
  for (std::string const& name : records)
    findings.push_back({FindingCode::windows_missing,
                        Severity::note,
                        {name},
                        fmt::format("missing samples of `{}` would leave too few windows: the regression uses values that are "
                                    "interpolated from their neighbours{}",
                                    name, simulated ? ", the simulation only what was measured" : ""),
                        simulated ? "" : "take the coefficients and sds as approximate"});
  return findings;
}

void add_prior_findings(CheckedDictionary const& dictionary, DiscoveryReport const& discovery, Findings& findings) {
  if (!discovery.validation) return;
  for (ValidatedCoefficient const& each : discovery.validation->structures.front().coefficients)
    for (InnerParameter const& inner : dictionary.inner) {
      if (!each.inside || inner.quantity.name != each.name) continue;
      constexpr int draws = 1023;
      std::vector<double> const prior = sorted_draws(inner, draws);
      double const value = inner.quantity.to_si(each.value);
      if (value >= prior.front() && value <= prior.back()) continue;
      findings.push_back(
          {FindingCode::prior_contradicted,
           Severity::warning,
           {each.name},
           fmt::format("the record gives {} = {}{}, outside the range of {} draws of its prior ({} to {})", each.name,
                       significant(each.value, 3), unit_after_number(each.unit), draws,
                       significant(inner.quantity.from_si(prior.front()), 3), significant(inner.quantity.from_si(prior.back()), 3)),
           "check the prior and its unit; if they are right, a term is missing. The fit in `found.sysid` includes the prior"});
    }
}

std::vector<double> simulated_noise(CheckedDictionary const& dictionary, DiscoveryReport const& discovery) {
  std::vector<double> noise(dictionary.measured.channels.size());
  if (!is_validated(discovery)) return noise;
  for (ValidatedChannel const& each : discovery.validation->structures.front().channels)
    for (std::size_t c = 0; c < noise.size(); ++c)
      if (Channel const& channel = dictionary.measured.channels[c]; channel.name == each.channel)
        noise[c] = channel.to_si(each.residual);
  return noise;
}

void add_found_source(FoundSource const& source, std::vector<FoundStructure> const& structures, DiscoveryReport& discovery,
                      Findings& findings) {
  std::vector<FoundStructure> written;
  std::vector<std::string> excluded, names;
  for (FoundStructure const& each : structures) {
    written.push_back(each);
    std::string text = source.text(written);
    Source read((source.results / "found.sysid").string(), text);
    Diagnostics diagnostics;
    if (load(read, diagnostics)) {
      discovery.source = std::move(text);
      continue;
    }
    written.pop_back();
    names.push_back(structure_text(source.dictionary, each));
    excluded.push_back(fmt::format("`{}` ({})", names.back(), diagnostics.all().front().message));
  }
  if (excluded.empty()) return;
  std::string const help = "a model needs as many equations as states, each with a derivative in it";
  if (written.empty())
    findings.push_back({FindingCode::equation_no_model, Severity::warning, std::move(names),
                        "the equation that was found is not a model that can be simulated: " + excluded.front(), help});
  else
    findings.push_back({FindingCode::candidates_left_out, Severity::warning, std::move(names),
                        fmt::format("`found.sysid` contains {} of {} structures; the others cannot be simulated: {}",
                                    written.size(), structures.size(), fmt::join(excluded, ", ")),
                        help});
}

std::vector<std::string> found_equations(DiscoveryReport const& discovery) {
  if (is_validated(discovery)) return discovery.validation->structures.front().equations;
  std::vector<std::string> all;
  for (DiscoveredEquation const& each : discovery.equations)
    if (!each.equation.empty()) all.push_back(each.equation);
  return all;
}

std::string discovery_headline(DiscoveryReport const& discovery, std::vector<std::string> const& equations,
                               Findings const& findings) {
  std::string terms = fmt::format("{}", fmt::join(equations, "; "));
  for (DiscoveredEquation const& each : discovery.equations)
    if (each.equation.empty()) terms += fmt::format("{}{}: no equation found", terms.empty() ? "" : "; ", each.target);
  if (is_validated(discovery)) {
    for (ValidatedCoefficient const& each : discovery.validation->structures.front().coefficients)
      if (each.inside) terms += fmt::format("; {} = {}{}", each.name, significant(each.value, 4), unit_after_number(each.unit));
  } else {
    for (DiscoveryReport::Inner const& each : discovery.inner)
      terms += fmt::format("; {} = {}{}", each.name, significant(each.value, 4), unit_after_number(each.unit));
  }
  return fmt::format("{}; {}{}{}", terms, discovery.answer, discovery.answer.empty() ? "" : "; ", verdict_of(findings).headline);
}

}  // namespace sysid

// Evidence and severity in words.
#include "report/text/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {

namespace {

constexpr double rough = 0.5;  // nats: below, no comparison turns on it

// What the checks of Laplace's approximation say, where it is the result.
std::string doubt_of_laplace(Evidence const& evidence) {
  SampledEvidence const& sampled = evidence.sampled;
  if (sampled.differs())
    return fmt::format(", approximate: weighted draws change it by {:+.2f} ± {:.2f}", sampled.above, sampled.error);
  std::string const along = std::fabs(evidence.along_axes) < rough
                                ? ""
                                : fmt::format("integration along its axes changes it by {:+.1f}", evidence.along_axes);
  if (sampled.state == SampledEvidence::State::unknown)
    return ", approximate: weighted draws do not confirm it" + (along.empty() ? "" : "; " + along);
  return sampled.state == SampledEvidence::State::none && !along.empty() ? ", approximate: " + along : "";
}

}  // namespace

std::string evidence_number(double log_evidence, std::optional<double> error) {
  if (!error) return fmt::format("{:.1f}", log_evidence);
  constexpr double shown = 0.005;  // smaller ones would be written as 0
  return fmt::format("{:.{}f} ± {:.{}f}", log_evidence, *error < 0.95 ? 2 : 1, std::max(*error, shown), *error < 0.95 ? 2 : 1);
}

std::string evidence_text(Evidence const& evidence) {
  if (!evidence.log_evidence) return evidence.of_likelihood ? "" : fmt::format("no log evidence: {}", evidence.reason);
  std::string text =
      fmt::format("log evidence {} ({}", evidence_number(*evidence.log_evidence, evidence.error), title(evidence.method));
  if (evidence.method == EvidenceMethod::laplace) text += doubt_of_laplace(evidence);
  if (evidence.disagrees_with_laplace()) text += fmt::format("; Laplace's approximation gives {:.1f}", *evidence.laplace);
  if (!evidence.doubt.empty()) text += "; not confirmed: " + evidence.doubt;
  return text + ")";
}

std::string likelihood_text(Report const& report) {
  if (!report.evidence || !report.evidence->of_likelihood || report.modes.empty()) return "";
  std::string text = fmt::format("log likelihood {:.2f} at its maximum", report.modes.front().log_density);
  if (!report.criteria || !report.criteria->at_mode) return text;
  ScoreAtMode const& score = *report.criteria->at_mode;
  auto const parameters = static_cast<std::size_t>(score.parameters), samples = static_cast<std::size_t>(score.samples);
  return text + fmt::format(" ({}, {})", counted(parameters, "parameter"), counted(samples, "sample"));
}

std::vector<std::string> without_sd_texts(Report const& report) {
  std::vector<std::string> out;
  for (Summary const& each : report.summary)
    if (!each.without_sd.empty()) out.push_back(fmt::format("no sd of `{}`: {}", each.name, each.without_sd));
  return out;
}

std::string pretty_numbers(std::string_view words) {
  auto const digit = [&](std::size_t at) { return at < words.size() && words[at] >= '0' && words[at] <= '9'; };
  auto const letter = [&](std::size_t at) {
    return at < words.size() && (std::isalnum(static_cast<unsigned char>(words[at])) != 0 || words[at] == '_' || words[at] == '\'');
  };
  std::string out;
  bool code = false;
  for (std::size_t i = 0; i < words.size();) {
    if (words[i] == '`') code = !code;
    char const before = i == 0 ? ' ' : words[i - 1];
    bool const free = before == ' ' || before == '(' || before == '[' || before == '\n' || (before == '\xa0' && i > 1);
    std::size_t end = i + (words[i] == '-' ? 1 : 0);
    if (code || !free || !digit(end)) {
      out += words[i++];
      continue;
    }
    while (digit(end)) ++end;
    if (end + 1 < words.size() && words[end] == '.' && digit(end + 1))
      for (++end; digit(end);) ++end;
    std::size_t power = end;
    if (power < words.size() && words[power] == 'e') {
      power += power + 1 < words.size() && (words[power + 1] == '-' || words[power + 1] == '+') ? 2 : 1;
      if (digit(power)) {
        while (digit(power)) ++power;
        end = power;
      }
    }
    std::string_view const number = words.substr(i, end - i);
    // Part of a name, of a range or of a date.
    bool const alone = !letter(end) && !(end + 1 < words.size() && (words[end] == '.' || words[end] == '-') && letter(end + 1));
    out += alone ? pretty_number(number) : std::string(number);
    i = end;
  }
  return out;
}

std::string quantity_text(double value, int digits, std::string_view unit) {
  std::string const shown = pretty_unit(unit);
  return pretty_number(significant(value, digits)) + (shown.empty() || shown == "-" ? "" : "\u00a0" + shown);
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace sysid

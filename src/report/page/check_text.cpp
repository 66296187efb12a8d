// The page of `sysid check` for a person.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/system/memory.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/verdict.hpp"
#include "report/page/check_page.hpp"

namespace sysid {
namespace {

constexpr int margin = 14;

std::string number_with_unit(std::string const& number, std::string const& unit) { return number + unit_after_number(unit); }

// "  label       first line", further lines below it.
std::string entry(std::string const& label, std::vector<std::string> const& lines) {
  std::string out;
  for (std::size_t i = 0; i < lines.size(); ++i)
    out += fmt::format("  {:<{}}{}\n", i == 0 ? label : std::string(), margin - 2, lines[i]);
  return out;
}

std::string table(std::string const& label, std::vector<std::vector<std::string>> const& rows, int left) {
  std::string const text = align_columns(rows, left);
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return entry(label, lines);
}

std::vector<std::vector<std::string>> rows_of(std::vector<DeclaredLine> const& lines) {
  std::vector<std::vector<std::string>> rows;
  for (DeclaredLine const& line : lines) rows.push_back({line.name, line.unit.empty() ? "" : "[" + line.unit + "]", line.text});
  return rows;
}

std::string model_text(ModelPage const& model) {
  std::string out = fmt::format("model {}{}\n", model.name, model.title.empty() ? "" : " \"" + model.title + "\"");
  std::vector<std::string> equations = model.equations;
  std::string unknowns;
  for (std::string const& unknown : model.unknowns) unknowns += (unknowns.empty() ? "" : ", ") + unknown;
  if (!model.unknowns.empty())  // a model that was accepted has as many equations, of elements and of parts, as unknowns
    equations.push_back(
        fmt::format("{}{} for {}: {}", model.equations.size() == model.unknowns.size() ? "" : "with all elements and parts: ",
                    counted(model.unknowns.size(), "equation"), counted(model.unknowns.size(), "unknown"), unknowns));
  out += entry(plural("equation", model.equations.size()), equations);
  out += table(plural("state", model.states.size()), rows_of(model.states), 3);
  out += table(plural("input", model.inputs.size()), rows_of(model.inputs), 3);
  out += table("unmeasured", rows_of(model.disturbances), 3);
  out += table(plural("channel", model.channels.size()), rows_of(model.channels), 3);
  out += table(plural("parameter", model.parameters.size()), rows_of(model.parameters), 3);
  out += table("derived", rows_of(model.derived), 3);
  out += entry("unchecked", model.unchecked);
  return out;
}

// How many terms each equation has, then those that all share, or each with its own.
std::string equation_text(DictionaryPage::Equation const& equation, bool alone) {
  std::string const unit = equation.unit.empty() ? "" : fmt::format(" [{}]", equation.unit);
  std::string out = entry("target", {fmt::format("{}{}: {}", equation.target, unit, counted(equation.terms.size(), "term"))});
  return out + table(alone ? "terms" : "", rows_of(equation.terms), 3);
}

// Frequencies of records that count in longer units than seconds are told in those.
bool slow(CoveragePage const& data) { return data.time_scale > 1; }
std::string frequency_unit(CoveragePage const& data) { return slow(data) ? "1/" + data.time_unit : "Hz"; }
double frequency(CoveragePage const& data, double hertz) { return slow(data) ? hertz * data.time_scale : hertz; }

// "1000 Hz", with a comma before it; nothing of rows that no time orders.
std::string rate_text(CoveragePage const& data) {
  if (data.rate == 0) return {};
  return fmt::format(", {}{}{}", data.equal || data.gaps > 0 ? "" : "on average ",
                     slow(data) ? fmt::format("one every {:.6g} {}", 1 / (data.rate * data.time_scale), data.time_unit)
                                : fmt::format("{:.6g} Hz", data.rate),
                     data.gaps > 0 ? fmt::format(" with {}", counted(static_cast<std::size_t>(data.gaps), "gap")) : std::string());
}

std::string input_text(CoveragePage const& data, CoveragePage::Input const& input) {
  std::string const what = input.rule.empty() ? input.name : input.name + ", " + input.rule;
  if (data.rate == 0) return fmt::format("input {}", what);
  if (input.constant) return fmt::format("input {}: constant", what);
  return fmt::format("input {}: 99 % of its power is between {} and {} {} (up to {} times the sampling rate)", what,
                     significant(frequency(data, input.low), 3), significant(frequency(data, input.high), 3), frequency_unit(data),
                     fmt::format("{:.2f}", input.high / data.rate));
}

std::string coverage_text(CoveragePage const& data) {
  if (!data.made_by.empty())
    return entry("data", {fmt::format("{}: generated by {}, does not exist yet: run `sysid simulate`", data.file, data.made_by)});
  std::vector<std::string> lines = {
      fmt::format("{}: rows {}..{} of {} scored{}{}", data.file, data.first, data.last, data.rows,
                  data.start_rows > 0 ? fmt::format(" ({} rows before them estimate the start)", data.start_rows) : std::string(),
                  rate_text(data))};
  for (CoveragePage::Input const& input : data.inputs) lines.push_back(input_text(data, input));
  for (CoveragePage::Channel const& channel : data.channels)
    lines.push_back(channel.measured + channel.missing == 0
                        ? fmt::format("{}: not in these data", channel.name)
                        : fmt::format("{}: {} samples, {} missing, range {}", channel.name, channel.measured, channel.missing,
                                      number_with_unit(significant(channel.range, 3), channel.unit)));
  return entry("data", lines);
}

// With the task's own solver, and what others make of the draws that it loses.
std::string failures_text(PriorPage const& prior) {
  if (prior.failed_as_stated == 0) return fmt::format("{} draws, all simulations are finite", prior.draws);
  std::string const fail = fmt::format("{} of {} simulations fail", prior.failed_as_stated, prior.draws);
  if (prior.failed >= prior.failed_as_stated) return fail;
  std::string text = fmt::format("{} with {}", fail, prior.stated);
  if (!prior.explicit_solver.empty()) text += fmt::format(", {} with {}", prior.failed_explicit, prior.explicit_solver);
  if (prior.stiff_tried > 0)
    text += fmt::format(", {}{} with {}", prior.stiff_tried < prior.stiff_left ? "about " : "", prior.failed, prior.stiff_solver);
  int const curable = prior.failed_as_stated - prior.failed;
  return text + fmt::format(": {} fail{} only because {}", curable, curable == 1 ? "s" : "",
                            prior.spent ? "more steps between two samples are needed" : "the steps are too long");
}

std::string prior_text(PriorPage const& prior, CoveragePage const& data) {
  std::vector<std::string> lines = {failures_text(prior)};
  for (Failure const& failure : prior.failures)
    lines.push_back(fmt::format(
        "  {} x {}: {}{}", failure.count, name(failure.kind), failure.where,
        data.timed ? fmt::format(" (first at t = {} {})", significant(failure.time / data.time_scale, 4), data.time_unit)
                   : std::string()));
  if (prior.untraced > 0) lines.push_back(fmt::format("  {} x {}", prior.untraced, Ledger::untraced));
  for (PriorPage::Channel const& channel : prior.channels)
    lines.push_back(
        fmt::format("{}: in 90 % of the draws its range (largest minus smallest) is between {} and {}, median {}; measured {}",
                    channel.name, significant(channel.low, 2), significant(channel.high, 2), significant(channel.middle, 2),
                    number_with_unit(significant(channel.measured, 2), channel.unit)));
  return entry("prior draws", lines);
}

// An sd of a logarithm.
std::string share(double value) {
  return value < 0.5 ? significant(100 * value, 2) + " %" : "factor " + significant(elementary::exp(std::min(value, 700.0)), 2);
}

std::string information_text(InformationPage const& page) {
  std::vector<std::vector<std::string>> rows = {{"", "prior width", "expected sd after the fit"}};
  for (InformationPage::Line const& line : page.lines) {
    auto const number = [&](double value) {
      return line.relative ? share(value) : number_with_unit(significant(value, 2), line.unit);
    };
    rows.push_back({line.name, number(line.prior_width),
                    !line.instead.empty() ? line.instead : fmt::format("{} to {}", number(line.low), number(line.high))});
  }
  std::string out = table("information", rows, 1);
  std::vector<std::string> lines;
  lines.push_back(fmt::format("computed at the {} prior draws whose response is closest in size to the data{}", page.draws,
                              page.noise.empty() ? std::string() : "; assumed noise: " + page.noise));
  lines.push_back("prior width: half the width of the central 68 % interval of the prior draws (about the sd of a normal prior)");
  if (std::any_of(page.lines.begin(), page.lines.end(), [](InformationPage::Line const& line) { return line.relative; }))
    lines.push_back("percentages are relative to the value of the parameter; factor 5 means times or divided by 5");
  if (page.rows > 0)
    lines.push_back(
        fmt::format("over the first {} rows with a sample only; the whole record contains more information", page.rows));
  for (std::string const& direction : page.null_directions) lines.push_back(direction);
  for (std::string const& ridge : page.ridges) lines.push_back(ridge);
  out += entry("", lines);
  std::string moves;
  for (auto const& [solver, move] : page.moves)
    moves += fmt::format("{}{} sd for {}", moves.empty() ? "" : ", ", move > 5 ? "more than 5" : significant(move, 2), solver);
  if (!moves.empty())
    out += entry(
        "solver",
        {fmt::format("with {}, parameters change by {}", page.refinement, moves),
         page.advised.empty()
             ? page.taken.empty()
                   ? "none of these is accurate enough at these draws; the fit chooses its solver settings at its mode"
                   : "none of these is accurate enough"
         : page.prior_overflows ? fmt::format("{} is needed: explicit steps overflow on a large part of the prior", page.advised)
         : page.taken.empty()   ? fmt::format("{} is sufficient; the fit chooses its solver settings", page.advised)
                                : fmt::format("{} is sufficient; the task uses {}", page.advised, page.taken)});
  if (!page.exact.empty() && page.exact == page.taken) out += entry("solver", {fmt::format("{} is exact", page.exact)});
  if (!page.exact.empty() && page.exact != page.taken)
    out += entry(moves.empty() ? "solver" : "",
                 {fmt::format("`solver = {}` would be exact, as the equations are linear", page.exact)});
  if (page.found_move)
    out += entry("", {fmt::format("the mode found with {} from these draws changes by {} sd with {}", page.moves.front().first,
                                  significant(*page.found_move, 2), page.refinement)});
  if (page.response_move && std::isfinite(*page.response_move))
    out += entry("", {fmt::format("with {}, the median response changes by {} % of its sd, which is an nmse of {} %",
                                  page.refinement, significant(100 * *page.response_move, 2),
                                  significant(100 * *page.response_move * *page.response_move, 2))});
  return out;
}

/// "20 ms", "0:12 (min:s)", "1:00:12 (h:min:s)".
std::string seconds_text(double seconds) {
  if (seconds < 0.95) return fmt::format("{} ms", significant(std::max(1e3 * seconds, 0.1), 1));
  std::string const text = format_duration(seconds);
  return fmt::format("{} ({}min:s)", text, std::count(text.begin(), text.end(), ':') > 1 ? "h:" : "");
}

std::string process_text(ProcessPage const& page) {
  std::vector<std::string> lines = {page.failed == 0
                                        ? fmt::format("{} draws, the likelihood is finite at all of them", page.draws)
                                        : fmt::format("the likelihood is not finite at {} of {} draws", page.failed, page.draws)};
  for (ProcessPage::Line const& line : page.lines) {
    std::string text = fmt::format("{}: {} of {} to {}, median {}", line.name, line.what, significant(line.prior.low, 2),
                                   significant(line.prior.high, 2), number_with_unit(significant(line.prior.middle, 2), line.unit));
    if (line.inputs)
      text += fmt::format("; {} over a range of {}, spacing {}", counted(line.inputs->places, "distinct input"),
                          number_with_unit(significant(line.inputs->range, 2), line.unit), significant(line.inputs->spacing, 2));
    else
      text += fmt::format("; sd of {} {}", page.channel, number_with_unit(significant(page.measured_sd, 2), page.unit));
    lines.push_back(std::move(text));
  }
  if (page.rows > 0) {
    lines.push_back(
        fmt::format("a likelihood of {} rows{}: {}", page.rows,
                    page.repeated > 0 ? fmt::format(", {} of them with the inputs of another row", page.repeated) : std::string(),
                    page.filtered ? std::string("computed by filtering, at a cost proportional to the rows")
                                  : fmt::format("about {} of memory and {}, which grows with the cube of the rows",
                                                format_bytes(page.bytes), seconds_text(page.seconds))));
  }
  return entry("processes", lines);
}

std::string findings_text(Findings const& findings) {
  std::string out;
  for (Severity const severity : {Severity::error, Severity::warning, Severity::note})
    for (Finding const& finding : findings) {
      if (finding.severity != severity) continue;
      char const* const mark = severity == Severity::error ? "serious" : severity == Severity::warning ? "warning" : "note";
      out += entry(mark, {finding.message});
      if (!finding.help.empty()) out += entry("", {"what to do: " + finding.help});
      out += entry("", {fmt::format("more: sysid explain {}", word(finding.code))});
    }
  return out;
}

std::string task_text(TaskPage const& task) {
  std::string out = fmt::format("task {}: {}\n", task.name, task.what);
  for (CoveragePage const& data : task.coverage) out += coverage_text(data);
  out += findings_text(task.findings);
  for (PreflightPage const& preflight : task.preflights) {
    if (!preflight.candidate.empty()) out += fmt::format(" candidate {}\n", preflight.candidate);
    if (preflight.prior) out += prior_text(*preflight.prior, task.coverage.front());
    if (preflight.information) out += information_text(*preflight.information);
    if (!preflight.disturbances.empty()) out += entry("disturbance", preflight.disturbances);
    for (ProcessPage const& process : preflight.processes) out += process_text(process);
    if (!preflight.not_examined.empty()) out += entry("skipped", {preflight.not_examined});
    out += findings_text(preflight.findings);
  }
  return out;
}

}  // namespace

std::string dictionary_text(DictionaryPage const& page) {
  std::string out = fmt::format("dictionary {}{}\n", page.name, page.title.empty() ? "" : " \"" + page.title + "\"");
  out += table(plural("state", page.states.size()), rows_of(page.states), 3);
  out += table(plural("input", page.inputs.size()), rows_of(page.inputs), 3);
  for (DictionaryPage::Equation const& equation : page.equations) out += equation_text(equation, page.equations.size() == 1);
  return out + entry("left out", page.excluded);
}

std::string check_text(CheckPage const& page) {
  std::string out;
  for (ModelPage const& model : page.models) out += model_text(model) + "\n";
  for (DictionaryPage const& dictionary : page.dictionaries) out += dictionary_text(dictionary) + "\n";
  for (TaskPage const& task : page.tasks) out += task_text(task) + "\n";
  int serious = 0, warnings = page.warnings, notes = 0;
  for (TaskPage const& task : page.tasks)
    for (Finding const& finding : task.all_findings()) {
      serious += finding.severity == Severity::error;
      warnings += finding.severity == Severity::warning;
      notes += finding.severity == Severity::note;
    }
  out += fmt::format("{}: {}, {}, {}: ", page.file, counted(page.models.size(), "model"), counted(page.data_blocks, "data block"),
                     counted(page.tasks.size(), "task"));
  std::vector<std::string> found;
  if (page.errors > 0) found.push_back(counted(page.errors, "error"));
  if (serious > 0) found.push_back(counted(serious, "serious finding"));
  if (warnings > 0) found.push_back(counted(warnings, "warning"));
  bool const all = std::all_of(page.tasks.begin(), page.tasks.end(), [](TaskPage const& task) {
    return std::all_of(task.preflights.begin(), task.preflights.end(),
                       [](PreflightPage const& each) { return each.not_examined.empty(); });
  });
  if (found.empty()) found.push_back(all ? "no errors or warnings" : "no errors or warnings in the parts that were checked");
  if (notes > 0) found.push_back(counted(notes, "note"));
  out += fmt::format("{}\n", fmt::join(found, ", "));
  return out;
}

}  // namespace sysid

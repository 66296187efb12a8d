// Each section with the figures that belong to its numbers.
#include "report/html_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/xml.hpp"
#include "report/html_words.hpp"
#include "report/number.hpp"
#include "report/typeset.hpp"

namespace sysid {

namespace {

/// Where a figure stands.
enum class Topic { result, fit, chains };

Topic topic_of(plot::Figure const& figure) {
  auto const begins = [&](std::initializer_list<std::string_view> words) {
    return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return figure.name.starts_with(word); });
  };
  if (begins({"trace", "ranks"})) return Topic::chains;
  if (begins(
          {"fit_", "state_", "residuals_", "correlation_", "input_", "inputs_", "loop_", "hysteresis_", "surface_", "restoring_"}))
    return Topic::fit;
  return Topic::result;
}

std::string named(std::string const& name, std::string const& unit) {
  std::string const text = pretty_unit(unit);
  return escape(name) + (text.empty() || text == "-" ? "" : fmt::format(" <span class=\"unit\">{}</span>", escape(text)));
}

/// A cell of a table that other writers share: a number or a unit as a page shows it.
std::string cell_html(std::string const& text, std::string const& column) {
  if (column == "unit") return escape(pretty_unit(text));
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  bool const number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return number ? pretty_number(text) : escape(text);
}

class Task {
 public:
  Task(Report const& report, std::vector<DrawnFigure> const& figures, std::string prefix, int level)
      : report_(report), figures_(figures), prefix_(std::move(prefix)), level_(level) {}

  std::vector<HtmlSection> sections() {
    std::vector<HtmlSection> out;
    auto const add = [&](std::string const& id, std::string const& title, std::string body, std::string kind = {}) {
      if (!body.empty()) out.push_back({prefix_ + id, title, std::move(body), std::move(kind)});
    };
    add("verdict", "Verdict", verdict(), fmt::format("verdict {}", verdict_kind(report_)));
    add("model", report_.discovery ? "Equations found" : "Model", model());
    add("result", result_title(), result());
    add("fit", report_.draws.total() == 0 && !report_.selection ? "Prediction" : "Fit", fit());
    add("diagnostics", "Diagnostics of the chains", chains());
    add("modes", "Modes", modes());
    add("simulations", "Simulations and failures", simulations());
    add("data", "Data", data());
    add("settings", "Settings and versions", settings());
    add("repeat", "To repeat this", repetition());
    return out;
  }

 private:
  std::string heading(std::string_view title) const { return fmt::format("<h{0}>{1}</h{0}>\n", level_ + 1, escape(title)); }

  std::string pictures(Topic topic) {
    std::string shown, left_out;
    for (DrawnFigure const& drawn : figures_) {
      if (topic_of(drawn.figure) != topic) continue;
      if (drawn.svg) {
        ++number_;
        shown += figure_html(drawn, fmt::format("{}figure-{}", prefix_, number_), number_);
      } else {
        left_out += fmt::format("<li>{} ({})</li>\n", escape(drawn.figure.title),
                                code(fmt::format("figures/{}.gnuplot", drawn.figure.name)));
      }
    }
    if (left_out.empty()) return shown;
    return shown +
           fmt::format(
               "<div class=\"missing\"><p>Left out, since figures were not asked for, or gnuplot is not installed or refused "
               "them. Install it (<code>apt-get install gnuplot-nox</code>) and make this page again with <code>sysid "
               "report</code>, or draw the scripts beside this page:</p>\n<ul>\n{}</ul></div>\n",
               left_out);
  }

  std::string verdict() const {
    if (!has_verdict(report_)) return "";
    std::string out = fmt::format("<p class=\"headline\">{}</p>\n{}", marked(capitalised(verdict_headline(report_))),
                                  paragraph(verdict_meaning(report_)));
    if (report_.findings.empty()) return out;
    out += "<ul>\n";
    std::vector<Finding> findings = report_.findings;
    std::stable_sort(findings.begin(), findings.end(), [](Finding const& a, Finding const& b) { return a.severity < b.severity; });
    for (Finding const& finding : findings)
      out +=
          fmt::format("<li class=\"{0}\"><b>{1}</b> {2}{3} <span class=\"code\">{4}</span></li>\n", severity_word(finding.severity),
                      finding.severity == Severity::error     ? "Failed:"
                      : finding.severity == Severity::warning ? "Look at:"
                                                              : "Note:",
                      marked(finding.message),
                      finding.help.empty() ? "" : fmt::format(". <span class=\"help\">What to do: {}</span>", marked(finding.help)),
                      code(finding.code));
    return out + "</ul>\n<p class=\"note\">More about a word in this type: <code>sysid explain</code> and the word.</p>\n";
  }

  std::string model() const {
    std::string out;
    if (!report_.equations.empty()) {
      out += "<div class=\"equations\" role=\"group\" tabindex=\"0\" aria-label=\"Equations\">\n";
      for (std::string const& equation : typeset(report_.equations)) out += fmt::format("<p>{}</p>\n", equation);
      out += "</div>\n";
    }
    HtmlTable priors{"Priors", {"parameter", "prior"}, {}, 2};
    for (PriorInfo const& prior : report_.priors)
      if (std::none_of(report_.summary.begin(), report_.summary.end(), [&](Summary const& s) { return s.name == prior.name; }))
        priors.rows.push_back({named(prior.name, prior.unit), code(prior.text)});
    if (!priors.rows.empty()) out += html(priors);
    return out + folded("The model as it was written", report_.model_text);
  }

  std::string result_title() const {
    if (report_.selection) return "Models and their parameters";
    if (report_.discovery) return "Terms and coefficients";
    return "Parameters: from prior to posterior";
  }

  std::string parameters() const {
    if (report_.summary.empty()) return "";
    bool const optimum = report_.draws.total() == 1;
    HtmlTable table{"Priors against posteriors", {"parameter", "prior"}, {}, 3};
    bool const priors = !report_.priors.empty();
    table.header.push_back(priors ? "posterior within it" : "");
    for (std::string const& column :
         optimum ? std::vector<std::string>{"optimum", "sd"} : std::vector<std::string>{"mean", "sd", "5 %", "median", "95 %"})
      table.header.push_back(column);
    for (Summary const& s : report_.summary) {
      if (s.coefficient) continue;
      SummaryText const t = format_summary(s);
      auto const prior =
          std::find_if(report_.priors.begin(), report_.priors.end(), [&](PriorInfo const& each) { return each.name == s.name; });
      bool const known = prior != report_.priors.end();
      std::vector<std::string> row = {named(s.name, s.unit), known ? code(prior->text) : "follows from the others", ""};
      if (known && prior->q5 && prior->q95)
        row[1] += fmt::format("<br/><span class=\"unit\">{} to {}</span>", pretty_number(significant(*prior->q5, 3)),
                              pretty_number(significant(*prior->q95, 3)));
      if (auto const ratio = known ? narrowing(*prior, s) : std::nullopt) {
        auto const [low, high] = interval_90(s);
        row[2] =
            range_chart(*prior->q5, *prior->q95, low, high, s.mean,
                        fmt::format("{} from {} to {}, prior from {} to {}", s.name, significant(low, 3), significant(high, 3),
                                    significant(*prior->q5, 3), significant(*prior->q95, 3))) +
            fmt::format("<br/><span class=\"unit\">{}</span>",
                        *ratio < hardly_narrower ? "hardly narrower"
                                                 : pretty_number(significant(*ratio, *ratio < 10 ? 2 : 3)) + " times narrower");
      }
      for (std::string const& cell :
           optimum ? std::vector<std::string>{t.mean, t.sd} : std::vector<std::string>{t.mean, t.sd, t.q5, t.median, t.q95})
        row.push_back(pretty_number(cell));
      table.rows.push_back(std::move(row));
    }
    std::string out = html(table) + paragraph(learning_words(report_));
    return out + paragraph(std::string(optimum ? "sd: of the normal approximation at the optimum (Laplace). "
                                               : "Digits end where the Monte Carlo error begins. ") +
                               (priors ? "Below each prior the interval that holds 90 % of it, beside it the posterior's within "
                                         "that: dark, with a stroke at the "
                                         "mean, on a logarithmic scale where the prior's is positive and spans more than a decade."
                                       : ""),
                           "note");
  }

  std::string result() {
    std::string out = parameters();
    if (report_.evidence)
      if (std::string const text = evidence_text(*report_.evidence); !text.empty())
        out += paragraph(
            fmt::format("The model as a whole: {}. {}", text,
                        report_.evidence->log_evidence
                            ? "It has a meaning only beside that of another model of the same samples: `sysid compare` sets "
                              "them side by side, and a difference of 5 is strong."
                            : ""));
    for (ReportTable const& extra : report_.tables) {
      HtmlTable table{capitalised(extra.title), {}, {}, 1};
      for (std::string const& cell : extra.header) table.header.push_back(escape(cell));
      for (auto const& row : extra.rows) {
        table.rows.emplace_back();
        for (std::size_t c = 0; c < row.size(); ++c)
          table.rows.back().push_back(cell_html(row[c], c < extra.header.size() ? extra.header[c] : ""));
      }
      out += html(table) + paragraph(extra.caption, "note");
    }
    return out + pictures(Topic::result);
  }

  static std::string score_title(std::string const& name) {
    if (name == "nmse") return "NMSE [%]";
    if (name == "nmse_left_out") return "NMSE, left out one by one [%]";
    if (name == "rmse") return "RMSE";
    if (name == "chi_squared_per_sample") return "χ² per sample";
    if (name == "coverage_95") return "share inside the 95 % band";
    if (name == "coverage_3sd") return "share within 3 sd";
    if (name == "whiteness_p") return "whiteness of the residuals, p";
    if (name == "input_correlation_p") return "residuals uncorrelated with the input, p";
    if (name.starts_with("input_correlation_p("))
      return fmt::format("residuals uncorrelated with {}, p", escape(name.substr(20, name.size() - 21)));
    return escape(name);
  }

  /// Of one channel with what each score says; of several as a table, and what the worst of each score says behind it.
  std::string scores() const {
    std::vector<FitLine> const lines = fit_lines(report_);
    if (lines.empty()) return "";
    std::vector<std::string> names;
    for (FitLine const& line : lines)
      for (Score const& score : line.scores)
        if (std::find(names.begin(), names.end(), score.name) == names.end()) names.push_back(score.name);
    auto const cell = [&](FitLine const& line, std::string const& name) {
      auto const score = std::find_if(line.scores.begin(), line.scores.end(), [&](Score const& each) { return each.name == name; });
      if (score == line.scores.end()) return std::string();
      std::string const value = pretty_number(significant(score->value, 4));
      return name == "rmse" && !line.unit.empty() ? named(value, line.unit) : value;
    };
    std::string out;
    if (lines.size() == 1) {
      HtmlTable table{fmt::format("Scores of {}", lines[0].what()), {"score", "value", "what it says"}, {}, 1};
      table.last_is_words = true;
      for (std::string const& name : names)
        table.rows.push_back({score_title(name), cell(lines[0], name), escape(score_words(report_, lines, name))});
      out = html(table);
    } else {
      HtmlTable table{"Scores", {"channel"}, {}, 1};
      for (std::string const& name : names) table.header.push_back(score_title(name));
      for (FitLine const& line : lines) {
        table.rows.push_back({escape(line.what())});
        for (std::string const& name : names) table.rows.back().push_back(cell(line, name));
      }
      out = html(table) + "<dl>\n";
      for (std::string const& name : names)
        if (std::string const words = score_words(report_, lines, name); !words.empty())
          out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", score_title(name), escape(words));
      out += "</dl>\n";
    }
    return out + paragraph(
                     "NMSE: mean squared error as a percentage of the variance of what was measured; RMSE: its root, in the "
                     "channel's unit. Bands include the noise.",
                     "note");
  }

  std::string fit() {
    std::string out = scores();
    return out + pictures(Topic::fit);
  }

  std::string chains() {
    std::vector<ChainWords> const words = chain_words(report_);
    if (words.empty()) return "";
    std::string out = "<dl>\n";
    for (ChainWords const& each : words)
      out += fmt::format("<dt class=\"{}\">{} {}</dt><dd>{}</dd>\n", each.good ? "good" : "bad", each.good ? "✓" : "✗",
                         escape(each.name), escape(each.words));
    out += "</dl>\n";
    HtmlTable table{"Convergence", {"parameter", "R-hat", "bulk ESS", "tail ESS", "Monte Carlo error of the mean"}, {}, 1};
    for (Summary const& s : report_.summary) {
      if (s.coefficient) continue;
      SummaryText const t = format_summary(s);
      table.rows.push_back({named(s.name, s.unit), t.rhat, t.ess_bulk, t.ess_tail, pretty_number(significant(s.mcse_mean, 2))});
    }
    return out + html(table) +
           paragraph("Rank-normalised split R-hat and effective sample sizes (ESS) after Vehtari et al. (2021).", "note") +
           pictures(Topic::chains);
  }

  std::string modes() const {
    if (report_.modes.empty()) return "";
    HtmlTable table{"Modes that the global search over the prior found", {"mode", "share", "log density"}, {}, 1};
    std::size_t const count = std::min(report_.modes[0].declared.size(), report_.draws.names.size());
    for (std::size_t i = 0; i < count; ++i) table.header.push_back(escape(report_.draws.names[i]));
    for (std::size_t m = 0; m < report_.modes.size(); ++m) {
      Mode const& mode = report_.modes[m];
      table.rows.push_back(
          {std::to_string(m + 1), pretty_number(significant(mode.share, 3)), pretty_number(significant(mode.log_density, 6))});
      for (std::size_t i = 0; i < std::min(count, mode.declared.size()); ++i)
        table.rows.back().push_back(pretty_number(significant(mode.declared[i], 4)));
    }
    double const second = report_.modes.size() > 1 ? report_.modes[1].share : 0;
    return paragraph(report_.modes.size() == 1
                         ? "One mode was found: no other values of the parameters explain the data nearly as well."
                     : second > 0.01 ? "Several modes carry weight: the parameters are not told by these data alone."
                                     : "Other modes were found and carry next to no weight.") +
           html(table) + paragraph("Share: of the Laplace masses of all modes.", "note");
  }

  std::string simulations() const {
    std::string out = paragraph(ledger_words(report_));
    if (report_.ledger.failures().empty()) return out;
    std::string unit = "s";
    double scale = 1;
    if (!report_.predictions.empty()) unit = report_.predictions.front().time_unit, scale = report_.predictions.front().time_scale;
    HtmlTable table{"Failures by kind and place", {"kind", "where", "count", fmt::format("first at t [{}]", escape(unit))}, {}, 2};
    for (Failure const& failure : report_.ledger.failures())
      table.rows.push_back({escape(name(failure.kind)), escape(failure.where), std::to_string(failure.count),
                            std::isnan(failure.time) ? "" : pretty_number(significant(failure.time / scale, 4))});
    return out + html(table);
  }

  std::string data() const {
    std::string out;
    for (DataInfo const& data : report_.data) {
      out += heading(data.name);
      out += fmt::format("<p>{}, {} rows, {} of them scored{}.</p>\n", code(data.file), data.rows, data.scored,
                         data.scored_rows.empty() ? "" : fmt::format(" ({})", escape(data.scored_rows)));
      if (!data.notes.empty()) {
        out += "<ul>\n";
        for (std::string const& note : data.notes) out += fmt::format("<li>{}</li>\n", marked(note));
        out += "</ul>\n";
      }
      out += fmt::format("<p class=\"digest\">sha256 {}</p>\n", escape(data.sha256));
    }
    return out;
  }

  std::string settings() const {
    auto const table = [](std::string const& caption, std::string const& first, Facts const& facts) {
      HtmlTable out{caption, {first, "value"}, {}, 2};
      for (auto const& [name, value] : facts) out.rows.push_back({escape(name), escape(setting_text(value))});
      return facts.empty() ? "" : html(out);
    };
    return table("Settings, those left at their defaults included", "setting", report_.settings) +
           table("Versions", "of", report_.versions);
  }

  std::string repetition() const {
    std::string out;
    for (std::string const& task : report_.unseeded)
      out += fmt::format("<p>The seed of {} was drawn. Write it into the file first, where the task is: {}</p>\n", code(task),
                         code(task == report_.task ? fmt::format("seed = {}", report_.seed) : "seed = the one on its page"));
    if (!report_.command.empty())
      out += fmt::format(
          "<p>From the folder in which the run was started:</p>\n<pre class=\"command\" tabindex=\"0\" role=\"group\" "
          "aria-label=\"Command\"><code>{}</code></pre>\n",
          escape(report_.command));
    out += fmt::format(
        "<p>Seed {}. The same file, data, seed and version of the program give the same draws, byte for byte, for any number "
        "of threads.</p>\n",
        report_.seed);
    return out + folded("The file that repeats this task, every setting spelt out", report_.resolved_text);
  }

  Report const& report_;
  std::vector<DrawnFigure> const& figures_;
  std::string prefix_;
  int level_;
  int number_ = 0;  // of figures shown
};

}  // namespace

std::string_view verdict_kind(Report const& report) {
  if (!has_verdict(report)) return "plain";
  Severity const worst = grade(report);
  return worst == Severity::error ? "bad" : worst == Severity::warning ? "doubtful" : "good";
}

std::vector<HtmlSection> task_sections(Report const& report, std::vector<DrawnFigure> const& figures, std::string const& prefix,
                                       int level) {
  return Task(report, figures, prefix, level).sections();
}

}  // namespace sysid

// What a page says beside its numbers: only what is so.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "example.hpp"
#include "report/figure/figures.hpp"
#include "report/file/selection.hpp"
#include "report/page/comparison.hpp"
#include "report/page/html.hpp"
#include "report/text/report_text.hpp"
#include "report/text/summary_text.hpp"

using namespace sysid;

namespace {

bool has(std::string const& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// All but one of `samples` samples, or all of them, inside a band.
std::string page_with_coverage(std::size_t samples, double share, ScoreKind score = ScoreKind::coverage_95, bool counts = false) {
  Report report = example::duffing(20);
  Prediction& prediction = report.predictions[0];
  prediction.scored.assign(prediction.scored.size(), 0);
  std::fill_n(prediction.scored.begin(), samples, 1);
  report.fit = {{"bench.train", "displacement", "mm", {{{score}, share}}}};
  if (counts)
    for (PredictedQuantity& quantity : prediction.quantities)
      for (double& value : quantity.measured) value = std::round(value);
  return report_html(report, {});
}

/// Two candidates chosen by distance; the first leads, and has a parameter that only the second one uses.
Report selected() {
  Report report = example::duffing(20);
  SelectionReport selection;
  for (auto const& [name, probability] : {std::pair{"law(cubic = 0)", 0.9}, {"law(cubic = 1)", 0.1}}) {
    SelectedModel model;
    model.name = name;
    model.probability = probability;
    model.parameters = {{"k", "N/m", 0, 1}, {"k3", "N/m^3", 0, 1}};
    model.declared = LaneArray(2, 40);
    for (int j = 0; j < 40; ++j) model.declared(0, j) = 100 + j, model.declared(1, j) = 5 + j % 7;
    model.weight.assign(40, 1.0 / 40);
    model.distance = model.weight;
    model.summaries = {{"k", "N/m", 120, 11, 120, 102, 138}, {"k3", "N/m^3", 8, 2, 8, 5, 11}};
    selection.result.models.push_back(std::move(model));
  }
  selection.result.models[0].absent = {"k3"};
  selection.result.populations.resize(1);
  report.verb = "select";
  report.draws = {};
  report.summary.clear();
  report.modes.clear();
  report.tables = selection_tables(selection);
  report.selection = std::move(selection);
  return report;
}

plot::Figure figure_of(Report const& report, std::string_view name) {
  for (plot::Figure& each : figures(report))
    if (each.name == name) return each;
  FAIL("no figure " << name);
  return {};
}

}  // namespace

TEST_CASE("a band is too wide or too narrow only where chance would not do it") {
  CHECK(has(page_with_coverage(21, 1), "consistent with the data"));    // 0.95^21 = 34 %
  CHECK(has(page_with_coverage(100, 1), "too wide for these data"));    // 0.95^100 = 0.6 %
  CHECK(has(page_with_coverage(80, 1), "consistent with the data"));    // 0.95^80 = 1.7 %
  CHECK(has(page_with_coverage(10, 0.8), "consistent with the data"));  // two of ten or more: 8.6 %
  CHECK(has(page_with_coverage(200, 0.8), "too narrow for these data"));
}

TEST_CASE("bands of counts hold more than their share, and three sds of other noise than normal have no share of their own") {
  std::string const counts = page_with_coverage(100, 1, ScoreKind::coverage_95, true);
  CHECK(has(counts, "at least 95.0 % are expected: the width of the bands is consistent with the data"));
  CHECK(has(page_with_coverage(100, 0.8, ScoreKind::coverage_95, true), "too narrow for these data"));
  std::string const skewed = page_with_coverage(100, 0.96, ScoreKind::coverage_3sd);
  CHECK(has(skewed, "96.0 % of the scored samples lie within three sds"));
  CHECK(has(skewed, "; of normal noise, 99.7 % are expected."));
}

TEST_CASE("bands include the noise where there are such bands, and a small p value is a bound") {
  Report report = example::duffing(20);
  CHECK(has(report_html(report, {}), "Bands include the noise."));
  for (PredictedQuantity& each : report.predictions[0].quantities) each.noisy = {};
  report.fit = {{"bench.train", "displacement", "mm", {{{ScoreKind::nmse}, 5.4}, {{ScoreKind::whiteness}, 3.639e-111}}}};
  std::string const page = report_html(report, {});
  CHECK(!has(page, "Bands include the noise."));
  CHECK(has(page, "&lt;\u00a00.0001"));
  CHECK(!has(page, "10⁻¹¹¹"));
}

TEST_CASE("captions name no brightness, which the dark page turns round") {
  std::vector<plot::Figure> all = figures(example::duffing(40));
  for (plot::Figure& each : figures(selected())) all.push_back(std::move(each));
  CHECK(all.size() > 8);
  for (plot::Figure const& figure : all)
    for (char const* word : {"dark", "light", "bright"}) CHECK_MESSAGE(!has(figure.caption, word), figure.caption);
  std::string page = report_html(example::duffing(40), {});
  CHECK(!has(page.substr(page.find("<main")), "dark"));
}

TEST_CASE("captions name the experiment where there are several") {
  Report report = example::duffing(40);
  for (plot::Figure const& figure : figures(report)) CHECK_MESSAGE(!has(figure.caption, " on bench.train"), figure.caption);
  report.predictions.push_back(report.predictions[0]);
  report.predictions[1].experiment = "bare.train";
  std::vector<plot::Figure> const all = figures(report);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK_MESSAGE(all[i].caption != all[j].caption, all[i].caption);
}

TEST_CASE("the parametric part of a channel is called so") {
  Report report = example::duffing(40);
  PredictedQuantity& state = report.predictions[0].quantities[1];
  CHECK(has(fit_figure(report.predictions[0], state).caption, "which is not measured"));
  state.name = "white(deflection)";
  plot::Figure const figure = fit_figure(report.predictions[0], state);
  CHECK(
      figure.caption.starts_with("The parametric part of deflection: what the model predicts with every Gaussian process at zero"));
  CHECK(!has(figure.title + figure.caption, "white("));
}

TEST_CASE("what the arguments of a candidate take out of it is no estimate") {
  Report const report = selected();
  ReportTable const& table = report.tables[2];
  CHECK(table.title == "parameters of law(cubic = 0)");
  CHECK(table.rows.size() == 1);
  CHECK(has(table.caption, "Not in this model, so left at their priors: k3."));
  CHECK(report.tables[3].rows.size() == 2);
  CHECK(!has(report.tables[3].caption, "Not in this model"));
  CHECK(!has(figure_of(report, "posterior").script, "k3"));
}

TEST_CASE("particles are not called a posterior, chains on the likelihood are drawn in their place") {
  Report report = selected();
  CHECK(figure_of(report, "posterior").caption.starts_with("Marginals of the particles"));
  CHECK(has(figure_of(report, "posterior").caption, "is not the spread of the posterior"));
  Report const fit = example::duffing(40);
  report.selection->refined_draws = {fit.draws, {}};
  report.selection->refined = {fit.summary, {}};
  plot::Figure const chains = figure_of(report, "posterior");
  CHECK(chains.caption.starts_with("Marginal posteriors"));
  CHECK(!has(chains.caption, "particles"));
  CHECK(has(chains.script, "beta"));  // of the noise, which particles do not have
}

TEST_CASE("the page of a selection is titled by its candidates, and says whose equations it shows") {
  std::string const page = report_html(selected(), {});
  CHECK(has(page, "<h1>law(cubic = 0) or law(cubic = 1)</h1>"));
  CHECK(has(page, "<code>law(cubic = 0)</code>, the most probable of 2 models:"));
  CHECK(!has(report_html(example::duffing(20), {}), "the most probable of"));
}

TEST_CASE("a prediction and a track show no priors, and a track draws nothing") {
  Report report = example::duffing(20);
  report.draws = {};
  report.summary.clear();
  CHECK(has(report_html(report, {}), ">Priors<"));
  report.verb = "predict";
  CHECK(!has(report_html(report, {}), ">Priors<"));
  CHECK(has(report_html(report, {}), "give the same draws"));
  report.verb = "track";
  report.tables = {{"parameters", "", {"parameter", "row 2"}, {{"k [N/m]", "5.0184e9 ± 2.4e7"}}}};
  std::string page = report_html(report, {});
  CHECK(!has(page, ">Priors<"));
  CHECK(!has(page, "same draws"));
  CHECK(!has(page, "from prior to posterior"));
  CHECK(has(page, ">Changes and parameters</h2>"));
  CHECK(has(page, ">Parameters along the rows</h2>"));
  CHECK(has(page, "5.0184·10⁹ ± 2.4·10⁷"));
  report.verdict = "no change found in 10 rows";
  report.findings.clear();
  CHECK(has(report_html(report, {}), "no change was found. There may still be one"));
  report.findings = {{FindingCode::parameter_changed, Severity::warning, {"k"}, "`k` fell", ""}};
  page = report_html(report, {});
  CHECK(!has(page, "That nothing was found"));
  CHECK(has(page, "class=\"part verdict doubtful\""));
}

TEST_CASE("the page of a crosscheck speaks of its two fits, and of no bands") {
  Report report = example::duffing(20);
  report.verb = "crosscheck";
  report.draws = {};
  report.summary.clear();
  report.predictions.clear();
  report.tables = {{"both back ends", "", {"quantity", "mh", "nuts"}, {{"k", "1.0", "1.1"}}}};
  report.verdict = "mh and nuts agree";
  report.findings.clear();
  report.ledger = {};
  report.ledger.add_solves(10);
  report.ledger.add_failure(FailureClass::non_finite, "k*y", 0, {});
  std::string page = report_html(report, {});
  CHECK(has(page, "The back ends agree, as far as this comparison can show"));
  CHECK(has(page, ">Both back ends</h2>"));
  CHECK(has(page, "Parameters whose simulation fails are rejected"));
  CHECK(has(page, "give the same result"));
  CHECK(!has(page, "The bands"));
  report.findings = {{FindingCode::backends_disagree, Severity::error, {"k"}, "the means of `k` differ", "run both longer"}};
  page = report_html(report, {});
  CHECK(has(page, "Until this is fixed, do not rely on the draws of either back end."));
  CHECK(!has(page, "the bands below"));
}

TEST_CASE("rows at which a change was found are upright lines") {
  Report report = example::duffing(40);
  PredictedQuantity& state = report.predictions[0].quantities[1];
  CHECK(!has(fit_figure(report.predictions[0], state).script, "change found"));
  state.alarms = {report.predictions[0].time[10], 1e9};  // the second lies outside of what is shown
  plot::Figure const figure = fit_figure(report.predictions[0], state);
  CHECK(has(figure.script, "'change found'"));
  CHECK(has(figure.script, "$alarm0"));
  CHECK(!has(figure.script, "$alarm1"));
}

TEST_CASE("models are compared with the best first, and no probability reads as certain") {
  Comparison comparison;
  comparison.data = "bench";
  ComparedFit worse, best, without;
  worse.name = "a", worse.log_evidence = -20, worse.probability = 1e-9;
  best.name = "b", best.log_evidence = 0, best.probability = 1 - 1e-9;
  without.name = "c";
  comparison.fits = {worse, without, best};
  ReportTable const table = comparison_tables(comparison)[0];
  REQUIRE(table.rows.size() == 3);
  CHECK(table.rows[0][0] == "b");
  CHECK(table.rows[1][0] == "a");
  CHECK(table.rows[2][0] == "c");
  CHECK(table.rows[0][7] == "> 0.999");
  CHECK(table.rows[1][7] == "< 0.001");
}

TEST_CASE("numbers within words have minus signs and powers of ten, names stay") {
  CHECK(pretty_numbers("log evidence -304.41 ± 0.02") == "log evidence −304.41 ± 0.02");
  CHECK(pretty_numbers("5.47e-8 (5e-10)") == "5.47·10⁻⁸ (5·10⁻¹⁰)");
  CHECK(pretty_numbers("< 1e-6") == "< 1·10⁻⁶");
  CHECK(pretty_numbers("-1.87e-05 m") == "−1.87·10⁻⁵ m");
  for (char const* same : {"rows 1..500 of 1e3x", "fit-1 and k3", "2024-05-01", "`k = -1e-6`", "3rd", "v-2", ""})
    CHECK(pretty_numbers(same) == same);
}

TEST_CASE("on the page a mean ends at a hundredth of its sd, however well it is known") {
  Summary summary;
  summary.mean = summary.median = summary.q5 = summary.q95 = 20.02508;
  summary.sd = 0.016;
  summary.mcse_mean = 1e-5;
  CHECK(format_summary(summary).mean == "20.02508");
  CHECK(format_summary(summary, true).mean == "20.0251");
  summary.mcse_mean = 0.01;
  CHECK(format_summary(summary, true).mean == "20.03");
}

// The page: self-contained, escaped, and honest about figures that are missing.
#include "report/page/html.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "example.hpp"
#include "page_rules.hpp"
#include "report/figure/figures.hpp"
#include "report/file/discovery.hpp"
#include "report/file/selection.hpp"
#include "report/page/html_style.hpp"

using namespace sysid;

namespace {

std::vector<DrawnFigure> all_drawn(Report const& report) {
  std::vector<DrawnFigure> out;
  for (plot::Figure const& figure : figures(report))
    out.push_back({figure,
                   "<svg \n viewBox=\"0 0 1 1\"\n>\n<title>own</title><defs><circle id='dot' r='1'/></defs><g "
                   "id=\"plot\"><use xlink:href='#dot'/></g></svg>\n"});
  return out;
}

/// The value of a colour variable: the last one that the sheet gives before `end`.
std::string colour(std::string_view name, std::size_t end) {
  std::string const variable = std::string(" --") + std::string(name) + ": #";
  std::size_t const at = page_style.substr(0, end).rfind(variable);
  REQUIRE_MESSAGE(at != std::string_view::npos, name);
  return std::string(page_style.substr(at + variable.size(), 6));
}

/// (L1 + 0.05)/(L2 + 0.05) of the relative luminances                                    WCAG 2.2, contrast ratio
double contrast_ratio(std::string const& a, std::string const& b) {
  auto const luminance = [](std::string const& hex) {
    auto const channel = [&](std::size_t at) {
      double const c = std::stoi(hex.substr(at, 2), nullptr, 16) / 255.0;
      return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * channel(0) + 0.7152 * channel(2) + 0.0722 * channel(4);
  };
  double const la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

}  // namespace

TEST_CASE("the style sheet knows the width of a column") {
  CHECK(report_html(example::duffing(20), {}).find(fmt::format("viewBox^=\"0 0 {} \"", plot::column_width)) != std::string::npos);
}

TEST_CASE("the rules of a page find what breaks them") {
  Report report = example::duffing(20);
  report.priors[0].q5 = 0.126;
  report.priors[0].q95 = 7.94;
  std::string const page = report_html(report, {});
  CHECK(test::broken_rules(page) == "");
  auto const breaks = [&](std::string const& from, std::string const& to) {
    std::string changed = page;
    std::size_t const at = changed.find(from);
    REQUIRE_MESSAGE(at != std::string::npos, from);
    return !test::broken_rules(changed.replace(at, from.size(), to)).empty();
  };
  CHECK(breaks("</h1>", "</h2>"));
  CHECK(breaks("<footer>", "<footer><img src=\"https://example.org/x.png\"/>"));
  CHECK(breaks("href=\"#content\"", "href=\"https://example.org\""));
  CHECK(breaks("scope=\"row\"", ""));
  CHECK(breaks("role=\"img\"", ""));
  CHECK(breaks("<h2 id=\"model-title\">Model</h2>", "<h4 id=\"model-title\">Model</h4>"));
  CHECK(breaks("<style>", "<style>@import 'x.css';"));
  CHECK(breaks("id=\"model\"", "id=\"data\""));
}

TEST_CASE("pages keep the rules whatever is in them") {
  Report report = example::duffing(20);
  CHECK(test::broken_rules(report_html(report, all_drawn(report))) == "");
  Report none;
  CHECK(test::broken_rules(report_html(none, {})) == "");
  Report optimum = example::duffing(20);
  optimum.draws.chains.resize(1);
  optimum.draws.chains[0].values.resize(1);
  for (Summary& summary : optimum.summary) summary.q5 = summary.q95 = summary.rhat = summary.ess_bulk = std::nan("");
  CHECK(test::broken_rules(report_html(optimum, {})) == "");
  Report hostile = example::duffing(20);
  static constexpr char raw[] = "]]>&<\"' \x01\x1b\xff\xc0\xaf\xed\xa0\x80\xf5\x80\x80\x80\0 \xef\xbf\xbf \xe2\x82";
  std::string const bytes(raw, sizeof raw - 1);  // a zero byte among them
  hostile.task = hostile.what = hostile.model_title = hostile.model_text = hostile.command = bytes;
  hostile.equations = {bytes};
  hostile.formulas = {""};
  hostile.findings.push_back({FindingCode::noise_size, Severity::error, {bytes}, bytes, bytes});
  hostile.summary[0].name = hostile.priors[0].name = hostile.summary[0].unit = bytes;
  hostile.data[0].notes = {bytes};
  hostile.tables.push_back({bytes, bytes, {bytes, bytes}, {{bytes, bytes}}});
  CHECK(test::broken_rules(report_html(hostile, {})) == "");
}

TEST_CASE("pages of several tasks keep the rules, their ids apart") {
  Report const one = example::duffing(20), other = example::duffing(30);
  CHECK(test::broken_rules(run_html({{{one, all_drawn(one)}, {other, all_drawn(other)}},
                                     {{"fitted to a & b", "c has no evidence: <d>", {"fit", "log evidence"}, {{"e", "-"}}}},
                                     "The fits are of two samples. ",
                                     {"late & <lost>"}})) == "");
  CHECK(test::broken_rules(run_html({{}, {}, "", {"late"}})) == "");
}

TEST_CASE("text stands out from what is behind it, light and dark") {
  std::size_t const dark = page_style.find("@media screen and (prefers-color-scheme: dark)");
  REQUIRE(dark != std::string_view::npos);
  for (std::size_t const end : {dark, page_style.size()})
    for (char const* paper : {"paper", "faint"}) {
      for (char const* text : {"ink", "muted", "accent", "good", "doubtful", "bad"}) {
        CAPTURE(text);
        CAPTURE(paper);
        CAPTURE(end == dark);
        CHECK(contrast_ratio(colour(text, end), colour(paper, end)) >= 4.5);
      }
      CHECK(contrast_ratio(colour("fig-ink", end), colour(paper, end)) >= 4.5);
      CHECK(contrast_ratio(colour("fig-muted", end), colour(paper, end)) >= 4.5);
    }
  CHECK(contrast_ratio("ffffff", "000000") == doctest::Approx(21));
  CHECK(contrast_ratio("777777", "ffffff") == doctest::Approx(4.48).epsilon(1e-3));
}

TEST_CASE("a picture has the title of its figure, not gnuplot's, and identifiers of its own") {
  Report const report = example::duffing(20);
  std::string const page = report_html(report, all_drawn(report));
  CHECK(page.find("aria-label=\"Posterior and prior\"") != std::string::npos);
  CHECK(page.find("own</title>") == std::string::npos);
  CHECK(page.find("id=\"plot\"") == std::string::npos);
  CHECK(page.find("id='dot'") == std::string::npos);
  CHECK(page.find("xlink:href=\"#figure-1-dot\"") != std::string::npos);
}

TEST_CASE("figures stand with the numbers that they belong to") {
  Report const report = example::duffing(20);
  std::string const page = report_html(report, all_drawn(report));
  auto const section = [&](std::string const& id) {
    std::size_t const begin = page.find("<section id=\"" + id + "\"");
    return page.substr(begin, page.find("</section>", begin) - begin);
  };
  CHECK(section("result").find("Marginal posteriors") != std::string::npos);
  CHECK(section("result").find("Draws of each pair of parameters") != std::string::npos);
  CHECK(section("fit").find("Measured and modelled displacement") != std::string::npos);
  CHECK(section("fit").find("Autocorrelation of the residuals") != std::string::npos);
  CHECK(section("diagnostics").find("Draws of each chain") != std::string::npos);
}

TEST_CASE("what stands in backquotes is code, words begin with a capital, formulas do not") {
  Report report = example::duffing(20);
  report.verdict = "x = 2*y'' + `k`*y; the checks pass";
  CHECK(report_html(report, {}).find("<p class=\"headline\">x = 2*y'' + <code>k</code>*y; the checks pass</p>") !=
        std::string::npos);
  report.verdict = "the checks pass ` as ever";
  CHECK(report_html(report, {}).find("<p class=\"headline\">The checks pass ` as ever</p>") != std::string::npos);
}

TEST_CASE("sentences follow the values and never contradict the checks") {
  Report report = example::duffing(20);
  report.predictions.clear();
  auto const says = [&](std::vector<Score> scores, std::string const& words) {
    report.fit = {{"bench.train", "displacement", "mm", std::move(scores)}};
    return report_html(report, {}).find(words) != std::string::npos;
  };
  CHECK(says({{{ScoreKind::nmse}, 0.01}}, "can hardly be distinguished"));
  CHECK(says({{{ScoreKind::nmse}, 140}}, "no better than a constant equal to the mean"));
  CHECK(says({{{ScoreKind::coverage_95}, 0.94}}, "consistent with the data"));
  CHECK(says({{{ScoreKind::coverage_95}, 0.7}}, "too narrow"));
  CHECK(says({{{ScoreKind::coverage_95}, 1}}, "too wide for these data"));
  CHECK(says({{{ScoreKind::whiteness}, 2e-4}}, "the residuals are autocorrelated"));
  CHECK(says({{{ScoreKind::whiteness}, 0.02}}, "no autocorrelation of the residuals"));
  CHECK(says({{{ScoreKind::input_correlation, "heat"}, 1e-9}}, "residuals uncorrelated with heat, p"));
  CHECK(says({{{ScoreKind::input_correlation, "heat"}, 1e-9}}, "the residuals are correlated with the input"));
  CHECK(says({{{ScoreKind::chi_squared}, 0.6}}, "the noise explains them"));
  report.noise = {"sigma"};
  CHECK(says({{{ScoreKind::chi_squared}, 0.6}}, "was fitted to the residuals, so this does not test the model"));
  report.findings = {{FindingCode::noise_size, Severity::error, {}, "m", ""}};
  CHECK(says({{{ScoreKind::chi_squared}, 0.6}}, "smaller than in the model"));
  CHECK(says({{{ScoreKind::chi_squared}, 3}}, "larger than in the model"));
  CHECK(report_html(report, {}).find("narrow every parameter") == std::string::npos);  // nothing is learnt from what failed
}

TEST_CASE("of several channels the worst is named") {
  Report report = example::duffing(20);
  report.predictions.clear();
  report.fit = {{"a", "force", "N", {{{ScoreKind::nmse}, 1}}}, {"b", "force", "N", {{{ScoreKind::nmse}, 30}}}};
  std::string const page = report_html(report, {});
  CHECK(page.find("30.0 % of the measured variance is not explained (force on b)") != std::string::npos);
}

TEST_CASE("a parameter's prior stands beside its posterior, with how much narrower that is") {
  Report report = example::duffing(20);
  report.priors[0].q5 = 0.126;
  report.priors[0].q95 = 7.94;
  report.summary[0].q5 = 0.9;
  report.summary[0].q95 = 1.1;
  std::string const page = report_html(report, {});
  CHECK(page.find("0.126 to 7.94") != std::string::npos);
  CHECK(page.find("39.1 times narrower") != std::string::npos);
  CHECK(page.find("aria-label=\"m from 0.900 to 1.10, prior from 0.126 to 7.94\"") != std::string::npos);
}

TEST_CASE("mean and sd are the first columns of a parameter's row, its prior the last") {
  std::string const page = report_html(example::duffing(20), {});
  std::size_t const table = page.find("Posteriors against priors</span>");
  REQUIRE(table != std::string::npos);
  std::size_t at = table;
  for (char const* column : {">parameter<", ">mean<", ">sd<", ">5 %<", ">posterior within prior<", ">prior<"}) {
    CAPTURE(column);
    std::size_t const next = page.find(column, at);
    REQUIRE(next != std::string::npos);
    at = next;
  }
  CHECK(at < page.find("</thead>", table));
}

TEST_CASE("the page shows model, data, result, failures and how to repeat it") {
  Report report = example::duffing(20);
  report.command = "sysid run 'a b.sysid' -o results_again";
  std::string const page = report_html(report, {});
  for (char const* text : {"<h1>Duffing's oscillator</h1>", "sha256 9f86d081884c7d65", "1500 rows, 500 of them scored (1..500)",
                           ">Parameters: from prior to posterior</h2>", ">Diagnostics of the chains</h2>", ">Modes</h2>",
                           "100000 simulations, 3 of them failed (0.0030 %)", "Seed 1.", "25000",
                           "<code>sysid run 'a b.sysid' -o results_again</code>"})
    CHECK_MESSAGE(page.find(text) != std::string::npos, text);
}

TEST_CASE("the user's text cannot become markup") {
  Report report = example::duffing(20);
  report.task = "<b>x</b>";
  report.findings.push_back({FindingCode::at_bound, Severity::warning, {}, "a < b", "<i>"});
  std::string const page = report_html(report, {});
  CHECK(page.find("<b>x</b>") == std::string::npos);
  CHECK(page.find("&lt;b&gt;x&lt;/b&gt;") != std::string::npos);
  CHECK(page.find("a &lt; b") != std::string::npos);
  CHECK(page.find("# &lt;as printed&gt;") != std::string::npos);
}

TEST_CASE("what to do begins a line of its own, also below a finding that asks") {
  Report report = example::duffing(20);
  report.findings = {{FindingCode::sensor_stuck, Severity::warning, {}, "y stays at 3: clipped?", "look"},
                     {FindingCode::at_bound, Severity::warning, {}, "it is at 2", "look"}};
  std::string const page = report_html(report, {});
  CHECK(page.find("clipped?<br/><span class=\"help\">What to do: look") != std::string::npos);
  CHECK(page.find("it is at 2<br/><span class=\"help\">What to do: look") != std::string::npos);
}

TEST_CASE("the verdict box takes the colour of the worst finding") {
  Report report = example::duffing(20);
  CHECK(report_html(report, {}).find("class=\"part verdict good\"") != std::string::npos);
  report.findings.push_back({FindingCode::at_bound, Severity::warning, {}, "m", ""});
  CHECK(report_html(report, {}).find("class=\"part verdict doubtful\"") != std::string::npos);
  report.findings.push_back({FindingCode::noise_size, Severity::error, {}, "m", ""});
  CHECK(report_html(report, {}).find("class=\"part verdict bad\"") != std::string::npos);
}

TEST_CASE("figures that could not be drawn are named, with the way to get them") {
  std::string const page = report_html(example::duffing(20), {{{"trace", "Traces", "", ""}, std::nullopt},
                                                              {{"ranks", "Rank plots", "A caption.", ""}, "<svg >drawn</svg>"}});
  CHECK(page.find("<li>Traces (<code>figures/trace.gnuplot</code>)</li>") != std::string::npos);
  CHECK(page.find("gnuplot-nox") != std::string::npos);
  CHECK(page.find("<b>Figure 1.</b> A caption.") != std::string::npos);
}

TEST_CASE("what is said of modes is no more than a search can see, least of all where a check failed") {
  Report report = example::duffing(20);
  report.modes[0].hits = 3;
  auto const says = [&](char const* words) { return report_html(report, {}).find(words) != std::string::npos; };
  CHECK(says("The search found one mode, reached by 3 of its local searches. It found no other parameter values"));
  report.findings = {{FindingCode::noise_size, Severity::error, {}, "m", ""}};
  CHECK(says("The search found one mode, reached by 3 of its local searches. A check failed: a better mode may lie"));
  CHECK_FALSE(says("no other values"));
  CHECK_FALSE(says("search = everywhere"));
  report.findings.push_back({FindingCode::searched_near, Severity::note, {}, "m", ""});
  CHECK(says("<code>search = everywhere</code>"));
  report.modes.resize(2, report.modes[0]);
  CHECK(says("The search found 2 modes, reached by 3 and 3 of its local searches."));
}

TEST_CASE("the table of modes has the names of what was searched, whatever else has draws") {
  Report report = example::duffing(20);
  report.sampled_names = {"c", "k"};  // the others are integrated out
  report.modes[0].declared = {20, 1e4};
  std::string const page = report_html(report, {});
  std::size_t const title = page.find("Modes found by the global search over the prior");
  REQUIRE(title != std::string::npos);
  std::string const head = page.substr(title, page.find("<td", title) - title);
  CHECK(head.find(">c <span") < head.find(">k <span"));
  CHECK(head.find(">k <span class=\"unit\">N/m</span><") != std::string::npos);
  CHECK(head.find(">m<") == std::string::npos);
}

TEST_CASE("paper keeps the tasks of a run with their verdicts, and not the links to sections") {
  Report const one = example::duffing(20), other = example::duffing(30);
  std::string const run = run_html({{{one, {}}, {other, {}}}, {{"a on b", "", {"prediction", "nmse [%]"}, {{"e", "1"}}}}, "", {}});
  CHECK(run.find("<li class=\"link plain\"><a href=\"#together\">") != std::string::npos);
  CHECK(run.find("<li class=\"good\"><a href=\"#task-1\">") != std::string::npos);
  CHECK(report_html(one, {}).find("<li class=\"link\"><a href=\"#verdict\">") != std::string::npos);
  std::string_view const paper = page_style.substr(page_style.find("@media print"));
  CHECK(paper.find("nav .link, .skip { display: none; }") != std::string_view::npos);
  CHECK(paper.find(" nav,") == std::string_view::npos);
}

TEST_CASE("a posterior beyond its prior's 90 % is seen and said to be there") {
  Report report = example::duffing(20);
  report.priors[0].q5 = 0.2;
  report.priors[0].q95 = 1.2;
  auto const page = [&](double low, double high, double mean) {
    report.summary[0].q5 = low;
    report.summary[0].q95 = high;
    report.summary[0].mean = mean;
    std::string const all = report_html(report, {});
    std::size_t const begin = all.find("<svg class=\"range\"");
    return all.substr(begin, all.find("</td>", begin) - begin);
  };
  auto const holds = [](std::string const& text, char const* part) { return text.find(part) != std::string::npos; };
  std::string const inside = page(0.5, 0.7, 0.6), across = page(1.0, 1.3, 1.1), above = page(3.1, 3.3, 3.2),
                    below = page(0, 0.1, 0);
  CHECK((holds(inside, "<rect class=\"narrow\"") && holds(inside, "class=\"mean\"") && !holds(inside, "<path")));
  CHECK((holds(across, "<rect class=\"narrow\"") && holds(across, "class=\"mean\"") && holds(across, "v10l8-5z")));
  CHECK((!holds(above, "<rect class=\"narrow\"") && !holds(above, "class=\"mean\"") && holds(above, "v10l8-5z")));
  CHECK((!holds(below, "<rect class=\"narrow\"") && !holds(below, "class=\"mean\"") && holds(below, "v10l-8-5z")));
  CHECK_FALSE(holds(page(0.2 - 1e-6, 1.2 + 1e-6, 0.7), "<path"));
  CHECK(holds(above, ">above the prior's 90 % interval, by 2.0 times its width<"));
  CHECK(holds(below, ">below the prior's 90 % interval, by 0.20 times its width<"));
  CHECK_FALSE(holds(across, "the prior's 90 % interval"));
}

TEST_CASE("parameters that are fixed stand beside those that are estimated") {
  Report report = example::duffing(20);
  report.fixed = {{"m0", "3.2", "kg"}, {"added[bench]", "500", "g"}};
  std::string page = report_html(report, {});
  CHECK(page.find("m0 <span class=\"unit\">kg</span></th><td class=\"n\">3.2</td>") != std::string::npos);
  CHECK(page.find("added[bench] <span class=\"unit\">g</span></th><td class=\"n\">500</td>") != std::string::npos);
  CHECK(test::broken_rules(page) == "");
  // A prediction has no summary: they have a table of their own.
  report.summary.clear();
  page = report_html(report, {});
  CHECK(page.find("Fixed parameters") != std::string::npos);
  CHECK(page.find("added[bench]") != std::string::npos);
}

TEST_CASE("an equation is shown as its formula, or as its text where it has none") {
  Report report = example::duffing(20);
  report.equations = {"k*y = x", "y^ < & \"", "late"};
  report.formulas = {"<math display=\"block\" alttext=\"k*y = x\"><mi>k</mi></math>", ""};
  std::string const page = report_html(report, {});
  CHECK(page.find("<p>" + report.formulas[0] + "</p>\n<p><code>y^ &lt; &amp; &quot;</code></p>\n<p><code>late</code></p>") !=
        std::string::npos);
}

TEST_CASE("names begin as they are written, words with a capital, and units have one form") {
  Report report = example::duffing(20);
  report.data[0].notes = {"input base = base_acc [m/s^2], linear"};
  std::string const page = run_html({{{report, {}}},
                                     {{"fitted to rig", "", {"fit", "model", "noise"}, {{"e", "f", "sigma 0.1 m/s^2"}}},
                                      {"acc on rig.test", "", {"prediction", "nmse [%]"}, {{"e", "1"}}}},
                                     "",
                                     {}});
  CHECK(page.find("<span>Fitted to rig</span></caption>") != std::string::npos);
  CHECK(page.find("<span>acc on rig.test</span></caption>") != std::string::npos);
  CHECK(page.find("sigma\u00a00.1\u00a0m/s²") != std::string::npos);
  CHECK(page.find("base_acc [m/s²], linear") != std::string::npos);
  CHECK(page.find("m/s^2") == std::string::npos);
}

TEST_CASE("the verdict's headline is words: capitalised before a colon, without the equations of a discovery") {
  Report report = example::duffing(20);
  report.verdict = "unfinished: the run was interrupted";
  CHECK(report_html(report, {}).find("<p class=\"headline\">Unfinished: the run was interrupted</p>") != std::string::npos);
  report.verdict = "x' = -10*x; z' = 2*y; the checks pass";
  report.discovery = DiscoveryReport();
  report.discovery->equations.resize(2);
  report.discovery->equations[0].equation = "x' = -10*x";
  report.discovery->equations[1].equation = "z' = 2*y";
  CHECK(report_html(report, {}).find("<p class=\"headline\">The checks pass</p>") != std::string::npos);
  report.discovery->equations[1] = {};
  report.discovery->equations[1].target = "z'";
  std::string const page = run_html({{{report, {}}}, {}, "", {}});
  CHECK(page.find("<p class=\"headline\">No equation found for <code>z'</code>; the checks pass</p>") != std::string::npos);
  CHECK(page.find("<b>no equation found for <code>z'</code>; the checks pass</b>") != std::string::npos);
}

TEST_CASE("what a discovery answers stands below the verdict") {
  Report report = example::duffing(20);
  report.discovery = DiscoveryReport();
  report.discovery->answer = "the form is decided (probability 0.99); holds on bench.test";
  CHECK(report_html(report, {}).find("<p>The form is decided (probability 0.99); holds on bench.test.</p>") != std::string::npos);
}

TEST_CASE("what stands in the target of a discovery is always kept, and the source of the share of particles is named") {
  DiscoveryReport discovery;
  discovery.measure = "inclusion probability";
  discovery.equations.resize(1);
  discovery.equations[0].equation = "J*th'' = 2*y";
  discovery.equations[0].terms.resize(1);
  discovery.equations[0].terms[0].fate.kind = TermFate::Kind::known;
  CHECK(discovery_tables(discovery)[0].rows[0][1] == "always kept");
  SelectionReport selection;
  selection.result.models.resize(1);
  CHECK(selection_tables(selection)[0].caption.find("Worden et al., eq. 8.21") != std::string::npos);
}

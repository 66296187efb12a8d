// Figures: which there are, what they hold, and that gnuplot draws every one of them the same way twice.
#include "report/figure/figures.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <sstream>

#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/residuals/residual_tests.hpp"
#include "example.hpp"
#include "relative.hpp"
#include "report/figure/gnuplot.hpp"
#include "report/figure/svg.hpp"

using namespace sysid;

namespace {

std::vector<std::string> names(std::vector<plot::Figure> const& figures) {
  std::vector<std::string> out;
  for (plot::Figure const& figure : figures) out.push_back(figure.name);
  return out;
}

}  // namespace

TEST_CASE("a fit has its figures in reading order") {
  CHECK(names(figures(example::duffing(40))) == std::vector<std::string>{"fit_bench_train_displacement", "state_bench_train_y_dot",
                                                                         "posterior", "pairs", "trace", "ranks",
                                                                         "residuals_bench_train_displacement"});
}

TEST_CASE("a quantity that nothing measures and that never moves has no figure") {
  Report report = example::duffing(40);
  auto& quantities = report.predictions[0].quantities;
  auto const speed = std::find_if(quantities.begin(), quantities.end(), [](auto const& each) { return each.measured.empty(); });
  REQUIRE(speed != quantities.end());
  std::fill(speed->response.mean.begin(), speed->response.mean.end(), 0.0);
  for (std::string const& name : names(figures(report))) CHECK_FALSE(name.starts_with("state_"));
}

TEST_CASE("without draws or predictions there is no figure, with one parameter no pair, with one chain no ranks") {
  Report report = example::duffing(40);
  report.predictions.clear();
  report.draws.chains.resize(1);
  CHECK(names(figures(report)) == std::vector<std::string>{"posterior", "pairs", "trace"});
  report.draws.names.resize(1);
  report.draws.units.resize(1);
  report.summary.resize(1);
  CHECK(names(figures(report)) == std::vector<std::string>{"posterior", "trace"});
  report.draws = {};
  report.summary.clear();
  CHECK(figures(report).empty());
}

TEST_CASE("a state that a channel shows as it is has no second figure") {
  Report report = example::duffing(40);
  PredictedQuantity copy = report.predictions[0].quantities[0];
  copy.name = "y";
  copy.noisy = {};
  copy.measured.clear();
  report.predictions[0].quantities.push_back(copy);
  CHECK(names(figures(report)) == names(figures(example::duffing(40))));
}

TEST_CASE("gnuplot draws every figure, the same bytes for the same script, whether alone or with others") {
  REQUIRE(gnuplot_installed());
  std::vector<plot::Figure> const all = figures(example::duffing(40));
  auto const together = draw_all(all);
  REQUIRE(together.size() == all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto const alone = draw(all[i]);
    REQUIRE_MESSAGE(alone.has_value(), all[i].name);
    CHECK(together[i] == alone);
    CHECK(alone->find("<path") != std::string::npos);
    CHECK(alone->find("\"gnuplot_canvas\"") == std::string::npos);
  }
}

TEST_CASE("one script that is refused takes no other figure with it") {
  REQUIRE(gnuplot_installed());
  plot::Figure const fine{"fine", "", "", plot::preamble("fine", 300, 200) + "plot [0:1] x\n"};
  auto const drawn = draw_all({fine, {"broken", "", "", "this is no command\n"}, fine});
  REQUIRE(drawn.size() == 3);
  CHECK(drawn[0].has_value());
  CHECK_FALSE(drawn[1].has_value());
  CHECK(drawn[2] == drawn[0]);
}

TEST_CASE("gnuplot draws degenerate results: constant draws, missing samples, a second of two draws, odd names") {
  REQUIRE(gnuplot_installed());
  Report report = example::duffing(2);
  for (Chain& chain : report.draws.chains)
    for (auto& row : chain.values) row[0] = 1;
  report.draws.names[1] = report.summary[1].name = "it's \"odd\" {x} $y @z";
  PredictedQuantity& quantity = report.predictions[0].quantities[0];
  for (std::size_t i = 0; i < 450; ++i) quantity.measured[i] = std::nan("");
  quantity.noisy = {};
  for (plot::Figure const& figure : figures(report)) CHECK_MESSAGE(draw(figure).has_value(), figure.name);
}

TEST_CASE("a script that gnuplot refuses gives no picture and no exception") {
  CHECK_FALSE(draw({"x", "", "", "this is no command\n"}).has_value());
}

TEST_CASE("a figure in the page takes its colours from the page") {
  plot::Figure const figure{"f", "", "", ""};
  std::string const svg =
      "<?xml version=\"1.0\"?>\n<svg \n viewBox=\"0 0 480 1\"><path stroke='rgb( 27,  94, 155)'/><text "
      "fill=\"rgb(31,41,51)\"/><rect "
      "fill=\"#ffffff\"/></svg>\n";
  CHECK(embedded(svg, figure) ==
        "<svg role=\"img\" aria-label=\"f\" style=\"max-width:672px;min-width:360px\"\n viewBox=\"0 0 480 1\"><path "
        "stroke='var(--fig-model)'/><text "
        "fill=\"var(--fig-ink)\"/><rect "
        "fill=\"var(--fig-paper)\"/></svg>\n");
}

TEST_CASE("a long record is shown in part and says so") {
  Prediction prediction;
  prediction.experiment = "e";
  PredictedQuantity quantity;
  quantity.name = "y";
  for (int i = 0; i < 5000; ++i) {
    prediction.time.push_back(i * 0.01);
    quantity.response.mean.push_back(std::sin(i * 0.1));
  }
  quantity.response.sd.assign(5000, 0.1);
  quantity.response.lower = quantity.response.upper = quantity.measured = quantity.response.mean;
  prediction.scored.assign(5000, 1);
  plot::Figure const figure = fit_figure(prediction, quantity);
  CHECK(figure.caption.ends_with("Shown are the first 600 of 5000 scored samples."));
  CHECK(figure.script.size() < 200000);
}

TEST_CASE("a long record is shown as a whole, too, with its largest residual; a short one is not") {
  Report report = example::duffing(40);
  Prediction& prediction = report.predictions[0];
  PredictedQuantity& quantity = prediction.quantities[0];
  CHECK_FALSE(is_long(prediction, quantity));
  Prediction long_one;
  long_one.experiment = "e";
  PredictedQuantity of;
  of.name = "y";
  of.unit = "mm";
  for (int i = 0; i < 5000; ++i) {
    long_one.time.push_back(i * 0.01);
    of.response.mean.push_back(std::sin(i * 0.1));
    of.measured.push_back(i % 7 == 0 ? std::nan("") : of.response.mean.back());
  }
  of.measured[4001] = of.response.mean[4001] - 0.5;
  of.response.lower = of.response.upper = of.response.mean;
  long_one.scored.assign(5000, 1);
  long_one.quantities = {of};
  REQUIRE(is_long(long_one, of));
  plot::Figure const whole = whole_figure(long_one, of);
  CHECK(whole.caption.ends_with("The largest residual, −0.500\u00a0mm, is at 40.010\u00a0s."));
  CHECK(whole.script.size() < 60000);
  report.predictions = {long_one};
  std::vector<std::string> const all = names(figures(report));
  CHECK(std::find(all.begin(), all.end(), "whole_e_y") == std::find(all.begin(), all.end(), "fit_e_y") + 1);
  if (gnuplot_installed()) CHECK(draw(whole).has_value());
  long_one.scored.assign(5000, 0);
  CHECK_FALSE(is_long(long_one, of));
}

TEST_CASE("one trajectory is no posterior mean and has no band") {
  Report report = example::duffing(40);
  PredictedQuantity& quantity = report.predictions[0].quantities[0];
  CHECK(fit_figure(report.predictions[0], quantity).script.find("'mean'") != std::string::npos);
  quantity.noisy = {};
  quantity.response.draws = 1;
  plot::Figure const figure = fit_figure(report.predictions[0], quantity);
  CHECK(figure.script.find("'mean'") == std::string::npos);
  CHECK(figure.script.find("'95 % band'") == std::string::npos);
  CHECK(figure.script.find("'model'") != std::string::npos);
  CHECK(figure.caption.ends_with("a single trajectory has no band."));
}

TEST_CASE("smoothed states have bands, also of an optimum, and a place of their own") {
  Report report = example::duffing(40);
  std::size_t const before = figures(report).size();
  report.states = {report.predictions[0]};
  report.states[0].smoothed = true;
  report.states[0].quantities.resize(1);
  PredictedQuantity& quantity = report.states[0].quantities[0];
  quantity.noisy = {};
  quantity.measured.clear();
  quantity.response.draws = 1;
  quantity.response.mean.back() = quantity.response.lower.back() = quantity.response.upper.back() = std::nan("");
  CHECK(figures(report).size() == before + 1);
  plot::Figure figure = fit_figure(report.states[0], quantity);
  CHECK(figure.name == "smoothed_bench_train_" + quantity.name);
  CHECK(figure.topic == plot::Topic::states);
  CHECK(figure.script.find("'95 % band'") != std::string::npos);
  CHECK(figure.caption.find("mean from there to the next") == std::string::npos);
  quantity.average = true;
  figure = fit_figure(report.states[0], quantity);
  CHECK(figure.caption.find("mean from there to the next") != std::string::npos);
}

TEST_CASE("a band of a state that the line covers is said to be there, with its width") {
  Report report = example::duffing(40);
  PredictedQuantity state = report.predictions[0].quantities[0];
  state.noisy = {};
  state.measured.clear();
  auto const caption = [&](double half_width) {
    for (std::size_t i = 0; i < state.response.mean.size(); ++i) {
      state.response.mean[i] = std::sin(0.3 * static_cast<double>(i));
      state.response.lower[i] = state.response.mean[i] - half_width;
      state.response.upper[i] = state.response.mean[i] + half_width;
    }
    return fit_figure(report.predictions[0], state).caption;
  };
  std::string const words = "too narrow to be seen";
  CHECK(caption(0.2).find(words) == std::string::npos);
  CHECK(caption(0.001).find("The band is at most 0.0020") != std::string::npos);
  CHECK(caption(0.001).find(words) != std::string::npos);
}

TEST_CASE("the numbers over a marginal are in the unit of its axis") {
  Report report = example::duffing(40);
  report.summary.resize(1);
  report.draws.names.resize(1);
  report.draws.units.resize(1);
  report.summary[0].mean = 998087;
  report.summary[0].sd = 4395;
  for (Chain& chain : report.draws.chains)
    for (std::size_t d = 0; d < chain.values.size(); ++d) chain.values[d][0] = 998087 + 4395 * std::sin(static_cast<double>(d));
  CHECK(posterior_figure(report).script.find("'0.9981 ± 0.0044'") != std::string::npos);
}

TEST_CASE("curves are written to a tenth of a pixel") {
  REQUIRE(gnuplot_installed());
  auto const svg = draw({"f", "", "", plot::preamble("f", 300, 200) + "plot [0:1] x with lines, 2*x with filledcurves y1=0\n"});
  REQUIRE(svg);
  std::size_t const path = svg->find(" d='M");
  REQUIRE(path != std::string::npos);
  std::string const coordinates = svg->substr(path, svg->find('\'', path + 4) - path);
  CHECK_MESSAGE(!std::regex_search(coordinates, std::regex("\\.[0-9][0-9]")), coordinates);
}

namespace {

/// The rows of a block of a script.
std::vector<std::vector<double>> block(std::string const& script, std::string const& name) {
  std::size_t const begin = script.find("$" + name + " << EOD\n");
  if (begin == std::string::npos) return {};
  std::istringstream lines(script.substr(begin));
  std::string line;
  std::getline(lines, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(lines, line) && line != "EOD") {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; cells >> cell;) rows.back().push_back(cell == "NaN" ? std::nan("") : std::stod(cell));
  }
  return rows;
}

/// A duffing report whose residuals contain the input of `lag` samples before.
Report late_input(std::size_t lag) {
  Report report = example::duffing(40);
  PredictedInput input{"x", "N", {}};
  Stream stream({3, Purpose::test, 0, 0});
  for (int i = 0; i < 500; ++i) input.values.push_back(10 * stream.normal());
  PredictedQuantity& quantity = report.predictions[0].quantities[0];
  for (std::size_t i = lag; i < 500; ++i) quantity.measured[i] += 0.002 * input.values[i - lag];
  report.predictions[0].inputs.push_back(input);
  return report;
}

}  // namespace

TEST_CASE("residuals that follow the input seven samples late show it at lag seven") {
  Report const report = late_input(7);
  plot::Figure const figure = residual_figure(report.predictions[0], report.predictions[0].quantities[0]);
  auto const bars = block(figure.script, "input0"), limits = block(figure.script, "input0_limit");
  REQUIRE(bars.size() == 61);
  auto const highest = std::max_element(bars.begin(), bars.end(), [](auto const& a, auto const& b) { return a[1] < b[1]; });
  CHECK((*highest)[0] == 7);
  CHECK((*highest)[1] > 3 * limits[1][2]);
  // And nothing of the kind where they do not; 5 % of 61 lags may leave the band.
  auto const quiet =
      block(residual_figure(late_input(0).predictions[0], example::duffing(40).predictions[0].quantities[0]).script, "input0");
  CHECK(std::count_if(quiet.begin(), quiet.end(), [&](auto const& bar) { return std::fabs(bar[1]) > limits[1][2]; }) <= 9);
}

TEST_CASE("an input that does not vary has no correlation and no panel") {
  Report report = late_input(7);
  for (double& each : report.predictions[0].inputs[0].values) each = 3;
  plot::Figure const figure = residual_figure(report.predictions[0], report.predictions[0].quantities[0]);
  CHECK(block(figure.script, "input0").empty());
  CHECK(figure.caption.find("A constant input has no correlation") != std::string::npos);
}

TEST_CASE("the value that data were made with is a line at its place, where all records agree on it") {
  Report report = example::duffing(40);
  report.data[0].true_parameters = {{"m", "kg", 1.0001}, {"beta", "1/m^2", 9e11}};
  plot::Figure figure = posterior_figure(report);
  REQUIRE(block(figure.script, "truth0").size() == 2);
  CHECK(block(figure.script, "truth0")[0][0] == doctest::Approx(1.0001));
  CHECK(block(figure.script, "truth2").empty());  // nobody says
  CHECK(block(figure.script, "truth4").empty());  // far outside
  CHECK(figure.caption.find("Generated with values outside the shown range: beta (9.000·10¹¹\u00a01/m²)") != std::string::npos);
  report.data.push_back(report.data[0]);
  report.data[1].true_parameters[0].value = 1.0002;
  CHECK(block(posterior_figure(report).script, "truth0").empty());
}

TEST_CASE("figures are drawn as SVG, PNG, PDF and characters from one script") {
  REQUIRE(gnuplot_installed());
  plot::Figure const figure = posterior_figure(example::duffing(40));
  for (FigureFormat const format : {FigureFormat::svg, FigureFormat::png, FigureFormat::pdf, FigureFormat::text}) {
    REQUIRE(can_draw(format));
    CHECK(find_figure_format(name(format)) == format);
    CHECK_MESSAGE(draw(figure, format).has_value(), name(format));
  }
  CHECK_FALSE(find_figure_format("jpeg").has_value());
  CHECK(draw(figure, FigureFormat::png)->starts_with("\x89PNG"));
  CHECK(draw(figure, FigureFormat::pdf)->starts_with("%PDF"));
}

TEST_CASE("a figure of characters fits the columns that there are, whatever their number") {
  REQUIRE(gnuplot_installed());
  for (plot::Figure const& figure : figures(example::duffing(40)))
    for (int const columns : {40, 80, 157}) {
      auto const text = draw(figure, FigureFormat::text, columns);
      REQUIRE(text.has_value());
      CHECK(text->find('\f') == std::string::npos);
      CHECK(text->find('\x1b') == std::string::npos);
      int lines = 0;
      std::istringstream in(*text);
      for (std::string line; std::getline(in, line); ++lines)
        CHECK(std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }) <=
              columns);
      CHECK(lines > columns / 12);
      CHECK(draw(figure, FigureFormat::text, columns) == text);
    }
}

TEST_CASE("forty parameters, twelve chains, values of 1e-12, long names and a band with holes are drawn") {
  REQUIRE(gnuplot_installed());
  Report report = example::duffing(20);
  for (int p = 5; p < 40; ++p) {
    report.draws.names.push_back("a_parameter_whose_name_does_not_end_" + std::to_string(p));
    report.draws.units.emplace_back("N s/m^3");
  }
  Stream stream({4, Purpose::test, 0, 0});
  for (Chain& chain : report.draws.chains)
    for (auto& row : chain.values)
      for (int p = 5; p < 40; ++p) row.push_back(stream.normal() * std::pow(10.0, p % 25 - 12) + (p % 3 == 0 ? 15.9145 : 0));
  while (report.draws.chains.size() < 12) report.draws.chains.push_back(report.draws.chains[report.draws.chains.size() % 4]);
  for (std::size_t p = 5; p < 40; ++p) {
    ChainValues values;
    for (Chain const& chain : report.draws.chains) {
      values.emplace_back();
      for (auto const& row : chain.values) values.back().push_back(row[p]);
    }
    report.summary.push_back(summarise(report.draws.names[p], report.draws.units[p], values));
  }
  for (Band* band : {&report.predictions[0].quantities[0].response, &report.predictions[0].quantities[0].noisy})
    for (auto* column : {&band->mean, &band->lower, &band->upper})
      for (std::size_t i = 0; i < 500; ++i) (*column)[i] = i > 200 && i < 240 ? std::nan("") : 1e-12 * (*column)[i];
  for (plot::Figure const& figure : figures(report)) {
    CHECK_MESSAGE(draw(figure).has_value(), figure.name);
    CHECK(figure.script.find("inf") == std::string::npos);
  }
}

TEST_CASE("draws that are not finite leave the others to be seen, and where there are none the figure says so") {
  REQUIRE(gnuplot_installed());
  Report report = example::duffing(40);
  for (Chain& chain : report.draws.chains)
    for (std::size_t d = 0; d < chain.values.size(); ++d) {
      chain.values[d][0] = std::nan("");
      if (d % 3 == 0) chain.values[d][1] = d % 2 == 0 ? std::nan("") : INFINITY;
    }
  for (plot::Figure const& figure : figures(report)) CHECK_MESSAGE(draw(figure).has_value(), figure.name);
  std::string const script = posterior_figure(report).script;
  CHECK(script.find("'no finite draw'") != std::string::npos);
  CHECK(block(script, "all0").empty());
  CHECK(block(script, "all1").size() >= 24);
}

TEST_CASE("terms of a discovery stand in the order of how sure they are, with their coefficients' densities") {
  DiscoveryReport discovery;
  discovery.measure = "inclusion probability";
  DiscoveredEquation equation;
  equation.target = "m*y'' - x";
  for (int j = 0; j < 30; ++j) {
    DiscoveredTerm term;
    term.text = j == 3 ? "y''" : "y'''^" + std::to_string(j);
    term.unit = "N/m";
    term.kept = j == 3 || j == 7;
    term.fate.kind = j == 0 ? TermFate::Kind::known : term.kept ? TermFate::Kind::kept : TermFate::Kind::dropped;
    term.measure = term.kept ? 0.99 + 0.001 * j : 0.01 * j;
    term.coefficient = 1e4;
    term.sd = j == 7 ? 0 : 20;
    equation.terms.push_back(term);
  }
  discovery.equations.push_back(equation);
  plot::Figure const bars = inclusion_figure(discovery, 0);
  CHECK(block(bars.script, "kept").size() == 2);
  CHECK(block(bars.script, "kept")[0][3] == doctest::Approx(0.997));
  CHECK(block(bars.script, "dropped").size() == 22);
  CHECK(bars.caption.find("first 24 of 29") != std::string::npos);
  REQUIRE(has_coefficients(equation));
  plot::Figure const densities = coefficient_figure(discovery, 0);
  CHECK(block(densities.script, "all0").size() == 81);
  CHECK(block(densities.script, "all1").empty());  // without a spread there is no density
  CHECK((draw(bars).has_value() && draw(densities).has_value()));
  equation.terms.resize(3);
  CHECK_FALSE(has_coefficients(equation));
}

TEST_CASE("rows of any order have a figure over their inputs, a curve where there is one") {
  Prediction prediction;
  prediction.experiment = "e";
  prediction.rows = true;
  PredictedQuantity quantity;
  quantity.name = "y";
  PredictedInput first{"a", "m", {}}, second{"b", "s", {}};
  for (int i = 0; i < 50; ++i) {
    double const x = (i * 37) % 50;
    prediction.time.push_back(i);
    prediction.scored.push_back(1);
    first.values.push_back(x);
    second.values.push_back(i % 7);
    quantity.measured.push_back(x * x + 1);
    quantity.response.mean.push_back(x * x);
    quantity.response.lower.push_back(x * x - 3);
    quantity.response.upper.push_back(x * x + 3);
  }
  quantity.response.draws = 100;
  prediction.inputs = {first};
  REQUIRE(over_inputs(prediction, quantity));
  auto const rows = block(input_figure(prediction, quantity).script, "input0");
  REQUIRE(rows.size() == 50);
  CHECK(std::is_sorted(rows.begin(), rows.end(), [](auto const& a, auto const& b) { return a[0] < b[0]; }));
  prediction.inputs = {first, second};
  CHECK(block(input_figure(prediction, quantity).script, "input1").size() == 50);
  CHECK(draw(input_figure(prediction, quantity)).has_value());
  for (double& each : prediction.inputs[0].values) each = 1;
  prediction.inputs.resize(1);
  CHECK_FALSE(over_inputs(prediction, quantity));
  prediction.rows = false;
  prediction.inputs = {first};
  CHECK_FALSE(over_inputs(prediction, quantity));
}

TEST_CASE("twenty models have twenty keys, told apart by colour and dashes, in rows that end within the figure") {
  std::vector<plot::Key> keys;
  for (int m = 0; m < 20; ++m) keys.push_back({plot::Key::line, plot::chains[0], "a_model_with_a_long_name_" + std::to_string(m)});
  std::string const script = plot::legend(keys, 10, 466, 900, 480, 1000);
  std::regex const place("at screen ([0-9.]+),([0-9.]+) left");
  int found = 0;
  for (std::sregex_iterator at(script.begin(), script.end(), place), end; at != end; ++at, ++found)
    CHECK(std::stod((*at)[1]) * 480 < 300);
  CHECK(found == 20);
  CHECK(plot::legend_height(keys, 10, 466) >= 10 * 15);
}

TEST_CASE("the autocorrelation in the figure, and its band, are those of the test behind the verdict") {
  Report const report = example::duffing(40);
  Prediction const& prediction = report.predictions[0];
  PredictedQuantity const& quantity = prediction.quantities[0];
  std::vector<double> residuals;
  for (std::size_t i = 0; i < quantity.measured.size(); ++i)
    residuals.push_back(prediction.scored[i] != 0 ? quantity.measured[i] - quantity.response.mean[i] : std::nan(""));
  CorrelationTest const test = whiteness(residuals, 60);
  plot::Figure const figure = residual_figure(prediction, quantity);
  auto const bars = block(figure.script, "acf"), limits = block(figure.script, "acf_limit");
  REQUIRE(bars.size() == test.correlation.size());
  REQUIRE(limits.size() == bars.size() + 2);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    CHECK(bars[i][1] == relative(test.correlation[i], 1e-5));
    CHECK(limits[i + 1][2] == relative(test.bound[i], 1e-5));
  }
  CHECK(figure.caption.find("99 %") != std::string::npos);
}

TEST_CASE("residuals that are few, or all nothing, have no figure") {
  Report report = example::duffing(40);
  Prediction& prediction = report.predictions[0];
  PredictedQuantity& quantity = prediction.quantities[0];
  CHECK(has_residuals(prediction, quantity));
  std::vector<double> const measured = quantity.measured;
  quantity.measured = quantity.response.mean;
  CHECK_FALSE(has_residuals(prediction, quantity));
  quantity.measured = measured;
  std::fill(quantity.measured.begin() + 15, quantity.measured.end(), std::nan(""));
  CHECK_FALSE(has_residuals(prediction, quantity));
}

TEST_CASE("each figure says which part of the page it belongs to") {
  std::string chains, fit;
  for (plot::Figure const& figure : figures(example::duffing(40))) {
    if (figure.topic == plot::Topic::chains) chains += figure.name + " ";
    if (figure.topic == plot::Topic::fit) fit += figure.name + " ";
  }
  CHECK(chains == "trace ranks ");
  CHECK(fit == "fit_bench_train_displacement state_bench_train_y_dot residuals_bench_train_displacement ");
}

TEST_CASE("every axis of the pairs has two numbers, also where they are long") {
  Report report = example::duffing(40);
  for (Chain& chain : report.draws.chains)
    for (std::size_t d = 0; d < chain.values.size(); ++d) {
      chain.values[d][0] = 998.087 + 0.004 * std::sin(static_cast<double>(d));
      chain.values[d][1] = -0.0995 + 1e-4 * std::cos(static_cast<double>(d));
    }
  std::string const script = pair_figure(report.draws).script;
  std::regex const ticks("set [xy]tics [^(]*\\(([^)]*)\\)"), number("'[^']+' ");
  int axes = 0;
  for (std::sregex_iterator at(script.begin(), script.end(), ticks), end; at != end; ++at) {
    std::string const list = (*at)[1];
    auto const numbers = std::distance(std::sregex_iterator(list.begin(), list.end(), number), std::sregex_iterator());
    if (numbers == 0) continue;  // inner panels
    ++axes;
    CHECK_MESSAGE(numbers >= 2, list);
  }
  CHECK(axes >= 9);
}

TEST_CASE("a function that was found shows where the record reads it") {
  FunctionReport function{"f", "N", {{"v", "m/s"}}, {}, {{}}, {{0, 4, 0, 2}}};
  for (int i = 0; i <= 10; ++i) function.cuts[0].push_back({{0.1 * i}, 1.0 * i, 0.1, i - 0.2, i + 0.2});
  plot::Figure const figure = function_figure(function);
  auto const strip = block(figure.script, "visits0");
  REQUIRE(strip.size() == 8);
  double const low = strip[0][1];
  CHECK(strip[2][0] == relative(0.25, 1e-12));
  CHECK(strip[2][1] - low == doctest::Approx(2 * (strip[6][1] - low)));
  CHECK(figure.caption.find("how many of the fitted rows") != std::string::npos);
  function.visits[0].assign(4, 0);
  CHECK(block(function_figure(function).script, "visits0").empty());
}

TEST_CASE("captions are prose: no names of our own stand in them") {
  for (plot::Figure const& figure : figures(example::duffing(40))) {
    CHECK_MESSAGE(figure.caption.find('_') == std::string::npos, figure.caption);
    CHECK_MESSAGE(figure.caption.ends_with('.'), figure.caption);
  }
}

TEST_CASE("thresholds of nothing and without end have no place on a logarithmic scale, the others keep theirs") {
  SelectionReport selection;
  selection.result.models.resize(2);
  selection.result.models[0].name = "a";
  selection.result.models[1].name = "b";
  for (double const threshold : {std::numeric_limits<double>::infinity(), 10.0, 1.0, 0.0}) {
    PopulationRecord record;
    record.threshold = threshold;
    record.models.resize(2);
    record.models[0] = {10, 0, 5, 0.5, 0};
    record.models[1] = {10, 0, 5, 0.5, 0};
    selection.result.populations.push_back(record);
  }
  selection.floor = 0;
  auto const block = [](std::string const& script) {
    std::size_t const begin = script.find("$threshold << EOD\n") + 18;
    std::string const rows = script.substr(begin, script.find("EOD", begin) - begin);
    return std::count(rows.begin(), rows.end(), '\n');
  };
  plot::Figure const figure = population_figure(selection);
  CHECK(block(figure.script) == 2);
  for (char const* word : {"inf", "nan", "Dashed"}) {
    CHECK(figure.script.find(word) == std::string::npos);
    CHECK(figure.caption.find(word) == std::string::npos);
  }
  // The floor is drawn where there is one.
  selection.floor = 0.5;
  CHECK(population_figure(selection).caption.find("Dashed") != std::string::npos);
  // Nothing but an exact fit: still a figure.
  selection.result.populations.resize(1);
  selection.result.populations[0].threshold = 0;
  selection.floor.reset();
  CHECK(population_figure(selection).script.find("inf") == std::string::npos);
}

TEST_CASE("of many parameters the pairs show those that go together, and say how many are left out") {
  Draws draws;
  draws.chains.resize(1);
  Stream stream({5, Purpose::test, 0, 0});
  for (int p = 0; p < 14; ++p) {
    draws.names.push_back("p" + std::to_string(p));
    draws.units.emplace_back();
  }
  draws.parameter_count = 13;
  for (int d = 0; d < 300; ++d) {
    std::vector<double> row;
    for (int p = 0; p < 13; ++p) row.push_back(stream.normal());
    row[11] = row[3] + 0.1 * row[11];
    row[12] = 0.1 * row[12] - row[9];
    row.push_back(2 * row[0]);  // derived: as good as its parameter
    draws.chains[0].values.push_back(std::move(row));
  }
  plot::Figure const figure = pair_figure(draws);
  for (char const* name : {"'p3'", "'p9'", "'p11'", "'p12'"}) CHECK_MESSAGE(figure.script.find(name) != std::string::npos, name);
  CHECK(figure.script.find("'p13'") == std::string::npos);
  CHECK(figure.caption.ends_with("Shown are 7 of 14, those with the strongest correlations among the parameters; 7 are left out."));
  draws.parameter_count = 7;
  CHECK(pair_figure(draws).caption.ends_with("Shown are 7 of 14, the first; 7 are left out."));
}

TEST_CASE("coefficients of unknown functions leave the pairs to the parameters") {
  Report report = example::duffing(40);
  report.summary[1].coefficient = true;
  for (plot::Figure const& figure : figures(report))
    if (figure.name == "pairs")
      CHECK((figure.script.find("'c [") == std::string::npos && figure.script.find("'k [") != std::string::npos));
}

TEST_CASE("chains have a legend where so many can be told apart, and ranks an axis that says what they count") {
  Report report = example::duffing(40);
  CHECK(trace_figure(report.draws).script.find("'chain 4'") != std::string::npos);
  std::string const ranks = rank_figure(report.draws).script;
  CHECK(ranks.find("'chain 4'") != std::string::npos);
  CHECK(ranks.find("'draws'") != std::string::npos);
  report.draws.chains.resize(1);
  CHECK(trace_figure(report.draws).script.find("'chain 1'") == std::string::npos);
  report.draws.chains.resize(40, report.draws.chains[0]);
  CHECK(rank_figure(report.draws).script.find("'chain 1'") == std::string::npos);
}

TEST_CASE("a loop that is a part of the record says so, and labels of a surface stand upright clear of its numbers") {
  RestoringForce force;
  force.experiment = "e";
  force.name = force.displacement = "y";
  force.velocity = "y'";
  force.displacement_unit = force.velocity_unit = force.force_unit = "m";
  for (int i = 0; i < 5000; ++i) {
    force.model.displacement.push_back(std::sin(0.1 * i));
    force.model.velocity.push_back(std::cos(0.1 * i));
    force.model.force.push_back(std::sin(0.1 * i));
  }
  CHECK(loop_figure(force).script.find("'model around the largest displacement'") != std::string::npos);
  force.grid_displacement = force.grid_velocity = {-1, 0, 1};
  force.surface.assign(3, {-1, 0, 1});
  std::string const surface = surface_figure(force).script;
  CHECK(surface.find("rotate") == std::string::npos);
  CHECK(surface.find("set xlabel") == std::string::npos);
  CHECK(surface.find("'y [m]' at screen") != std::string::npos);
  CHECK(draw(surface_figure(force)).has_value());
  for (auto* path : {&force.model.displacement, &force.model.velocity, &force.model.force}) path->resize(20);
  CHECK(loop_figure(force).script.find("around the largest") == std::string::npos);
}

TEST_CASE("of characters each term of a discovery has one line, with its bar and its value") {
  REQUIRE(gnuplot_installed());
  DiscoveryReport discovery;
  discovery.measure = "inclusion probability";
  DiscoveredEquation equation;
  equation.target = "y'";
  for (int j = 0; j < 10; ++j) {
    DiscoveredTerm term;
    term.text = "term" + std::to_string(j);
    term.kept = j < 2;
    term.measure = j < 2 ? 1 : 0.5 / j;
    term.sd = term.coefficient = 1;
    equation.terms.push_back(term);
  }
  discovery.equations.push_back(equation);
  for (int const columns : {40, 80, 120}) {
    auto const text = draw(inclusion_figure(discovery, 0), FigureFormat::text, columns);
    REQUIRE(text);
    std::istringstream lines(*text);
    std::string line;
    for (int j = 0; j < 10; ++j) {
      REQUIRE(std::getline(lines, line));
      CAPTURE(line);
      CHECK(line.find("term" + std::to_string(j)) != std::string::npos);
      CHECK((line.find("--") != std::string::npos || j > 3));
      CHECK(line.ends_with(j < 2 ? " 1.000 kept" : " " + probability_text(0.5 / j)));
    }
  }
  // Two words of a label say more than "of": three panels stand in a row where they have room.
  CHECK(coefficient_figure(discovery, 0).script.find("'coefficient of term0'") != std::string::npos);
}

TEST_CASE("models between which chains jumped are shown by falling probability") {
  SelectionReport selection;
  selection.result.jumps.emplace();
  for (auto const& [name, probability] : {std::pair{"rare", 0.1}, {"likely", 0.9}}) {
    selection.result.models.emplace_back();
    selection.result.models.back().name = name;
    selection.result.models.back().probability = probability;
  }
  plot::Figure const figure = model_figure(selection);
  CHECK(figure.script.find("likely") < figure.script.find("rare"));
  CHECK(figure.script.find("0.900") != std::string::npos);
  CHECK(figure.caption.find("models") == std::string::npos);  // all are shown
  // Shortened in the middle, members of a family would all have one name.
  selection.result.models[0].name = "duffing(quadratic = 1, cubic = 1, drag = 0)";
  selection.result.models[1].name = "duffing(quadratic = 0, cubic = 1, drag = 0)";
  plot::Figure const family = model_figure(selection);
  CHECK(family.script.find("'quadratic 1, cubic 1, drag 0'") != std::string::npos);
  CHECK(family.script.find("'quadratic 0, cubic 1, drag 0'") != std::string::npos);
  CHECK(family.caption.find("arguments of duffing") != std::string::npos);
  selection.result.models[1].name = "linear";
  CHECK(model_figure(selection).script.find("duffing(") != std::string::npos);
}

// Figures: which there are, what they hold, and that gnuplot draws every one of them the same way twice.
#include "report/figures.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>

#include "example.hpp"
#include "report/gnuplot.hpp"

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

TEST_CASE("gnuplot draws every figure, the same bytes for the same script") {
  if (!gnuplot_installed()) return;
  for (plot::Figure const& figure : figures(example::duffing(40))) {
    auto const first = draw(figure);
    REQUIRE_MESSAGE(first.has_value(), figure.name);
    CHECK(draw(figure) == first);
    CHECK(first->find("<path") != std::string::npos);
    CHECK(first->find("\"gnuplot_canvas\"") == std::string::npos);
  }
}

TEST_CASE("gnuplot draws degenerate results: constant draws, missing samples, a second of two draws, odd names") {
  if (!gnuplot_installed()) return;
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
      "<?xml version=\"1.0\"?>\n<svg \n viewBox=\"0 0 1 1\"><path stroke='rgb( 27,  94, 155)'/><text fill=\"rgb(31,41,51)\"/><rect "
      "fill=\"#ffffff\"/></svg>\n";
  CHECK(embedded(svg, figure) ==
        "<svg role=\"img\" aria-label=\"f\"\n viewBox=\"0 0 1 1\"><path stroke='var(--fig-model)'/><text "
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
  CHECK(figure.caption.ends_with("Shown are the first 1000 of 5000 scored samples."));
  CHECK(figure.script.size() < 200000);
}

TEST_CASE("one trajectory is no posterior mean and has no band") {
  Report report = example::duffing(40);
  PredictedQuantity& quantity = report.predictions[0].quantities[0];
  CHECK(fit_figure(report.predictions[0], quantity).script.find("'posterior mean'") != std::string::npos);
  quantity.noisy = {};
  quantity.response.draws = 1;
  plot::Figure const figure = fit_figure(report.predictions[0], quantity);
  CHECK(figure.script.find("'posterior mean'") == std::string::npos);
  CHECK(figure.script.find("'95 % of the response'") == std::string::npos);
  CHECK(figure.script.find("'model'") != std::string::npos);
  CHECK(figure.caption.ends_with("one trajectory has no band."));
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
  if (!gnuplot_installed()) return;
  auto const svg = draw({"f", "", "", plot::preamble("f", 300, 200) + "plot [0:1] x with lines, 2*x with filledcurves y1=0\n"});
  REQUIRE(svg);
  std::size_t const path = svg->find(" d='M");
  REQUIRE(path != std::string::npos);
  std::string const coordinates = svg->substr(path, svg->find('\'', path + 4) - path);
  CHECK_MESSAGE(!std::regex_search(coordinates, std::regex("\\.[0-9][0-9]")), coordinates);
}

TEST_CASE("the autocorrelation of an alternating series alternates") {
  std::vector<double> series;
  for (int i = 0; i < 100; ++i) series.push_back(i % 2 == 0 ? 1 : -1);
  auto const values = autocorrelation(series, 3);
  REQUIRE(values.size() == 4);
  // n - lag products of magnitude 1 over n.
  CHECK(values[0] == 1);
  CHECK(values[1] == doctest::Approx(-0.99).epsilon(1e-14));
  CHECK(values[2] == doctest::Approx(0.98).epsilon(1e-14));
}

TEST_CASE("missing samples do not spoil the autocorrelation") {
  auto const values = autocorrelation({1, -1, std::nan(""), -1, 1, -1}, 1);
  CHECK(std::isfinite(values[1]));
  CHECK(values[1] < 0);
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

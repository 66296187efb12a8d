// The terms of a discovered equation: their probabilities, and the posterior of the chosen coefficients.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/utf8.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/named_bars.hpp"
#include "report/figure/small_multiples.hpp"
#include "report/text/summary_text.hpp"

namespace sysid {

namespace {

using namespace plot;

/// Rows of bars that a figure holds.
constexpr std::size_t shown_terms = 24;

/// "inclusion", or "inclusion_2" where there are several equations.
std::string equation_name(DiscoveryReport const& discovery, std::string_view what, std::size_t equation) {
  return discovery.equations.size() == 1 ? std::string(what) : fmt::format("{}_{}", what, equation + 1);
}

bool offered(DiscoveredTerm const& term) {
  return term.fate.kind != TermFate::Kind::known && term.fate.kind != TermFate::Kind::left_out;
}

bool has_density(DiscoveredTerm const& term) {
  return term.kept && term.fate.kind != TermFate::Kind::known && std::isfinite(term.coefficient) && std::isfinite(term.sd) &&
         term.sd > 0;
}

/// The terms that were offered, those with the largest measure first.
std::vector<DiscoveredTerm const*> by_measure(DiscoveredEquation const& equation) {
  std::vector<DiscoveredTerm const*> out;
  for (DiscoveredTerm const& term : equation.terms)
    if (offered(term)) out.push_back(&term);
  std::stable_sort(out.begin(), out.end(), [](auto const* a, auto const* b) { return a->measure > b->measure; });
  return out;
}

std::string coefficient_label(DiscoveredTerm const& term) { return "coefficient of " + term.text; }

Axis coefficient_axis(DiscoveredTerm const& term) {
  return axis(term.coefficient - 3.5 * term.sd, term.coefficient + 3.5 * term.sd, 4);
}

/// Whether all labels fit under three panels side by side.
bool labels_are_short(std::vector<DiscoveredTerm const*> const& terms) {
  constexpr double room = column_width / 3.0;
  return std::all_of(terms.begin(), terms.end(), [](DiscoveredTerm const* each) {
    return text_pixels(axis_label(coefficient_label(*each), each->unit, coefficient_axis(*each))) <= room;
  });
}

/// The normal density between two distances from the mean, in sds; 1 at the mean.
Rows normal_curve(DiscoveredTerm const& term, Axis const& x, double from, double to) {
  Rows rows;
  for (int k = 0; k <= 80; ++k) {
    double const z = from + (to - from) * k / 80;
    rows.push_back({x.scaled(term.coefficient + z * term.sd), std::exp(-0.5 * z * z)});
  }
  return rows;
}

Plot coefficient_plot(DiscoveredTerm const& term, std::size_t index, Panel panel) {
  Plot out{std::move(panel)};
  Axis& x = out.panel.x;
  x = coefficient_axis(term);
  x.clear_edges(0.03);
  out.panel.y = {0, 1.08, 0, {}};
  out.panel.y_axis = false;
  out.panel.x_label = axis_label(coefficient_label(term), term.unit, x);
  auto const [mean, sd] = coefficient_text(x.origin_text.empty() ? x.scaled(term.coefficient) : term.coefficient,
                                           x.origin_text.empty() ? x.scaled_width(term.sd) : term.sd);
  out.panel.title = fmt::format("{} ± {}", pretty_number(mean), pretty_number(sd));
  constexpr double ninety = 1.6449;  // sds to either side that hold 90 %
  std::string const all = fmt::format("all{}", index), inner = fmt::format("inner{}", index);
  out.tables = {{all, normal_curve(term, x, -3.5, 3.5)}, {inner, normal_curve(term, x, -ninety, ninety)}};
  out.series = {area(all, noise_band), area(inner, response_band), line(all, 2, 1.6, model)};
  return out;
}

}  // namespace

Figure inclusion_figure(DiscoveryReport const& discovery, std::size_t equation) {
  DiscoveredEquation const& found = discovery.equations[equation];
  std::vector<DiscoveredTerm const*> order = by_measure(found);
  std::size_t const all = order.size();
  order.resize(std::min(all, shown_terms));
  bool const probability = discovery.measure != "contribution";
  NamedBars bars{equation_name(discovery, "inclusion", equation), {}, "", {}};
  double largest = 0;
  for (DiscoveredTerm const* term : order) {
    largest = std::max(largest, term->measure);
    bars.bars.push_back(
        {term->text, probability ? probability_text(term->measure) : significant(term->measure, 3), term->measure, term->kept});
  }
  bars.x = probability ? axis(0, 1, 5) : axis(0, largest, 5, 0);
  bars.x_label = axis_label(discovery.measure, "", bars.x);
  Figure out{bars.name, fmt::format("Terms of {}", found.target), "", script(bars)};
  out.caption =
      fmt::format("The {} of each term of the dictionary in {}; those in colour were kept.", discovery.measure, found.target);
  out.caption += probability ? " Near 1 the data support the term, near 0 they contradict it; values between are undecided."
                             : " It is the root mean square of the term relative to that of the explained signal.";
  if (all > order.size()) out.caption += fmt::format(" Shown are the first {} of {}.", order.size(), all);
  return out;
}

bool has_coefficients(DiscoveredEquation const& equation) {
  return std::any_of(equation.terms.begin(), equation.terms.end(), has_density);
}

Figure coefficient_figure(DiscoveryReport const& discovery, std::size_t equation) {
  std::vector<DiscoveredTerm const*> terms;
  for (DiscoveredTerm const& term : discovery.equations[equation].terms)
    if (has_density(term)) terms.push_back(&term);
  std::size_t const count = std::min(terms.size(), shown_multiples);
  SmallMultiples const multiples(count, labels_are_short(terms) ? 3 : 2, 140);
  Drawing drawing{equation_name(discovery, "coefficients", equation), multiples.width, multiples.height};
  for (std::size_t i = 0; i < count; ++i)
    drawing.plots.push_back(coefficient_plot(*terms[i], i, multiples.panel(i, {14, 12, 46, 20})));
  Figure out{drawing.name, fmt::format("Coefficients of {}", discovery.equations[equation].target), "", script(drawing)};
  out.caption = fmt::format(
      "Posterior densities of the coefficients in {} by regression, given exactly these terms; the inner part contains 90\u00a0%, "
      "the "
      "numbers above are mean ± sd, in the unit of the axis.{}",
      discovery.equations[equation].target, multiples_excluded(terms.size()));
  if (discovery.validation) out.caption += " The equation at the top of the page has the coefficients of the fit by simulation.";
  return out;
}

}  // namespace sysid

// What a discovery says of the terms of an equation: how sure each is, and the posterior of the coefficients that were chosen.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "report/cells.hpp"
#include "report/figures.hpp"
#include "report/number.hpp"

namespace sysid {

namespace {

using namespace plot;

/// Rows of bars that a figure holds.
constexpr std::size_t shown_terms = 24;

/// "inclusion", or "inclusion_2" where there are several equations.
std::string equation_name(DiscoveryReport const& discovery, std::string_view what, std::size_t equation) {
  return discovery.equations.size() == 1 ? std::string(what) : fmt::format("{}_{}", what, equation + 1);
}

bool offered(DiscoveredTerm const& term) { return term.fate != "known" && term.fate != "left out"; }

bool has_density(DiscoveredTerm const& term) {
  return term.kept && term.fate != "known" && std::isfinite(term.coefficient) && std::isfinite(term.sd) && term.sd > 0;
}

}  // namespace

Figure inclusion_figure(DiscoveryReport const& discovery, std::size_t equation) {
  DiscoveredEquation const& found = discovery.equations[equation];
  std::vector<std::size_t> order;
  for (std::size_t j = 0; j < found.terms.size(); ++j)
    if (offered(found.terms[j])) order.push_back(j);
  std::size_t const all = order.size();
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return found.terms[a].measure > found.terms[b].measure; });
  order.resize(std::min(all, shown_terms));

  double widest = 40, largest = 0;
  for (std::size_t const j : order) {
    widest = std::max(widest, text_pixels(found.terms[j].text));
    largest = std::max(largest, found.terms[j].measure);
  }
  bool const probability = discovery.measure != "contribution";
  int const width = column_width, row = 18, height = 62 + row * static_cast<int>(order.size());
  double const left = std::min(widest + 30, 180.0);
  Figure out;
  out.name = equation_name(discovery, "inclusion", equation);
  out.title = fmt::format("Terms of {}", found.target);
  out.script = preamble(out.name, width, height);
  Axis x = probability ? axis(0, 1, 5) : axis(0, largest, 5, 0);
  Panel p = panel_at(left, width - 62.0, 44, height - 12.0, std::move(x), {0, static_cast<double>(order.size()), 0, {}});
  p.x_label = axis_label(discovery.measure, "", p.x);
  std::vector<std::vector<double>> kept, dropped;
  std::string labels;
  for (std::size_t r = 0; r < order.size(); ++r) {
    DiscoveredTerm const& term = found.terms[order[r]];
    double const y = static_cast<double>(order.size() - r) - 0.5, end = p.x.scaled(term.measure);
    (term.kept ? kept : dropped).push_back({end / 2, y, 0, end, y - 0.34, y + 0.34});
    double const at = (p.bottom + (p.top - p.bottom) * y / static_cast<double>(order.size())) / height;
    labels += fmt::format("set label {} {} at screen {:.5f},{:.5f} right textcolor rgb '{}'\n", 100 + 2 * r,
                          quote(shortened(term.text, left - 26)), (left - 8) / width, at, term.kept ? ink : muted);
    labels += fmt::format("set label {} {} at first {:.6g},{:.6g} left offset 1,0 textcolor rgb '{}'\n", 101 + 2 * r,
                          quote(probability ? probability_text(term.measure) : significant(term.measure, 3)), end, y, muted);
  }
  std::string plots;
  auto const bars = [&](char const* name, std::vector<std::vector<double>> const& rows, std::string_view colour) {
    if (rows.empty()) return;
    out.script += data_block(name, rows);
    plots += fmt::format("{}${} using 1:2:3:4:5:6 with boxxyerror fc rgb '{}' fs solid noborder", plots.empty() ? "plot " : ", ",
                         name, colour);
  };
  bars("kept", kept, model);
  bars("dropped", dropped, muted);
  if (plots.empty()) plots = "plot NaN";
  p.y_axis = false;
  out.script += panel(p, width, height) + labels + plots + "\nunset multiplot\n";
  out.caption =
      fmt::format("The {} of each term of the dictionary in {}; those in colour were kept.", discovery.measure, found.target);
  out.caption += probability ? " Near 1 the data ask for the term, near 0 they speak against it; between, they do not decide."
                             : " It is the root mean square of the term against that of all that is explained.";
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
  std::size_t const count = std::min(terms.size(), shown_cells);
  Cells const cells(count, 3, 140);
  Figure out;
  out.name = equation_name(discovery, "coefficients", equation);
  out.title = fmt::format("Coefficients of {}", discovery.equations[equation].target);
  out.script = preamble(out.name, cells.width, cells.height);
  for (std::size_t i = 0; i < count; ++i) {
    DiscoveredTerm const& term = *terms[i];
    Panel p = cells.cell(i, 14, 12, 46, 20);
    p.x = axis(term.coefficient - 3.5 * term.sd, term.coefficient + 3.5 * term.sd, 4);
    p.x.clear_edges(0.03);
    p.y = {0, 1.08, 0, {}};
    p.y_axis = false;
    p.x_label = axis_label("of " + term.text, term.unit, p.x);
    auto const [mean, sd] = coefficient_text(p.x.origin_text.empty() ? p.x.scaled(term.coefficient) : term.coefficient,
                                             p.x.origin_text.empty() ? p.x.scaled_width(term.sd) : term.sd);
    p.title = fmt::format("{} ± {}", pretty_number(mean), pretty_number(sd));
    auto const curve = [&](double from, double to) {
      std::vector<std::vector<double>> rows;
      for (int k = 0; k <= 80; ++k) {
        double const z = from + (to - from) * k / 80;
        rows.push_back({p.x.scaled(term.coefficient + z * term.sd), std::exp(-0.5 * z * z)});
      }
      return rows;
    };
    constexpr double ninety = 1.6449;  // sds to either side that hold 90 %
    out.script +=
        data_block(fmt::format("all{}", i), curve(-3.5, 3.5)) + data_block(fmt::format("inner{}", i), curve(-ninety, ninety));
    out.script += panel(p, cells.width, cells.height);
    out.script += fmt::format(
        "plot $all{0} using 1:2 with filledcurves y1=0 fc rgb '{1}' fs noborder, "
        "$inner{0} using 1:2 with filledcurves y1=0 fc rgb '{2}' fs noborder, $all{0} using 1:2 with lines lw 1.6 lc rgb '{3}'\n",
        i, noise_band, response_band, model);
  }
  out.script += "unset multiplot\n";
  out.caption = fmt::format(
      "Posterior densities of the coefficients in {} given that these terms and no others stand there; the darker part holds 90 %, "
      "the "
      "numbers above are mean ± sd, in the unit of the axis.{}",
      discovery.equations[equation].target, cells_left_out(terms.size()));
  return out;
}

}  // namespace sysid

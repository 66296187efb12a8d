// What a discovery says of the terms of an equation: how sure each is, and the posterior of the coefficients that were chosen.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/text/number.hpp"
#include "report/figure/figures.hpp"
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
  // Of characters each term has one line, above those of the axis, its numbers and its label.
  constexpr int lines_below = 3;
  out.script = preamble(out.name, width, height, static_cast<int>(order.size()) + lines_below + 1);
  Axis x = probability ? axis(0, 1, 5) : axis(0, largest, 5, 0);
  Panel p = panel_at(left, width - 62.0, 44, height - 12.0, std::move(x), {0, static_cast<double>(order.size()), 0, {}});
  p.x_label = axis_label(discovery.measure, "", p.x);
  std::vector<std::vector<double>> kept, dropped;
  std::string labels;
  int longest = 0;
  for (std::size_t r = 0; r < order.size(); ++r) {
    DiscoveredTerm const& term = found.terms[order[r]];
    double const y = static_cast<double>(order.size() - r) - 0.5, end = p.x.scaled(term.measure);
    (term.kept ? kept : dropped).push_back({end / 2, y, 0, end, y - 0.34, y + 0.34});
    std::string const name = shortened(term.text, left - 26);
    longest = std::max(longest, text_width(name));
    labels += fmt::format("set label {} {} at graph 0, first {:.6g} right offset -1,0 textcolor rgb '{}'\n", 100 + 2 * r,
                          quote(name), y, term.kept ? ink : muted);
    std::string const value = probability ? probability_text(term.measure) : significant(term.measure, 3);
    // Characters have no colour to tell what was kept.
    labels +=
        fmt::format("set label {} (format eq 'text' ? ' {}{}' : '{}') at first {:.6g},{:.6g} left offset 1,0 textcolor rgb '{}'\n",
                    101 + 2 * r, value, term.kept ? " kept" : "", value, end, y, muted);
  }
  std::string plots, lines;
  auto const bars = [&](char const* name, std::vector<std::vector<double>> const& rows, std::string_view colour) {
    if (rows.empty()) return;
    out.script += data_block(name, rows);
    plots += fmt::format("{}${} using 1:2:3:4:5:6 with boxxyerror fc rgb '{}' fs solid noborder", plots.empty() ? "plot " : ", ",
                         name, colour);
    lines += fmt::format("{}${} using 3:2:4:(0) with vectors nohead", lines.empty() ? "plot " : ", ", name);
  };
  bars("kept", kept, model);
  bars("dropped", dropped, muted);
  if (plots.empty()) plots = lines = "plot NaN";
  p.y_axis = false;
  out.script += panel(p, width, height) + labels;
  // Margins of characters, so that names and values have room however few columns there are.
  constexpr int value_width = 13;
  out.script += fmt::format(
      "if (format eq 'text') {{\nset lmargin {}\nset rmargin {}\nset bmargin {}\nset tmargin 0\n{}\n}} else {{\n{}\n}}\n"
      "unset multiplot\n",
      longest + 2, value_width, lines_below, lines, plots);
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
  std::size_t const count = std::min(terms.size(), shown_cells);
  auto const label = [](DiscoveredTerm const& term) { return "coefficient of " + term.text; };
  auto const axis_of = [](DiscoveredTerm const& term) {
    return axis(term.coefficient - 3.5 * term.sd, term.coefficient + 3.5 * term.sd, 4);
  };
  constexpr double room = column_width / 3.0;
  bool const short_labels = std::all_of(terms.begin(), terms.end(), [&](DiscoveredTerm const* each) {
    return text_pixels(axis_label(label(*each), each->unit, axis_of(*each))) <= room;
  });
  Cells const cells(count, short_labels ? 3 : 2, 140);
  Figure out;
  out.name = equation_name(discovery, "coefficients", equation);
  out.title = fmt::format("Coefficients of {}", discovery.equations[equation].target);
  out.script = preamble(out.name, cells.width, cells.height);
  for (std::size_t i = 0; i < count; ++i) {
    DiscoveredTerm const& term = *terms[i];
    Panel p = cells.cell(i, 14, 12, 46, 20);
    p.x = axis_of(term);
    p.x.clear_edges(0.03);
    p.y = {0, 1.08, 0, {}};
    p.y_axis = false;
    p.x_label = axis_label(label(term), term.unit, p.x);
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
      "Posterior densities of the coefficients in {} given exactly these terms; the darker part holds 90 %, the "
      "numbers above are mean ± sd, in the unit of the axis.{}",
      discovery.equations[equation].target, cells_left_out(terms.size()));
  return out;
}

}  // namespace sysid

// A figure as data, and the script that becomes of it.
#include "report/figure/drawing.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "report/figure/named_bars.hpp"
#include "report/figure/small_multiples.hpp"

using namespace sysid;
using namespace sysid::plot;

namespace {

std::size_t count(std::string const& text, std::string const& what) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++found;
  return found;
}

Panel small_panel() { return panel_at(70, 400, 44, 190, axis(0, 1, 2), axis(0, 1, 2)); }

}  // namespace

TEST_CASE("series are one list, in the order in which they are drawn") {
  CHECK(plot_list({band("fit", 3, 4, "#aabbcc"), line("fit", 2, 1.4, "#000000")}) ==
        "$fit using 1:3:4 with filledcurves fc rgb '#aabbcc' fs noborder, $fit using 1:2 with lines lw 1.4 lc rgb '#000000'");
  CHECK(plot_list({level(0, "#000000")}) == "0 with lines lw 1 lc rgb '#000000'");
  CHECK(plot_list({}) == "NaN");
}

TEST_CASE("a legend is drawn once, before the second panel") {
  Drawing drawing{"two", column_width, 200, Legend{{{Key::line, model, "mean"}}}};
  for (char const* table : {"first", "second"})
    drawing.plots.push_back({small_panel(), {{table, {{0, 0}, {1, 1}}}}, {line(table, 2, 1, model)}});
  for (bool const after : {false, true}) {
    drawing.legend->after_first_panel = after;
    std::string const text = script(drawing);
    CHECK(count(text, "'mean'") == 1);
    CHECK(count(text, end_legend()) == 1);
    CHECK(text.find("'mean'") < text.find("plot $first"));
    CHECK(text.find("plot $first") < text.find(end_legend()));
    CHECK(text.find(end_legend()) < text.find("$second << EOD"));
    CHECK(text.ends_with("unset multiplot\n"));
  }
}

TEST_CASE("a note takes the place of axes and series") {
  Drawing drawing{"note", column_width, 200};
  drawing.plots.push_back({small_panel(), {}, {}, Note{"0.98", contrast}});
  std::string const text = script(drawing);
  CHECK(count(text, "'0.98'") == 1);
  CHECK(count(text, "unset border") == 1);
  CHECK(count(text, "unset label 1\n") == 1);
}

TEST_CASE("small multiples stand in rows inside the figure, apart from each other") {
  constexpr std::size_t number = 7;
  SmallMultiples const multiples(number, 3, 100, 10, 20);
  CHECK(multiples.columns == 3);
  CHECK(multiples.rows == 3);
  CHECK(multiples.height == 330);
  CHECK_FALSE(multiples.in_last_row(5));
  CHECK(multiples.in_last_row(6));
  for (std::size_t i = 0; i < number; ++i) {
    Panel const p = multiples.panel(i, {14, 12, 46, 20});
    CHECK(p.left >= 0);
    CHECK(p.right <= multiples.width);
    CHECK(p.bottom >= 10);
    CHECK(p.top <= multiples.height - 20);
    for (std::size_t j = 0; j < i; ++j) {
      Panel const other = multiples.panel(j, {14, 12, 46, 20});
      bool const apart = other.right <= p.left || p.right <= other.left || other.bottom >= p.top || p.bottom >= other.top;
      CHECK_MESSAGE(apart, i << " and " << j);
    }
  }
  CHECK(multiples_excluded(shown_multiples) == "");
  CHECK(multiples_excluded(40) == " Shown are the first 18 of 40.");
}

TEST_CASE("panels side by side fill the width and leave room for the ordinate") {
  for (std::size_t const number : {1U, 2U, 3U}) {
    double end = 0;
    for (std::size_t i = 0; i < number; ++i) {
      Panel const p = panel_beside(i, number, 14, 44, 190, {}, {});
      CHECK(p.left >= std::max(end, ordinate_room));
      end = p.right;
    }
    CHECK(end == column_width - 14);
  }
}

TEST_CASE("named bars have one row each, those kept in a colour of their own") {
  std::string const text =
      script(NamedBars{"terms", axis(0, 1, 5), "probability", {{"x", "0.97", 0.97, true}, {"x^2", "0.1", 0.1}}});
  CHECK(text.find("$kept << EOD\n0.485 1.5 0 0.97") != std::string::npos);
  CHECK(text.find("$dropped << EOD\n0.05 0.5 0 0.1") != std::string::npos);
  CHECK(count(text, "' 0.97 kept'") == 1);
  CHECK(script(NamedBars{"terms", axis(0, 1, 5), "probability", {}}).find("plot NaN") != std::string::npos);
}

// The page: self-contained, escaped, and honest about figures that are missing.
#include "report/html.hpp"

#include <doctest/doctest.h>

#include "example.hpp"

using namespace sysid;

TEST_CASE("the page needs nothing from elsewhere and runs no script") {
  std::string const page = report_html(example::duffing(20), {});
  for (char const* word : {"<script", "src=", "<link", "@import", "url("})
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  CHECK(page.find("https://") == std::string::npos);
}

TEST_CASE("the page shows model, data, result, failures and how to repeat it") {
  std::string const page = report_html(example::duffing(20), {});
  for (char const* text :
       {"<h1>Duffing's oscillator</h1>", "sha256 9f86d081884c7d65", "1500 rows, 500 of them scored", "<h2>Result</h2>",
        "<h2>Convergence</h2>", "<h2>Modes</h2>", "100000 simulations, 3 of them failed", "Seed 1.", "25000"})
    CHECK_MESSAGE(page.find(text) != std::string::npos, text);
}

TEST_CASE("the user's text cannot become markup") {
  Report report = example::duffing(20);
  report.task = "<b>x</b>";
  report.findings.push_back({Severity::warning, "c", "a < b", "<i>"});
  std::string const page = report_html(report, {});
  CHECK(page.find("<b>x</b>") == std::string::npos);
  CHECK(page.find("&lt;b&gt;x&lt;/b&gt;") != std::string::npos);
  CHECK(page.find("a &lt; b") != std::string::npos);
  CHECK(page.find("# &lt;as printed&gt;") != std::string::npos);
}

TEST_CASE("the verdict box takes the colour of the worst finding") {
  Report report = example::duffing(20);
  CHECK(report_html(report, {}).find("<div class=\"verdict good\">") != std::string::npos);
  report.findings.push_back({Severity::warning, "c", "m", ""});
  CHECK(report_html(report, {}).find("<div class=\"verdict doubtful\">") != std::string::npos);
  report.findings.push_back({Severity::error, "c", "m", ""});
  CHECK(report_html(report, {}).find("<div class=\"verdict bad\">") != std::string::npos);
}

TEST_CASE("figures that could not be drawn are named, with the way to get them") {
  std::string const page = report_html(example::duffing(20), {{{"trace", "Traces", "", ""}, std::nullopt},
                                                              {{"ranks", "Rank plots", "A caption.", ""}, "<svg >drawn</svg>"}});
  CHECK(page.find("<li>Traces (<code>figures/trace.gnuplot</code>)</li>") != std::string::npos);
  CHECK(page.find("gnuplot-nox") != std::string::npos);
  CHECK(page.find("<b>Figure 1.</b> A caption.") != std::string::npos);
}

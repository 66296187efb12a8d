// Fits weighed by scores that are given sample by sample: which samples and fits count.
#include "app/comparison/compare_scores.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "report/page/comparison.hpp"

using namespace sysid;

namespace {

/// Of a record in time, by leave-one-out as by leave-future-out.
ScoredFit scored(std::string name, std::string identity, std::vector<double> elpd) {
  ScoredFit fit;
  fit.name = std::move(name);
  fit.model = "m";
  fit.identity = std::move(identity);
  fit.in_time = true;
  for (int i = 0; i < static_cast<int>(elpd.size()); ++i) fit.samples.push_back({"y", 0, i + 1});
  fit.elpd_loo = fit.elpd_future = std::move(elpd);
  return fit;
}

}  // namespace

TEST_CASE("a fit that gives a sample no density has no weight, and the sample counts for the others") {
  ComparedScores const found = compare_scores(
      {scored("never", "a", {0, 0, -infinity, 0}), scored("good", "b", {-1, -1, -1, -1}), scored("poor", "c", {-2, -1, -2, -1})});
  REQUIRE(found.fits.size() == 3);
  CHECK(found.samples == 4);
  CHECK(found.fits[0].impossible == 1);
  CHECK(found.fits[0].elpd == -infinity);
  CHECK(found.fits[0].stacking == 0);
  CHECK(found.fits[0].pseudo_bma == 0);
  CHECK(found.fits[0].difference == -infinity);
  CHECK(std::isnan(found.fits[0].difference_error));
  CHECK(found.fits[1].difference == 0);
  CHECK(found.fits[2].difference == doctest::Approx(-2));
  CHECK(found.fits[1].stacking > 0.99);
  CHECK(found.fits[1].pseudo_bma + found.fits[2].pseudo_bma == doctest::Approx(1));
  Comparison comparison;
  comparison.scores = found;
  std::string const text = comparison_text(comparison);
  CAPTURE(text);
  CHECK(text.find("never: the density of 1 sample is zero under all draws, so this fit has no weight") != std::string::npos);
  CHECK(text.find("nan") == std::string::npos);
}

TEST_CASE("fits that all give a sample no density have no weights") {
  ComparedScores const found = compare_scores({scored("one", "a", {0, -infinity}), scored("other", "b", {-infinity, 0})});
  REQUIRE(found.fits.size() == 2);
  for (ComparedScore const& each : found.fits) {
    CHECK(each.stacking == 0);
    CHECK(each.pseudo_bma == 0);
    CHECK(each.elpd == -infinity);
  }
  CHECK(found.fits[0].difference == 0);  // the best there is
  CHECK(std::isnan(found.fits[1].difference));
}

TEST_CASE("a model that was fitted twice counts once, and both fits show its weight") {
  std::vector<double> const a = {-1, -2, -1, -2, -1}, b = {-2, -1, -2, -1, -1.5};
  ComparedScores const once = compare_scores({scored("a", "a", a), scored("b", "b", b)}),
                       twice = compare_scores({scored("a", "a", a), scored("b", "b", b), scored("again", "a", a)});
  REQUIRE(twice.fits.size() == 3);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(twice.fits[k].pseudo_bma == once.fits[k].pseudo_bma);
    CHECK(twice.fits[k].stacking == once.fits[k].stacking);
  }
  CHECK(twice.fits[2].pseudo_bma == once.fits[0].pseudo_bma);
  CHECK(twice.fits[2].stacking == once.fits[0].stacking);
  // Alone, it has all of it.
  ComparedScores const alone = compare_scores({scored("a", "a", a), scored("again", "a", a)});
  CHECK(alone.fits[1].stacking == 1);
}

TEST_CASE("a fit of other samples is left out by name") {
  ScoredFit other = scored("other", "b", {-1, -1, -1});
  other.samples[1].channel = "z";
  ComparedScores const found = compare_scores({scored("a", "a", {-1, -2, -1}), std::move(other), scored("c", "c", {-1, -1, -1})});
  REQUIRE(found.fits.size() == 2);
  CHECK(found.fits[1].name == "c");
  CHECK(found.left_out == std::vector<std::string>{"other"});
}

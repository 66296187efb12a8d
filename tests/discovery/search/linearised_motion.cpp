// What a search over sets of terms compares and weighs, against brute force.
#include "discovery/search/linearised_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;

namespace {

/// Two segments whose residuals are linear in nine coefficients, some nearly collinear, and in a start each.
struct Planted {
  static constexpr int terms = 9, rows = 30;
  std::vector<SegmentSlopes> slopes;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(terms);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * rows, terms + 2);  // with those of the starts
  Eigen::VectorXd known = Eigen::VectorXd::Zero(2 * rows);

  explicit Planted(std::uint64_t seed) {
    Stream stream({seed, Purpose::noise, 0, 0});
    at(0) = 1, at(3) = -2;  // not the truth: 0, 2 and 5
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(terms);
    truth(0) = 1, truth(2) = 0.8, truth(5) = -0.5;
    for (int s = 0; s < 2; ++s) {
      SegmentSlopes each{Eigen::VectorXd(rows), Eigen::MatrixXd(rows, terms), Eigen::MatrixXd(rows, 1)};
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < terms; ++j) each.by_coefficient(i, j) = 20 * stream.normal();
        each.by_coefficient(i, 4) = each.by_coefficient(i, 2) + each.by_coefficient(i, 5) + 0.05 * each.by_coefficient(i, 4);
        each.by_start(i, 0) = 5 * stream.normal();
        each.residual(i) = stream.normal();
      }
      each.residual += each.by_coefficient * (at - truth) + each.by_start.col(0) * (s == 0 ? 3.0 : -1.0);
      columns.block(s * rows, 0, rows, terms) = each.by_coefficient;
      columns.block(s * rows, terms + s, rows, 1) = each.by_start;
      known.segment(s * rows, rows) = each.by_coefficient * at - each.residual;
      slopes.push_back(std::move(each));
    }
  }

  LinearisedMotion motion() const {
    return {slopes,
            at,
            {.samples = 60,
             .floor = 1e-12,
             .signal = 300,
             .log_odds = std::vector<double>(9, -1.0),
             .always = {1, 0, 0, 0, 0, 0, 0, 0, 0}}};
  }
  /// Squares that terms leave, with the best starts.
  double squares(Terms terms) const {
    terms.push_back(Planted::terms);
    terms.push_back(Planted::terms + 1);
    Eigen::MatrixXd chosen(2 * rows, static_cast<Eigen::Index>(terms.size()));
    for (std::size_t i = 0; i < terms.size(); ++i) chosen.col(static_cast<Eigen::Index>(i)) = columns.col(terms[i]);
    return (known - chosen * OrthogonalTriangular(chosen).solve(known)).squaredNorm();
  }
  static Terms moved(Terms terms, LinearisedMotion::Move const& move) {
    std::erase_if(terms, [&](int j) { return std::find(move.out.begin(), move.out.end(), j) != move.out.end(); });
    terms.insert(terms.end(), move.in.begin(), move.in.end());
    std::sort(terms.begin(), terms.end());
    return terms;
  }
};

}  // namespace

TEST_CASE("the squares of every move are those of least squares with the starts, and the best of each kind is found") {
  Planted const planted(1);
  LinearisedMotion const motion = planted.motion();
  for (Terms const& from : {Terms{0, 3}, Terms{0, 1, 2, 4, 5}, Terms{0}}) {
    CAPTURE(from.size());
    auto const moves = motion.moves(from, 2);
    double least[3][3];
    for (auto& row : least)
      for (double& each : row) each = 1e300;
    for (LinearisedMotion::Move const& move : moves) {
      Terms const terms = Planted::moved(from, move);
      CHECK(move.squares == doctest::Approx(planted.squares(terms)).epsilon(1e-8));
      CHECK(std::find(terms.begin(), terms.end(), 0) != terms.end());  // in every set
      double& best = least[move.out.size()][move.in.size()];
      best = std::min(best, move.squares);
    }
    for (unsigned set = 0; set < 1u << (Planted::terms - 1); ++set) {
      Terms terms = {0};
      for (int j = 1; j < Planted::terms; ++j)
        if ((set >> (j - 1) & 1u) != 0) terms.push_back(j);
      auto const missing = [](Terms const& a, Terms const& b) {
        return std::count_if(a.begin(), a.end(), [&](int j) { return !std::binary_search(b.begin(), b.end(), j); });
      };
      auto const out = missing(from, terms), in = missing(terms, from);
      if (out > 2 || in > 2 || out + in == 0) continue;
      CHECK(planted.squares(terms) >= least[out][in] * (1 - 1e-8));
    }
  }
}

TEST_CASE("the best set near a wrong one is the best of all sets") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    Planted const planted(seed);
    LinearisedMotion const motion = planted.motion();
    auto const found = best_terms(motion, {{0, 3}});
    CHECK(found.front().terms == Terms{0, 2, 5});
    double best = -1e300;
    for (unsigned set = 0; set < 1u << (Planted::terms - 1); ++set) {
      Terms terms = {0};
      for (int j = 1; j < Planted::terms; ++j)
        if ((set >> (j - 1) & 1u) != 0) terms.push_back(j);
      best = std::max(best, motion.weigh(terms).score);
    }
    CHECK(found.front().score == doctest::Approx(best));
    for (std::size_t i = 1; i < found.size(); ++i) CHECK(found[i].score <= found[i - 1].score);
  }
}

TEST_CASE("a coefficient whose perturbation is not finite is not offered") {
  Planted planted(2);
  planted.slopes[1].by_coefficient(3, 2) = std::nan("");
  LinearisedMotion const motion = planted.motion();
  CHECK_FALSE(motion.usable(2));
  for (WeighedTerms const& each : best_terms(motion, {{0, 3}}))
    CHECK(std::find(each.terms.begin(), each.terms.end(), 2) == each.terms.end());
}

TEST_CASE("sets that are built up begin with what is given, and reach what moves from many wrong terms do not") {
  Planted const planted(2);
  LinearisedMotion const motion = planted.motion();
  std::vector<Terms> const sets = built_up(motion, {0}, 2);
  CHECK(sets.front() == Terms{0});
  CHECK(std::find(sets.begin(), sets.end(), Terms{0, 2, 5}) != sets.end());
  for (Terms const& each : sets) {
    CHECK(each.size() <= 3);
    CHECK(each.front() == 0);
    CHECK(std::is_sorted(each.begin(), each.end()));
  }
}

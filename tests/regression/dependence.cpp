// What columns cannot tell, each named with its terms.
#include "regression/column/dependence.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/numeric/random.hpp"

using namespace sysid;
using namespace sysid::regression;

namespace {

struct Case {
  Equation equation;
  Columns columns;
};

Case with(std::vector<std::string> const& names) {
  Case c;
  Stream stream({9, Purpose::test, 0, 0});
  c.columns.terms.resize(40, static_cast<Eigen::Index>(names.size()));
  c.columns.known = Eigen::VectorXd::Ones(40);
  for (Eigen::Index j = 0; j < c.columns.terms.cols(); ++j)
    for (int i = 0; i < 40; ++i) c.columns.terms(i, j) = stream.normal();
  for (std::string const& name : names) c.equation.terms.push_back({name, 0});
  return c;
}

}  // namespace

TEST_CASE("independent columns are all kept and nothing is said") {
  Case const c = with({"a", "b", "c"});
  Usable const usable = independent_terms(c.equation, c.columns);
  CHECK(usable.terms == std::vector<int>{0, 1, 2});
  CHECK(usable.concerns.empty());
  CHECK(near_dependence(c.equation, c.columns, usable.terms).empty());
}

TEST_CASE("zero, infinite, repeated and summed columns are named and left out") {
  Case c = with({"a", "b", "zero", "bad", "twice", "sum", "d"});
  c.columns.terms.col(2).setZero();
  c.columns.terms(7, 3) = std::numeric_limits<double>::infinity();
  c.columns.terms.col(4) = 1e9 * c.columns.terms.col(1);
  c.columns.terms.col(5) = c.columns.terms.col(0) - 2 * c.columns.terms.col(1);
  Usable const usable = independent_terms(c.equation, c.columns);
  CHECK(usable.terms == std::vector<int>{0, 1, 6});
  REQUIRE(usable.concerns.size() == 4);
  CHECK(usable.concerns[0].kind == Concern::Kind::always_zero);
  CHECK(usable.concerns[0].terms == std::vector<int>{2});
  CHECK(usable.concerns[1].kind == Concern::Kind::not_finite);
  CHECK(usable.concerns[1].value == 1);
  CHECK(usable.concerns[2].kind == Concern::Kind::repeats);
  CHECK(usable.concerns[2].terms == std::vector<int>{1, 4});
  CHECK(usable.concerns[2].clause == "`twice` is a multiple of `b` on these data and is left out");
  CHECK(usable.concerns[3].kind == Concern::Kind::collinear);
  CHECK(usable.concerns[3].terms == std::vector<int>{5, 0, 1});
}

TEST_CASE("a term that is always in outlives its double, wherever it stands") {
  Case c = with({"a", "b"});
  c.columns.terms.col(1) = 3 * c.columns.terms.col(0);
  c.equation.terms[1].always = true;
  CHECK(independent_terms(c.equation, c.columns).terms == std::vector<int>{1});
}

TEST_CASE("nearly dependent terms are a group, and their variance is inflated as it must be") {
  Case c = with({"a", "b", "c"});
  c.columns.terms.col(2) = c.columns.terms.col(0) + 1e-3 * c.columns.terms.col(2);
  Concerns const near = near_dependence(c.equation, c.columns, {0, 1, 2});
  REQUIRE(near.size() == 1);
  CHECK(near[0].kind == Concern::Kind::nearly_collinear);
  CHECK(near[0].terms == std::vector<int>{0, 2});
  CHECK(near[0].value > 1000);
  // 1 / (1 - r^2) of two columns
  Eigen::VectorXd const a = c.columns.terms.col(0).normalized(), b = c.columns.terms.col(1).normalized();
  double const r = a.dot(b);
  std::vector<double> const inflation = variance_inflation(c.columns, {0, 1});
  CHECK(inflation[0] == doctest::Approx(1 / (1 - r * r)).epsilon(1e-10));
  CHECK(inflation[1] == doctest::Approx(1 / (1 - r * r)).epsilon(1e-10));
}

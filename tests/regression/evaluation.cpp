// Rows of several records as one problem, and whether what is left of it is white.
#include "regression/column/evaluation.hpp"

#include <doctest/doctest.h>

#include "regression/error_concerns.hpp"

using namespace sysid;
using namespace sysid::regression;

TEST_CASE("blocks of rows follow one another, the known side before the terms") {
  Eigen::MatrixXd const all{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  Columns const columns = stacked({rows_at(all, {0, 2}), Eigen::MatrixXd(0, 3), rows_at(all, {1})}, 2);
  CHECK(columns.known == Eigen::VectorXd{{1, 7, 4}});
  CHECK(columns.terms == Eigen::MatrixXd{{2, 3}, {8, 9}, {5, 6}});
  CHECK(stacked({}, 2).terms.cols() == 2);
}

TEST_CASE("a sequence that changes its sign at each row has correlations of -1 and 1") {
  Eigen::VectorXd const errors{{1, -1, 1, -1, 1, -1, 1, -1}};
  Portmanteau const found = portmanteau(errors, 2);
  CHECK(found.correlations == doctest::Approx(-7.0 / 8 + 6.0 / 8));
  CHECK(found.statistic == doctest::Approx(80 * (49.0 / 64 / 7 + 36.0 / 64 / 6)));
}

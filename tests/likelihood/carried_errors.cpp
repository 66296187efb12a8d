// Rows made independent, against the whole covariance.
#include "likelihood/segments/carried_errors.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;

namespace {

constexpr int all_rows = 12, moved = 2, recorded = 2, channels_read = 3, first_row = 3, rows_read = 8;

Eigen::MatrixXd normals(Eigen::Index height, Eigen::Index width, Stream& stream) {
  Eigen::MatrixXd matrix(height, width);
  for (Eigen::Index j = 0; j < width; ++j)
    for (Eigen::Index i = 0; i < height; ++i) matrix(i, j) = stream.normal();
  return matrix;
}

CarriedErrors made_errors() {
  Stream stream({3, Purpose::test, 0, 0});
  CarriedErrors out;
  for (int n = 0; n < all_rows; ++n) {
    out.input_sd.emplace_back(normals(recorded, 1, stream).cwiseAbs());
    if (n + 1 == all_rows) break;
    out.ahead.push_back(0.6 * normals(moved, moved, stream));
    out.here.push_back(normals(moved, recorded, stream));
    out.next.push_back(normals(moved, recorded, stream));
  }
  out.state_of_channel = {1, -1, 0};
  for (int c = 0; c < channels_read; ++c) {
    std::vector<double> sds;
    for (int n = 0; n < all_rows; ++n) sds.push_back(0.2 + std::abs(stream.normal()));
    out.own_sd.push_back(sds);
  }
  return out;
}

/// Of the rows of slopes, from the start of the segment on.
Eigen::MatrixXd covariance_of(CarriedErrors const& errors) {
  Eigen::MatrixXd by_inputs = Eigen::MatrixXd::Zero(channels_read * rows_read, rows_read * recorded),
                  state = Eigen::MatrixXd::Zero(moved, rows_read * recorded);
  for (int i = 0; i < rows_read; ++i) {
    for (int c = 0; c < channels_read; ++c)
      if (int const x = errors.state_of_channel[static_cast<std::size_t>(c)]; x >= 0)
        by_inputs.row(c * rows_read + i) = state.row(x);
    if (i + 1 == rows_read) break;
    auto const n = static_cast<std::size_t>(first_row + i);
    state = (errors.ahead[n] * state).eval();
    state.middleCols(i * recorded, recorded) += errors.here[n];
    state.middleCols((i + 1) * recorded, recorded) += errors.next[n];
  }
  Eigen::VectorXd sds(rows_read * recorded);
  for (int i = 0; i < rows_read; ++i)
    sds.segment(i * recorded, recorded) = errors.input_sd[static_cast<std::size_t>(first_row + i)];
  Eigen::MatrixXd const scaled = by_inputs * sds.asDiagonal();
  Eigen::MatrixXd covariance = scaled * scaled.transpose();
  for (int c = 0; c < channels_read; ++c)
    for (int i = 0; i < rows_read; ++i)
      covariance(c * rows_read + i, c * rows_read + i) +=
          std::pow(errors.own_sd[static_cast<std::size_t>(c)][static_cast<std::size_t>(first_row + i)], 2);
  return covariance;
}

}  // namespace

TEST_CASE("rows that are made independent have the likelihood of the whole covariance, with samples missing too") {
  CarriedErrors const carried = made_errors();
  Eigen::MatrixXd const covariance = covariance_of(carried);
  for (bool const gaps : {false, true}) {
    CAPTURE(gaps);
    auto const measured = [&](int row) { return !gaps || row % 5 != 1; };
    RowWhitener const whitener(carried, first_row, rows_read, measured);
    Stream stream({4, Purpose::test, 0, 0});
    Eigen::MatrixXd columns = normals(channels_read * rows_read, 2, stream);
    std::vector<Eigen::Index> kept;
    for (int row = 0; row < channels_read * rows_read; ++row)
      if (measured(row))
        kept.push_back(row);
      else
        columns.row(row).setZero();
    auto const n = static_cast<Eigen::Index>(kept.size());
    Eigen::MatrixXd of_kept(n, n), before(n, 2), after(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      before.row(i) = columns.row(kept[static_cast<std::size_t>(i)]);
      for (Eigen::Index j = 0; j < n; ++j)
        of_kept(i, j) = covariance(kept[static_cast<std::size_t>(i)], kept[static_cast<std::size_t>(j)]);
    }
    whitener.apply(columns);
    double logs = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      double const sd = whitener.sds()[static_cast<std::size_t>(kept[static_cast<std::size_t>(i)])];
      after.row(i) = columns.row(kept[static_cast<std::size_t>(i)]) / sd;
      logs += std::log(sd);
    }
    auto const lower = cholesky(of_kept);
    REQUIRE(lower);
    Eigen::MatrixXd const solved = lower->triangularView<Eigen::Lower>().solve(before);
    CHECK((after.transpose() * after - solved.transpose() * solved).norm() < 1e-9 * solved.squaredNorm());
    CHECK(logs == doctest::Approx(lower->diagonal().array().log().sum()));
    if (gaps) continue;
    CHECK(whitener.sds()[0] == carried.own_sd[0][first_row]);  // the start is known
    CHECK(whitener.sds()[1] > carried.own_sd[0][first_row + 1]);
  }
}

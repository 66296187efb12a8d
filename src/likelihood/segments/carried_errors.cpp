// States and the input's present error are one vector, so that neighbouring intervals share an error.
#include "likelihood/segments/carried_errors.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {

RowWhitener::RowWhitener(CarriedErrors const& errors, int first, int count, std::function<bool(int)> const& measured)
    : count_(count), state_of_channel_(errors.state_of_channel) {
  auto const channels = static_cast<int>(errors.own_sd.size());
  Eigen::Index const d = errors.ahead.front().rows(), u = errors.here.front().cols();
  size_ = d + u;
  sds_.assign(static_cast<std::size_t>(channels * count), 1.0);
  gains_.resize(sds_.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(d + u, d + u);
  covariance.bottomRightCorner(u, u).diagonal() = errors.input_sd[static_cast<std::size_t>(first)].array().square();
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < channels; ++c) {
      int const row = c * count + i, state = errors.state_of_channel[static_cast<std::size_t>(c)];
      if (!measured(row)) continue;
      double const own = errors.own_sd[static_cast<std::size_t>(c)][static_cast<std::size_t>(first + i)];
      double const variance = own * own + (state < 0 ? 0 : std::max(covariance(state, state), 0.0));
      sds_[static_cast<std::size_t>(row)] = std::sqrt(variance);
      if (state < 0 || !(variance > 0)) continue;
      Eigen::VectorXd gain = covariance.col(state) / variance;
      covariance -= gain * gain.transpose() * variance;
      gains_[static_cast<std::size_t>(row)] = std::move(gain);
    }
    if (i + 1 == count) break;
    auto const n = static_cast<std::size_t>(first + i);
    Eigen::MatrixXd forward = Eigen::MatrixXd::Zero(d + u, d + u), push(d + u, u);
    forward.topLeftCorner(d, d) = errors.ahead[n];
    forward.topRightCorner(d, u) = errors.here[n];
    push << errors.next[n], Eigen::MatrixXd::Identity(u, u);
    push.array().rowwise() *= errors.input_sd[n + 1].transpose().array();
    covariance = (forward * covariance * forward.transpose() + push * push.transpose()).eval();
    forwards_.push_back(std::move(forward));
  }
}

void RowWhitener::apply(Eigen::Ref<Eigen::MatrixXd> columns) const {
  if (columns.cols() == 0) return;
  auto const channels = static_cast<int>(state_of_channel_.size());
  Eigen::MatrixXd foretold = Eigen::MatrixXd::Zero(size_, columns.cols());
  for (int i = 0; i < count_; ++i) {
    for (int c = 0; c < channels; ++c) {
      int const row = c * count_ + i;
      Eigen::VectorXd const& gain = gains_[static_cast<std::size_t>(row)];
      if (gain.size() == 0) continue;
      columns.row(row) -= foretold.row(state_of_channel_[static_cast<std::size_t>(c)]);
      foretold += gain * columns.row(row);
    }
    if (i + 1 < count_) foretold = (forwards_[static_cast<std::size_t>(i)] * foretold).eval();
  }
}

}  // namespace sysid

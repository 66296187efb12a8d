// Transitions, stationary covariances and their derivatives, block by block.
#include "gaussian_process/state_space_model.hpp"

namespace sysid::gaussian_process {

bool has_state_space(Covariance const& covariance) {
  if (!covariance.is_sum()) return false;
  int column = -1, states = 0;
  for (Covariance::Term const& term : covariance.terms()) {
    if (term.row->state_space == nullptr) return false;
    states += term.row->state_space->dimension;
    for (int const own : term.columns) {
      if (column >= 0 && own != column) return false;
      column = own;
    }
  }
  return column >= 0 && states <= most_states;
}

StateSpaceModel::StateSpaceModel(Covariance const& covariance, Numbers parameters)
    : parameter_count_(covariance.parameter_count()) {
  for (Covariance::Term const& term : covariance.terms()) {
    int const d = term.row->state_space->dimension;
    Numbers const own =
        parameters.subspan(static_cast<std::size_t>(term.first_parameter), static_cast<std::size_t>(term.parameter_count));
    auto const elements = static_cast<std::size_t>(d * d), all = elements * own.size();
    blocks_.push_back({term.row->state_space, own, dimension_, term.first_parameter, std::vector<double>(elements),
                       std::vector<double>(all), std::vector<double>(all)});
    dimension_ += d;
    if (!term.columns.empty()) column_ = term.columns.front();
  }
  auto const d = static_cast<std::size_t>(dimension_);
  stationary_.assign(d * d, 0);
  transition_.assign(d * d, 0);
  measured_.assign(d, 0);
  for (Block& block : blocks_) {
    int const own = block.row->dimension;
    block.row->stationary(block.parameters, block.transition.data(), block.stationary_derivatives.data());
    for (int j = 0; j < own; ++j)
      for (int i = 0; i < own; ++i)
        stationary_[static_cast<std::size_t>(block.first_state + i + dimension_ * (block.first_state + j))] =
            block.transition[static_cast<std::size_t>(i + own * j)];
    measured_[static_cast<std::size_t>(block.first_state)] = 1;
  }
}

double const* StateSpaceModel::transition(double step, bool with_derivatives) {
  for (Block& block : blocks_) {
    int const own = block.row->dimension;
    block.row->transition(block.parameters, step, block.transition.data(),
                          with_derivatives ? block.transition_derivatives.data() : nullptr);
    double const* from = block.transition.data();
    for (int j = 0; j < own; ++j) {
      double* const to = transition_.data() + block.first_state + dimension_ * (block.first_state + j);
      for (int i = 0; i < own; ++i) to[i] = *from++;
    }
  }
  return transition_.data();
}

void StateSpaceModel::add_gradient(double const* weight, std::vector<double> Block::*derivatives, double* gradient) const {
  for (Block const& block : blocks_) {
    int const own = block.row->dimension;
    double const* derivative = (block.*derivatives).data();
    for (std::size_t p = 0; p < block.parameters.size(); ++p) {
      double sum = 0;
      for (int j = 0; j < own; ++j) {
        double const* const at = weight + block.first_state + dimension_ * (block.first_state + j);
        for (int i = 0; i < own; ++i) sum += at[i] * *derivative++;
      }
      gradient[static_cast<std::size_t>(block.first_parameter) + p] += sum;
    }
  }
}

void StateSpaceModel::add_transition_gradient(double const* weight, double* gradient) const {
  add_gradient(weight, &Block::transition_derivatives, gradient);
}

void StateSpaceModel::add_stationary_gradient(double const* weight, double* gradient) const {
  add_gradient(weight, &Block::stationary_derivatives, gradient);
}

}  // namespace sysid::gaussian_process

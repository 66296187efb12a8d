// Moves within a box about the centre.
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "inference/abc/kernel.hpp"

namespace sysid::abc {
namespace {

/// Of a place: a move to the box's edge must not end outside of it.
constexpr double rounding = std::numeric_limits<double>::epsilon();

class Uniform : public Kernel {
 public:
  Uniform(ConstLanes at, std::span<double const> weight, Eigen::VectorXd const& widths)
      : at_(at), weight_(weight), widths_(widths) {
    for (double const width : widths_) log_density_ -= elementary::log(width);
  }

  void perturb(std::span<int const> centres, std::span<Stream> streams, Lanes out) const override {
    for (int d = 0; d < at_.rows(); ++d)
      for (std::size_t w = 0; w < centres.size(); ++w)
        out.row(d)[w] = at_(d, centres[w]) + widths_[d] * (streams[w].uniform() - 0.5);
  }

  void log_density(ConstLanes x, std::span<double> out) const override {
    std::vector<double> inside(static_cast<std::size_t>(at_.width()));
    for (int w = 0; w < x.width(); ++w) {
      std::copy(weight_.begin(), weight_.end(), inside.begin());
      for (int d = 0; d < at_.rows(); ++d) {
        double const place = x(d, w), half = 0.5 * widths_[d] + rounding * std::abs(place);
        double const* const row = at_.row(d).data();
        for (std::size_t j = 0; j < inside.size(); ++j) inside[j] = std::abs(row[j] - place) <= half ? inside[j] : 0;
      }
      out[static_cast<std::size_t>(w)] = log_density_ + elementary::log(std::accumulate(inside.begin(), inside.end(), 0.0));
    }
  }

 private:
  ConstLanes at_;
  std::span<double const> weight_;
  Eigen::VectorXd widths_;
  double log_density_ = 0;  // in the box
};

}  // namespace

std::unique_ptr<Kernel> make_uniform(Plan const& plan, ConstLanes at, std::span<double const> weight, Width const& width) {
  return std::make_unique<Uniform>(at, weight, plan.scale * width.range);
}

}  // namespace sysid::abc

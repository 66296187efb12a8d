// One parameter's draws as a histogram and as a smooth density. Draws are sorted, rising.
#pragma once
#include <functional>
#include <utility>
#include <vector>

namespace sysid {

/// Of the draws in [from, to], which is not empty; the density is that of all draws. Bins by Freedman and Diaconis 1981, kept
/// within what the eye can read.
struct Histogram {
  double low, width;
  std::vector<double> density;

  Histogram(std::vector<double> const& sorted, double from, double to);
  double peak() const;
  /// The outline between two abscissae, as corners: {abscissa, density}.
  std::vector<std::pair<double, double>> outline(double from, double to) const;
};

/// All draws, but for tails so long that the bulk would be one bar: then the central 98 %.
std::pair<double, double> shown_range(std::vector<double> const& sorted);

/// Where a density that is positive at `inside` ends on the way to `towards`: the abscissa; `towards` where it does not end.
double support_end(std::function<double(double)> const& density, double inside, double towards);

/// A kernel estimate of the density of draws at `points` equidistant places on [from, to], by normal kernels of width
///
///   h = 0.9 min(sd, (q75 - q25)/1.34) n^(-1/5)                      Silverman 1986, eq. 3.31
///
/// n: how many independent draws these are worth. Mass beyond `lower` and `upper`, outside which there can be none, is reflected
/// there. Empty where draws do not vary.
std::vector<double> kernel_density(std::vector<double> const& sorted, double n, double from, double to, int points, double lower,
                                   double upper);
/// h.
double kernel_width(std::vector<double> const& sorted, double n);

}  // namespace sysid

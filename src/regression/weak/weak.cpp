// Windows and integrals per record.
#include "regression/weak/weak.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "regression/column/signals.hpp"
#include "regression/column/smoothing.hpp"
#include "regression/weak/covariance.hpp"

namespace sysid::regression::weak {
namespace {

constexpr SettingRow rows[] = {
    {"half_width", SettingKind::integer, "0", 0, 1e6, "",
     "half-width of a window in samples; 0: a third of the fastest period, at least 10; shorter if otherwise too few windows are "
     "left"},
    {"step", SettingKind::integer, "0", 0, 1e6, "", "samples between windows; 0: a sixth of the half-width"},
    {"power", SettingKind::integer, "8", 4, 24, "", "exponent p of the test function (1 - s^2)^p"},
    {"reweightings", SettingKind::integer, "3", 0, 20, "",
     "how many times the covariance of the residuals is computed again with the estimated coefficients"},
};

constexpr int least_half_width = 10;
constexpr int shortest_half_width = 8;  // where the longer ones leave too few windows; below it there are no more windows

/// Samples between windows that overlap so far that nothing is lost, and not so far that their covariance is singular.
int stride_of(int half) { return std::max(1, (half + 3) / 6); }

/// What a smoothed derivative needs beside a window.
int smoother_half_of(int half, bool smoothed) { return smoothed ? std::max(4, half / 2) : 0; }

struct ProjectedEquation {
  Columns columns;
  std::vector<WeakBlock> blocks;
  std::vector<int> channels;  // that carry noise into it
  Concerns concerns;
};

class WeakProjection : public Projection {
 public:
  WeakProjection(Dictionary dictionary, std::span<Experiment const> experiments, Settings const& settings)
      : dictionary_(std::move(dictionary)),
        experiments_(experiments.begin(), experiments.end()),
        test_(static_cast<int>(settings.integer("power"))),
        noise_sd_(noise_of_channels(dictionary_, experiments_)),
        reweightings_(static_cast<int>(settings.integer("reweightings"))) {
    for (Equation const& equation : dictionary_.equations) project(equation, settings);
  }

  Columns const& columns(int equation) const override { return equations_[static_cast<std::size_t>(equation)].columns; }
  int reweightings() const override { return reweightings_; }
  ResidualSize residual_size() const override { return ResidualSize::one; }
  std::vector<double> const& noise_sd() const override { return noise_sd_; }
  int half_width() const override { return half_width_; }
  Concerns const& concerns(int equation) const override { return equations_[static_cast<std::size_t>(equation)].concerns; }

  Columns whitened(int equation, Eigen::VectorXd const& coefficients, double own) const override {
    return covariance(equation, coefficients).whitened(columns(equation), own);
  }
  double own_noise(int equation, Eigen::VectorXd const& coefficients) const override {
    return covariance(equation, coefficients).own_noise(columns(equation));
  }

 private:
  WeakCovariance covariance(int equation, Eigen::VectorXd const& coefficients) const {
    ProjectedEquation const& projected = equations_[static_cast<std::size_t>(equation)];
    return {projected.blocks, projected.channels, noise_sd_, coefficients};
  }

  int half_width(Experiment const& experiment, Settings const& settings, std::vector<int> const& channels, double step) const {
    if (settings.integer("half_width") > 0) return static_cast<int>(settings.integer("half_width"));
    double period = std::numeric_limits<double>::infinity();
    for (int const channel : channels)
      period = std::min(period, fastest_period(experiment.measured[static_cast<std::size_t>(channel)], step));
    double const third = period / (3 * step);
    double const most = static_cast<double>(experiment.time.size()) / 8;
    return std::max(least_half_width, static_cast<int>(std::round(std::min(third, most))));
  }

  /// Of each experiment; shorter where too few windows would be left for the terms, the longest first.
  std::vector<int> half_widths(Settings const& settings, std::vector<int> const& channels, bool smoothed, std::size_t terms) const {
    std::vector<int> halves;
    for (Experiment const& experiment : experiments_)
      halves.push_back(half_width(experiment, settings, channels, *uniform_step(experiment)));
    if (settings.integer("half_width") > 0 || settings.integer("step") > 0) return halves;
    std::vector<int> rows;
    for (Experiment const& experiment : experiments_) {
      int scored = 0;
      for (int i = 0; i < static_cast<int>(experiment.time.size()); ++i) scored += usable(experiment, channels, i) ? 1 : 0;
      rows.push_back(scored);
    }
    auto const windows = [&] {
      int sum = 0;
      for (std::size_t e = 0; e < halves.size(); ++e) {
        int const reach = halves[e] + smoother_half_of(halves[e], smoothed);
        sum += std::max(0, rows[e] - 2 * reach - 1) / stride_of(halves[e]) + (rows[e] > 2 * reach ? 1 : 0);
      }
      return sum;
    };
    while (windows() <= 2 * static_cast<int>(terms)) {
      auto const longest = std::max_element(halves.begin(), halves.end());
      if (*longest <= shortest_half_width) break;
      --*longest;
    }
    return halves;
  }

  void project(Equation const& equation, Settings const& settings) {
    ProjectedEquation& projected = equations_.emplace_back();
    std::vector<NodeId> roots = {equation.known};
    for (Term const& term : equation.terms) roots.push_back(term.expression);
    bool const readable = take_apart(roots, projected);
    for (Symbol const& symbol : symbols_below(dictionary_, roots))
      if (symbol.kind == Symbol::Kind::state)
        if (int const channel = base_channel(dictionary_, symbol.index, symbol.order);
            channel >= 0 && std::find(projected.channels.begin(), projected.channels.end(), channel) == projected.channels.end())
          projected.channels.push_back(channel);
    std::sort(projected.channels.begin(), projected.channels.end());
    Concerns const of_record = record_concerns(dictionary_, experiments_, projected.channels);
    projected.concerns.insert(projected.concerns.end(), of_record.begin(), of_record.end());
    if (!readable || any_fatal(projected.concerns)) return;

    Concern smoothed{.kind = Concern::Kind::smoothed};
    for (std::size_t j = 0; j < equation.terms.size(); ++j)
      if (std::any_of(pieces_[j + 1].begin(), pieces_[j + 1].end(), [](Piece const& piece) { return piece.smoothed; }))
        smoothed.terms.push_back(static_cast<int>(j));
    bool const known_smoothed =
        std::any_of(pieces_[0].begin(), pieces_[0].end(), [](Piece const& piece) { return piece.smoothed; });
    bool const any_smoothed = !smoothed.terms.empty() || known_smoothed;
    std::vector<int> const halves = half_widths(settings, projected.channels, any_smoothed, equation.terms.size());
    for (std::size_t e = 0; e < experiments_.size(); ++e) add_block(experiments_[e], settings, halves[e], any_smoothed, projected);
    if (!smoothed.terms.empty()) {
      for (int const term : smoothed.terms)
        smoothed.clause += (smoothed.clause.empty() ? "`" : ", `") + equation.terms[static_cast<std::size_t>(term)].name + "`";
      smoothed.clause = "a smoothed derivative is used in " + smoothed.clause + ", which cannot be integrated by parts";
      projected.concerns.push_back(std::move(smoothed));
    }
    stack(equation, projected);
  }

  /// pieces_ of the roots; false when a state is not measured.
  bool take_apart(std::vector<NodeId> const& roots, ProjectedEquation& projected) {
    pieces_.clear();
    for (Symbol const& symbol : symbols_below(dictionary_, roots))
      if (symbol.kind == Symbol::Kind::state && base_channel(dictionary_, symbol.index, symbol.order) < 0) {
        Concern concern{.kind = Concern::Kind::not_measured};
        concern.clause = fmt::format("no channel measures `{}`, or a quantity that gives it by differentiation",
                                     symbol_text(dictionary_, symbol.index, symbol.order));
        projected.concerns.push_back(std::move(concern));
      }
    if (any_fatal(projected.concerns)) return false;
    for (NodeId const root : roots) pieces_.push_back(*weak_pieces(dictionary_, root));
    return true;
  }

  void add_block(Experiment const& experiment, Settings const& settings, int half, bool smoothed, ProjectedEquation& projected) {
    Windows windows;
    windows.step = *uniform_step(experiment);
    windows.half = half;
    windows.smoother_half = smoother_half_of(half, smoothed);
    half_width_ = std::max(half_width_, windows.half);
    if (smoothed) choose_smoothers(experiment, projected.channels, windows);
    int const stride = settings.integer("step") > 0 ? static_cast<int>(settings.integer("step")) : stride_of(half);
    int const reach = windows.half + windows.smoother_half, count = static_cast<int>(experiment.time.size());
    // A window is lost when it touches a missing sample; rows kept aside are no loss.
    std::vector<int> const nothing;
    int last_aside = -1, last_gap = -1, seen = 0;
    for (int centre = reach; centre + reach < count; centre += stride) {
      for (; seen <= centre + reach; ++seen) {
        if (!usable(experiment, nothing, seen))
          last_aside = seen;
        else if (!usable(experiment, projected.channels, seen))
          last_gap = seen;
      }
      if (last_aside >= centre - reach) continue;
      ++windows_tried_;
      if (last_gap >= centre - reach)
        ++windows_lost_;
      else
        windows.centres.push_back(centre);
    }
    if (windows.centres.empty()) return;
    WeakIntegrals integrals(dictionary_, experiment, test_, std::move(windows));
    std::vector<Integrals> terms;
    Integrals known = integrals.of(pieces_[0]);
    for (std::size_t j = 1; j < pieces_.size(); ++j) terms.push_back(integrals.of(pieces_[j]));
    projected.blocks.push_back({std::move(integrals), std::move(known), std::move(terms)});
  }

  void choose_smoothers(Experiment const& experiment, std::vector<int> const& channels, Windows& windows) const {
    for (int const channel : channels) {
      auto const c = static_cast<std::size_t>(channel);
      int most = 0;
      for (Symbol const& symbol : dictionary_.symbols)
        if (symbol.kind == Symbol::Kind::state && base_channel(dictionary_, symbol.index, symbol.order) == channel)
          most = std::max(most, symbol.order - dictionary_.channels[c].order);
      Spectrum const record = spectrum_of(experiment.measured[c], 1);
      for (int derivative = 1; derivative <= most; ++derivative)
        windows.smoother_degree[{channel, derivative}] = smoother_degree(record, windows.smoother_half, derivative, noise_sd_[c]);
    }
  }

  void stack(Equation const& equation, ProjectedEquation& projected) {
    Eigen::Index count = 0;
    for (WeakBlock const& block : projected.blocks) count += block.known.rows.size();
    projected.columns.known.resize(count);
    projected.columns.terms.resize(count, static_cast<Eigen::Index>(equation.terms.size()));
    Eigen::Index first = 0;
    for (WeakBlock const& block : projected.blocks) {
      Eigen::Index const size = block.known.rows.size();
      projected.columns.known.segment(first, size) = block.known.rows;
      for (std::size_t j = 0; j < block.terms.size(); ++j)
        projected.columns.terms.col(static_cast<Eigen::Index>(j)).segment(first, size) = block.terms[j].rows;
      first += size;
    }
    if (windows_lost_ > 0) {
      double const share = static_cast<double>(windows_lost_) / windows_tried_;
      Concern concern{.kind = Concern::Kind::missing, .value = share};
      concern.clause = fmt::format("{:.3g} % of the windows contain a missing sample and are left out", 100 * share);
      projected.concerns.push_back(std::move(concern));
    }
    windows_lost_ = windows_tried_ = 0;
  }

  Dictionary dictionary_;
  std::vector<Experiment> experiments_;
  TestFunction test_;
  std::vector<double> noise_sd_;
  int reweightings_;
  int half_width_ = 0;
  int windows_tried_ = 0, windows_lost_ = 0;  // of the equation at hand
  std::vector<std::vector<Piece>> pieces_;    // of the equation at hand: known, then its terms
  std::vector<ProjectedEquation> equations_;
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings, int derivatives) {
  auto const half = settings.integer("half_width"), step = settings.integer("step");
  if (half > 0 && half < 4) return "half_width must be 0 or at least 4 samples";
  if (half > 0 && step > half) return "step must not be greater than half_width";
  if (settings.integer("power") <= derivatives)
    return fmt::format("power must be {} at least: the equation needs derivative {} of what is measured", derivatives + 1,
                       derivatives);
  return {};
}

std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings) {
  return std::make_unique<WeakProjection>(dictionary, experiments, settings);
}

}  // namespace sysid::regression::weak

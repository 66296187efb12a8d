// The probabilities of models between which chains have jumped.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/text/number.hpp"
#include "report/figure/drawing.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/named_bars.hpp"
#include "report/text/summary_text.hpp"
#include "result/selection.hpp"

namespace sysid {

namespace {

using namespace plot;

/// Rows of bars that a figure holds.
constexpr std::size_t shown_models = 24;

}  // namespace

Figure model_figure(SelectionReport const& selection) {
  std::vector<SelectedModel> const& models = selection.result.models;
  std::vector<std::size_t> order(models.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return models[a].probability > models[b].probability; });
  order.resize(std::min(order.size(), shown_models));
  NamedBars bars{"models", {}, "", {}};
  for (std::size_t const m : order)
    bars.bars.push_back({models[m].name, probability_text(models[m].probability), models[m].probability, m == order.front()});
  bars.x = axis(0, 1, 5);
  bars.x_label = axis_label("probability", "", bars.x);
  Figure out{bars.name, "Models by probability", "", script(bars)};
  out.caption = "The posterior probability of each model; the most probable one in colour.";
  if (models.size() > order.size()) out.caption += fmt::format(" Shown are {} of {} models.", order.size(), models.size());
  return out;
}

}  // namespace sysid

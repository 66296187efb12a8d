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

/// "law(" where all models are members of one family: its bars are then named by their arguments alone.
std::string family_of(std::vector<SelectedModel> const& models) {
  std::size_t const open = models.front().name.find('(');
  if (models.size() < 2 || open == std::string::npos) return {};
  std::string const family = models.front().name.substr(0, open + 1);
  bool const all = std::ranges::all_of(
      models, [&](SelectedModel const& each) { return each.name.starts_with(family) && each.name.ends_with(')'); });
  return all ? family : std::string();
}

/// "n = 2, m = 1" as "n 2, m 1".
std::string arguments_of(std::string const& name, std::string const& family) {
  std::string text = name.substr(family.size(), name.size() - family.size() - 1);
  for (std::size_t at; (at = text.find(" = ")) != std::string::npos;) text.replace(at, 3, " ");
  return text;
}

}  // namespace

Figure model_figure(SelectionReport const& selection) {
  std::vector<SelectedModel> const& models = selection.result.models;
  std::vector<std::size_t> order(models.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return models[a].probability > models[b].probability; });
  order.resize(std::min(order.size(), shown_models));
  NamedBars bars{"models", {}, "", {}};
  std::string const family = family_of(models);
  for (std::size_t const m : order)
    bars.bars.push_back({family.empty() ? models[m].name : arguments_of(models[m].name, family),
                         probability_text(models[m].probability), models[m].probability, m == order.front()});
  bars.x = axis(0, 1, 5);
  bars.x_label = axis_label("probability", "", bars.x);
  Figure out{bars.name, "Models by probability", "", script(bars)};
  out.caption = "The posterior probability of each model; the most probable one in colour.";
  if (!family.empty()) out.caption += fmt::format(" The names are the arguments of {}.", family.substr(0, family.size() - 1));
  if (models.size() > order.size()) out.caption += fmt::format(" Shown are {} of {} models.", order.size(), models.size());
  return out;
}

}  // namespace sysid

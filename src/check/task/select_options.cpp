// A new option is a row here, a field of SelectTask, and its use in app/selection.
#include "check/task/select_options.hpp"

#include <fmt/format.h>

namespace sysid {
namespace {

std::string weights_text(SelectTask const& task) {
  std::string weights;
  for (std::size_t c = 0; c < task.distance.channels.size(); ++c)
    weights += fmt::format("{}{} = {}", c == 0 ? "" : ", ", task.distance.channels[c], task.distance.weights[c]);
  return "weights(" + weights + ")";
}

constexpr SelectOptionRow select_rows[] = {
    {.option = {"distance", "distance = rmse",
                "distance between simulated and measured samples: nmse, rmse or expressions of channels", "nmse rmse"},
     .call = false,
     .read = [](ast::Option const& option, SelectOptions& options) { options.distance.distance = &option; },
     .text = [](SelectTask const& task) { return "distance = " + task.distance.text; }},
    {.option = {"weights", "weights(displacement = 1)", "weights of the channels in the distance", {}},
     .call = true,
     .read = [](ast::Option const& option, SelectOptions& options) { options.distance.weights = &option; },
     .text = &weights_text},
};

}  // namespace

std::span<SelectOptionRow const> select_options() { return select_rows; }

SelectOptionRow const* find_select_option(ast::Option const& option) {
  if (option.input) return nullptr;
  std::string const key = key_of(option);
  for (SelectOptionRow const& row : select_rows)
    if (row.option.name == key && row.call == !option.key) return &row;
  return nullptr;
}

std::string select_options_text(SelectTask const& task) {
  std::string text;
  for (SelectOptionRow const& row : select_rows) text += (text.empty() ? "" : ", ") + row.text(task);
  return text;
}

}  // namespace sysid

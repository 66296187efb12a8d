// What only expressions at the prompt may call: statistics, which make one number of draws or samples, and channels along a record.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "repl/quantity.hpp"

namespace sysid::repl {

struct PromptFunction {
  std::string_view name, usage, summary;
};

/// What a statistic is asked of.
struct Asked {
  Quantity const& of;
  std::vector<double> values;  // of it, those that are finite; one at least
  Quantity const* other;       // its second argument, where it takes one
  ast::Call const& call;
  std::function<void(Span, std::string message, std::string help)> refuse;
};

struct StatisticRow : PromptFunction {
  std::size_t arguments;
  bool pure;                                     // a pure number, whatever it is asked of
  std::optional<double> (*value)(Asked const&);  // SI; nothing where it was refused
};

/// mean, sd, quantile, ...
std::span<StatisticRow const> statistics();
/// measured, predicted, residual: a channel to rows.
std::span<PromptFunction const> series_functions();
/// Both.
std::vector<PromptFunction> prompt_functions();

}  // namespace sysid::repl

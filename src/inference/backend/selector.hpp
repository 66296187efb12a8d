// Back ends that choose among models: a row of a table and one function from a SelectionTarget to a SelectionResult.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "likelihood/selection/selection_target.hpp"
#include "result/selection.hpp"
#include "search/run_context.hpp"

namespace sysid {

struct SelectorRow {
  std::string_view name;
  std::string_view summary;
  std::span<SettingRow const> settings;
  /// Why values that are each allowed do not go together; empty when they do.
  std::string (*refuse)(Settings const&);
  SelectionResult (*run)(SelectionTarget const&, Settings const&, RunContext&);
};

}  // namespace sysid

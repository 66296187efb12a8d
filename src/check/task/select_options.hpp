// The options that `select` alone has, one row each: how an option is written, read and written out again. Those that it shares
// with `fit` are read in tasks.cpp.
#pragma once
#include <span>
#include <string>

#include "check/task/distance.hpp"
#include "check/task/task_options.hpp"

namespace sysid {

/// What the options say, on the way to the task. The distance is checked once the channels of all candidates are known.
struct SelectOptions {
  OptionReader& reader;
  SelectTask& task;
  DistanceOptions distance = {};
};

struct SelectOptionRow {
  TaskOptionRow option;
  bool call;                                         // `name(...)`, not `name = ...`
  void (*read)(ast::Option const&, SelectOptions&);  // given once
  std::string (*text)(SelectTask const&);            // of a checked task, stated or default: as it would be written
};

std::span<SelectOptionRow const> select_options();
/// nullptr for an option of another kind, or none.
SelectOptionRow const* find_select_option(ast::Option const& option);
/// All of them, separated by commas.
std::string select_options_text(SelectTask const& task);

}  // namespace sysid

// Unknown functions as a table.
#include "report/file/function.hpp"

#include <fmt/format.h>

#include "report/file/csv.hpp"
#include "report/file/stored_files.hpp"
#include "result/function.hpp"

namespace sysid {

std::string function_csv(FunctionReport const& function) {
  std::string out =
      fmt::format("# format = {}\n# {} [{}] of", stored_form, function.name, function.unit.empty() ? "-" : function.unit);
  for (auto const& [name, unit] : function.inputs) out += fmt::format(" {} [{}]", name, unit.empty() ? "-" : unit);
  out += '\n';
  for (auto const& input : function.inputs) out += csv_field(input.first) + ',';
  out += "mean,sd,q5,q95\n";
  for (FunctionPoint const& point : function.grid) {
    for (double const input : point.inputs) out += fmt::format("{},", input);
    out += fmt::format("{},{},{},{}\n", point.mean, point.sd, point.q5, point.q95);
  }
  return out;
}

}  // namespace sysid

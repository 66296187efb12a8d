// All kernels of the language, in the order in which they are listed. A new one is a file and a line of list.hpp.
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {

std::span<KernelRow const> kernels() {
#define CALL_ROW(name) name##_kernel(),
  static KernelRow const rows[] = {SYSID_KERNELS(CALL_ROW)};
#undef CALL_ROW
  return rows;
}

KernelRow const* find_kernel(std::string_view name) {
  for (KernelRow const& row : kernels())
    if (row.name == name) return &row;
  return nullptr;
}

int hyper_parameter_count(KernelRow const& row, int inputs) {
  int count = 0;
  for (HyperParameterRow const& one : row.hyper_parameters) count += one.per_input ? inputs : 1;
  return count;
}

}  // namespace sysid::gaussian_process

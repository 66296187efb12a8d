// The memory that large work needs, compared with what there is before the work begins.
#pragma once
#include <string>

namespace sysid {

/// Bytes that this process may still take: what the machine has free, within the limits of the process and of its control group.
/// Infinite where nothing of it can be found out.
double free_memory();

/// "3.2 GB", "850 kB".
std::string format_bytes(double bytes);

/// UserError (E5003) where more is needed than there is. what: "reading `bench.csv`"; help: what to change.
void require_memory(std::string const& what, double bytes, std::string const& help);

/// Of each vector of parameters: the product. UserError (E5003) where it is beyond what rows of lanes are counted by.
int recorded_numbers(int samples, int quantities);

}  // namespace sysid

// What holds for the pages of every run: each keeps the rules of a page and can be made again from its folder, byte for byte.
#pragma once
#include <filesystem>
#include <string>

namespace sysid::test {

/// A line for each page of a run's folder (made without pictures) that breaks a rule or comes back otherwise: as HTML, as
/// scripts of its figures, or as the page of the whole run; "" when none does. The folder is left as it was.
std::string broken_promises(std::filesystem::path const& run);

}  // namespace sysid::test

// The help that differs between the command line and the prompt.
#include "core/text/surface.hpp"

#include <fmt/format.h>

namespace sysid {
namespace {

constexpr std::string_view other_name_or_start = "give the task another name, or start the prompt with --force or another -o";

}  // namespace

std::string_view to_resume(Surface surface) { return surface == Surface::prompt ? "`resume`" : "--resume"; }

Help run_again(std::string_view why) {
  return {fmt::format("{}run the task again with --force", why),
          fmt::format("{}give the task another name, or start the prompt with --force", why)};
}

Help replace_results() { return {"add --force to replace them, or -o DIR to write elsewhere", std::string(other_name_or_start)}; }

Help resume_or_replace() { return {"continue with --resume, or start again with --force", std::string(other_name_or_start)}; }

}  // namespace sysid

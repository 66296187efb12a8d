// What an export cannot do, in words without a place in the text.
#pragma once
#include <string>

#include "core/text/diagnostic.hpp"

namespace sysid {

inline UserError refused(std::string message, std::string help) {
  return UserError({Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)});
}

}  // namespace sysid

// The tables of back ends: those that fit, and those that choose among models.
#pragma once
#include <span>
#include <string_view>

#include "inference/backend/backend.hpp"
#include "inference/backend/selector.hpp"

namespace sysid {

std::span<BackendRow const> backends();
BackendRow const* find_backend(std::string_view name);

std::span<SelectorRow const> selectors();
SelectorRow const* find_selector(std::string_view name);

}  // namespace sysid

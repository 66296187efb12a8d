// Whether these tests were built with sanitizers (the preset `sanitize`): their shadow memory exceeds any limit of the address space
// that one could set, and what they watch over takes several times as long.
#pragma once

namespace sysid::testing {

#ifdef SYSID_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
/// For limits of time that are meant to tell seconds from minutes.
inline constexpr double slower = sanitized ? 10 : 1;

}  // namespace sysid::testing

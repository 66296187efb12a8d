// A name for what a message tells the user to add.
#pragma once
#include <cctype>
#include <functional>
#include <string>

namespace sysid {

/// The wanted name, with `_` for what cannot be part of one, made of names, whose letters may take several bytes; where that is
/// taken, the first of it with `_2`, `_3`, ... that is not.
inline std::string free_name(std::string wanted, std::function<bool(std::string const& name)> const& taken) {
  for (char& each : wanted)
    if (static_cast<unsigned char>(each) < 0x80 && std::isalnum(static_cast<unsigned char>(each)) == 0) each = '_';
  std::string name = wanted;
  for (int number = 2; taken && taken(name); ++number) name = wanted + "_" + std::to_string(number);
  return name;
}

}  // namespace sysid

// The table of operations.
#include "program/bytecode/code.hpp"

namespace sysid {

Capability const& capability(Opcode opcode) {
  static constexpr Capability table[] = {
      // in the order of Opcode
      {"move", 1, true, false},         {"negate", 1, true, false},        {"add", 2, true, true},
      {"subtract", 2, true, false},     {"multiply", 2, true, true},       {"divide", 2, true, false},
      {"fused", 3, true, true},         {"fused_subtract", 3, true, true}, {"fused_negate", 3, true, true},
      {"fused_both", 3, true, true},    {"square_root", 1, true, false},   {"absolute", 1, true, false},
      {"sign", 1, false, false},        {"minimum", 2, false, false},      {"maximum", 2, false, false},
      {"floor", 1, false, false},       {"less", 2, false, false},         {"less_equal", 2, false, false},
      {"equal", 2, false, false},       {"conjunction", 2, false, false},  {"disjunction", 2, false, false},
      {"negation", 1, false, false},    {"select", 3, false, false},       {"call_unary", 1, false, false},
      {"call_binary", 2, false, false},
  };
  return table[static_cast<int>(opcode)];
}

}  // namespace sysid

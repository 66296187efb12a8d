// Registers and uniforms are numbered within banks until all sections are known.
#pragma once
#include <cstdint>

#include "program/simulation_program.hpp"

namespace sysid {

/// The upper byte of an index; the rest is the position in the bank.
enum Bank : std::uint32_t {
  parameter_bank = 0u << 24,
  hoisted_bank = 1u << 24,
  state_bank = 2u << 24,
  accumulator_bank = 3u << 24,
  record_bank = 4u << 24,
  sum_bank = 5u << 24,
  temporary_bank = 6u << 24,
  constant_bank = 7u << 24,
  row_bank = 8u << 24,
  control_bank = 9u << 24,
  adjoint_bank = 10u << 24,
  slope_bank = 11u << 24,
};

/// Gives the instructions of all sections their places in the register file and the uniforms, whose row has `widest_row` values at
/// most, and links them. The layout's sizes and the constants are complete.
void number_registers(SimulationProgram& program, int widest_row);

}  // namespace sysid

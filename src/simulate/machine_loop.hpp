// Loops of a program as the compiler of machine code takes them.
#pragma once
#include "native/machine_code.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"
#include "solver/solver.hpp"

namespace sysid {

native::LoopName machine_loop_name(SolverSettings const& solver, Executor executor, native::LoopKind kind);

/// The machine code of one of the program's loops for blocks of executor.width lanes, compiled where it has not been; null where
/// the executor is another one, or where there is no machine code to be had. With a solver that is no fixed step of the program the
/// loop over samples observes alone.
native::Function machine_loop(SimulationProgram const& program, SolverSettings const& solver, Executor executor,
                              native::LoopKind kind);

/// The values that a step takes from its length, for one vector of lanes: blocks of any width take the same code.
native::LoopName length_loop_name();
native::Function length_loop(SimulationProgram const& program);
int lanes_of_length_loop();

/// Seconds that compiling that loop takes, with an adjoint both loops, roughly, once the compiler has been loaded.
double compilation_time(SimulationProgram const& program, Executor executor);
double length_compilation_time(SimulationProgram const& program);
/// The widest block that suits the program: vectors side by side hide latencies, unless they no longer fit the processor.
int most_native_lanes(SimulationProgram const& program);
/// How many times as fast as interpretation in lanes an executor is, roughly: to share the work out.
double speed(Executor executor);
/// Seconds that interpreting takes, roughly: so many instructions in each of so many lanes.
double interpretation_time(double instructions, int lanes, Executor executor);

}  // namespace sysid

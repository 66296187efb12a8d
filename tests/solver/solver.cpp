// Solvers as values: text, refinement, settings there and back.
#include "solver/solver.hpp"

#include <doctest/doctest.h>

#include <set>

#include "core/text/diagnostic.hpp"
#include "relative.hpp"

using namespace sysid;

TEST_CASE("every solver of the table makes settings that read back as they were") {
  for (SolverRow const& row : solvers()) {
    CAPTURE(row.name);
    SolverSettings const usual = make_solver(row, Settings(row.settings));
    CHECK(&usual.row() == &row);
    CHECK(usual == SolverSettings{.method = std::string(row.name)});  // the defaults stand in one place only
    SolverSettings const finer = usual.finer();
    CHECK((finer == usual) == row.exact);
    CHECK(make_solver(row, finer.settings()) == finer);
  }
  CHECK(find_solver("magic") == nullptr);
  CHECK_THROWS_AS(SolverSettings{.method = "magic"}.row(), InternalError);
}

TEST_CASE("a row of the table says what its method can do, and has what that needs") {
  std::set<std::string_view> names;
  std::set<Stepping> steppings;
  for (SolverRow const& row : solvers()) {
    CAPTURE(row.name);
    CHECK(names.insert(row.name).second);
    steppings.insert(row.stepping);
    CHECK(!row.summary.empty());
    CHECK((row.step != nullptr) == (row.stepping == Stepping::fixed));
    CHECK((row.embedded != nullptr) == (row.stepping == Stepping::lanes));
    CHECK(row.in_program == (row.step != nullptr || row.embedded != nullptr));
    CHECK(row.adaptive == (row.step == nullptr));
    CHECK((row.order > 0) == (row.in_program && !row.exact));
    CHECK((!row.exact || row.step != nullptr));
    if (row.embedded != nullptr) CHECK(row.embedded().order == row.order);
    CHECK((!row.implicit || row.stiff));
    CHECK((find_setting(row.settings, "substeps") != nullptr) == (!row.adaptive && !row.exact));
    CHECK((find_setting(row.settings, "relative") != nullptr) == row.adaptive);
  }
  CHECK(steppings == std::set{Stepping::fixed, Stepping::lanes, Stepping::cvode, Stepping::ida});
}

TEST_CASE("solvers that are chosen by what they can do") {
  CHECK(adaptive_solver().name == "dopri5");
  CHECK(stiff_solver().name == "cvode");
  CHECK(implicit_solver().name == "ida");
  CHECK(exact_solver().name == "exponential");
}

TEST_CASE("a solver is spelt as a task states it") {
  CHECK(SolverSettings{.substeps = 8}.text() == "rk4(substeps = 8)");
  CHECK(SolverSettings{.substeps = 8}.option() == "substeps = 8");
  CHECK(SolverSettings{.method = "heun", .substeps = 8}.option() == "solver = heun(substeps = 8)");
  CHECK(SolverSettings{.method = "heun"}.option() == "solver = heun");
  CHECK(SolverSettings{.method = "exponential"}.text() == "exponential");
  CHECK(SolverSettings{.method = "exponential"}.option() == "solver = exponential");
}

TEST_CASE("a solver that is part of the model says so, and no finer one does") {
  SolverSettings const declared{.substeps = 2, .as_model = true};
  CHECK(declared.text() == "rk4(substeps = 2, as_model = yes)");
  CHECK(declared.option() == "solver = rk4(substeps = 2, as_model = yes)");
  CHECK(make_solver(declared.row(), declared.settings()) == declared);
  CHECK(declared.finer() == SolverSettings{.substeps = 4});
}

TEST_CASE("no solver is advised that is in use already") {
  for (SolverRow const& row : solvers()) {
    std::string const others = SolverSettings{.method = std::string(row.name)}.other_methods();
    CAPTURE(row.name);
    CHECK(others.find("= " + std::string(row.name) + "`") == std::string::npos);
    CHECK(others.empty() == row.stiff);
  }
}

TEST_CASE("the finest solvers that a task may state") {
  CHECK(SolverSettings{.substeps = 10000}.within_limits());
  CHECK_FALSE(SolverSettings{.substeps = 10000}.finer().within_limits());
  SolverSettings const tight{.method = "cvode", .relative = 1e-13};
  CHECK(tight.within_limits());
  CHECK_FALSE(tight.finer().within_limits());
}

TEST_CASE("a refined tolerance is the number that a person would write") {
  SolverSettings const loose{.method = "cvode", .relative = 1e-5};
  CHECK(loose.finer().relative == 1e-7);
  CHECK(loose.finer().option() == "solver = cvode(relative = 1e-07)");
  CHECK(loose.finer().finer().relative == 1e-9);
}

TEST_CASE("the error allowed near zero follows the size a state has reached, down to 1e-120 of its unit") {
  SolverSettings const solver{.relative = 1e-6};
  CHECK(solver.near_zero(2.0) == relative(2e-9, 1e-14));
  CHECK(solver.near_zero(0.0) == relative(1e-129, 1e-14));
  CHECK(SolverSettings{.relative = 1e-6, .absolute = 1e-3}.near_zero(2.0) == 1e-3);
}

// The ledger: failures are counted by class and place, the first example of each is kept.
#include "core/system/ledger.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("failures of one class and place are counted together and keep their first example") {
  Ledger ledger;
  ledger.add_solves(10);
  ledger.add_failure(FailureClass::non_finite, "k3*y^3", 0.5, {1, 2});
  ledger.add_failure(FailureClass::non_finite, "k3*y^3", 0.1, {3, 4}, 2);
  ledger.add_failure(FailureClass::convergence, "k3*y^3", 0.2, {5, 6});
  REQUIRE(ledger.failures().size() == 2);
  CHECK(ledger.failures()[0].count == 3);
  CHECK(ledger.failures()[0].time == 0.5);
  CHECK(ledger.failures()[0].example == std::vector<double>{1, 2});
  CHECK(ledger.failed() == 4);
  CHECK(ledger.solves() == 10);
}

TEST_CASE("merging ledgers adds their counts and keeps the order of first sight") {
  Ledger a, b;
  a.add_solves(3);
  a.add_failure(FailureClass::step_limit, "solver", 1.0, {1});
  b.add_solves(4);
  b.add_failure(FailureClass::convergence, "sqrt(k)", 2.0, {2}, 1, {"k"});
  b.add_failure(FailureClass::step_limit, "solver", 3.0, {3}, 5);
  a.merge(b);
  CHECK(a.solves() == 7);
  REQUIRE(a.failures().size() == 2);
  CHECK(a.failures()[0].where == "solver");
  CHECK(a.failures()[0].count == 6);
  CHECK(a.failures()[0].time == 1.0);
  CHECK(a.failures()[1].where == "sqrt(k)");
  CHECK(a.failures()[1].names == std::vector<std::string>{"k"});
  a.merge(a);
  CHECK(a.failed() == 14);
}

TEST_CASE("a failure that never happened leaves no trace") {
  Ledger ledger;
  ledger.add_failure(FailureClass::convergence, "log(c)", 0, {}, 0);
  CHECK(ledger.failures().empty());
}

TEST_CASE("every failure class has a name") {
  CHECK(name(FailureClass::non_finite) == "non-finite");
  CHECK(name(FailureClass::step_limit) == "step limit");
  CHECK(name(FailureClass::convergence) == "no convergence");
}

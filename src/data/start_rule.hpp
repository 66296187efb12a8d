// Where the simulation of a record begins.
#pragma once
#include <string>

namespace sysid {

/// Where a simulation begins and in which state; which rows are scored, a split says.
struct StartRule {
  enum class Kind {
    record,     // at the record's first row, in the model's initial values
    rest,       // at the first scored row, in the model's initial values
    estimated,  // at the first scored row; the state there is fitted to the first `rows` rows, which are then not scored
  };
  Kind kind = Kind::record;
  int rows = 0;
};

/// "rest", "estimated(rows = 50)".
std::string start_text(StartRule start);

}  // namespace sysid

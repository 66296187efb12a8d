// One phrase for each kind of start.
#include "data/start_rule.hpp"

#include <fmt/format.h>

namespace sysid {

std::string start_text(StartRule start) {
  switch (start.kind) {
    case StartRule::Kind::record:
      return "record";
    case StartRule::Kind::rest:
      return "rest";
    case StartRule::Kind::estimated:
      return fmt::format("estimated(rows = {})", start.rows);
  }
  return "?";
}

}  // namespace sysid

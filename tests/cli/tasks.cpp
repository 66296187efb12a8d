// Tasks that are stopped, as whoever supervises them sees it.
#include <doctest/doctest.h>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("a stop before the first draw is said, also where progress and notices are not") {
  LineDesk const desk;
  Said const said = desk.ask("fit line.sysid --no-figures --quiet --interrupt-after 1");
  CHECK(said.exit == 75);
  CHECK(said.text == "sysid: interrupted; --resume continues from there\n");
  CHECK(desk.ask("fit line.sysid --no-figures --quiet --resume").exit <= 1);
}

TEST_CASE("a request that comes while the file is read stops the run as any other does") {
  LineDesk const desk;
  // A pipe in the place of the file: it is opened for writing once the program reads it.
  desk.save("stop.sh", "mkfifo slow.sysid\n'" SYSID_PROGRAM
                       "' fit slow.sysid --no-figures --quiet &\n"
                       "exec 3> slow.sysid\nkill -TERM $!\nsleep 0.1\ncat line.sysid >&3\nexec 3>&-\nwait $!\n");
  Said const said = said_by("cd '" + desk.path(".").string() + "' && timeout 20 sh stop.sh");
  CHECK(said.exit == 75);
  CHECK(said.text.find("sysid: interrupted") != std::string::npos);
}

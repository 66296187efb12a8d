// What the dynamic linker opens when the program starts.
#include <doctest/doctest.h>

#include "cli/asked.hpp"
#include "sanitized.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("no library is taken from the folder in which the user is") {
  Desk const desk;
  for (char const* const name : {"libfmt.so.9", "libz.so.1", "sysid_native.so", "sysid_records.so"}) desk.save(name, "no library");
  Said const said = desk.ask("--version");
  CHECK_MESSAGE(said.exit == 0, said.text);
}

TEST_CASE("the libraries of NetCDF and MATLAB files are opened when such a file is read or written, and not before") {
  if (sanitized) return;  // the sanitizer opens modules in the program's place
  Desk const desk;
  std::string const opened = "2>&1 | grep -c 'calling init.*\\(netcdf\\|matio\\|hdf5\\)'";
  auto const asked = [&](std::string const& what) {
    return said_by("cd '" + desk.path(".").string() + "' && LD_DEBUG=files '" SYSID_PROGRAM "' " + what + " " + opened).text;
  };
  desk.save("bench.csv", "t,u\n0,1\n1,2\n2,3\n");
  CHECK(asked("data bench.csv") == "0\n");
  desk.save("bench.nc", "CDF\1 and nothing that follows from it");
  CHECK(asked("data bench.nc") != "0\n");
}

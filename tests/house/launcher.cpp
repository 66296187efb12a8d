// What ./sysid and tests/run build with: a compiler that is not there stands in for one that takes its time.
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "said_by.hpp"
#include "temporary_folder.hpp"

namespace sysid::testing {
namespace {

/// A checkout with one source, and a `cmake` that tells what it is asked for.
class Checkout {
 public:
  Checkout() {
    for (char const* each : {"src", "bin"}) std::filesystem::create_directories(folder_.path() / each);
    std::ofstream(folder_.path() / "src" / "a.cpp") << "int a;\n";
    std::filesystem::path const cmake = folder_.path() / "bin" / "cmake";
    std::ofstream(cmake) << "#!/bin/sh\necho \"$@ $SYSID_BENCHMARKS\" >>asked\nexec sleep 0.05\n";
    std::filesystem::permissions(cmake, std::filesystem::perms::owner_all);
    // As if it were written before the first build.
    for (char const* each : {"src", "src/a.cpp"})
      std::filesystem::last_write_time(folder_.path() / each,
                                       std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  }

  /// What a build says; `asked` is for how much work.
  Said build(std::string const& target, std::string const& environment = "") {
    return said_by("cd '" + folder_.path().string() + "' && unset SYSID_BENCHMARKS && export PATH=$PWD/bin:$PATH " + environment +
                   " && bash -c '. \"" + SYSID_SOURCE_DIR "/.ci/prepare\" && missing_packages() { :; } && build . test " + target +
                   " src && flock -n build/test/.sysid-lock echo open'");
  }
  int asked() const {
    std::ifstream in(folder_.path() / "asked");
    int count = 0;
    for (std::string line; std::getline(in, line);) count += line.starts_with("--build");
    return count;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("after a build nothing holds its lock, or what it writes to") {
  Checkout checkout;
  auto const before = std::chrono::steady_clock::now();
  Said const said = checkout.build("all");
  CHECK(said.exit == 0);
  CHECK(said.text.ends_with("open\n"));
  CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(20));  // it tells how far it is each half minute
}

TEST_CASE("what was built is built again where something else is asked for") {
  Checkout checkout;
  checkout.build("all");
  checkout.build("all");
  CHECK(checkout.asked() == 1);
  checkout.build("all", "SYSID_BENCHMARKS=ON");
  CHECK(checkout.asked() == 2);
  checkout.build("all", "SYSID_BENCHMARKS=ON");
  CHECK(checkout.asked() == 2);
  checkout.build("all");
  CHECK(checkout.asked() == 3);
  checkout.build("some");
  CHECK(checkout.asked() == 4);
}

}  // namespace sysid::testing

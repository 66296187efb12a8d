// Random streams: known answers of Philox, independence of position from history, and moments of the variates.
#include "core/numeric/random.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

using namespace sysid;

TEST_CASE("the first words of key zero are Random123's known answer for philox4x64-10") {
  Stream stream({.seed = 0, .purpose = static_cast<Purpose>(0), .index = 0, .step = 0});
  CHECK(stream.bits() == 0x16554d9eca36314cULL);
  CHECK(stream.bits() == 0xdb20fe9d672d0fdcULL);
  CHECK(stream.bits() == 0xd7e772cee186176bULL);
  CHECK(stream.bits() == 0x7e68b68aec7ba23bULL);
}

TEST_CASE("a stream gives the same numbers whoever drew before") {
  StreamKey const key{.seed = 7, .purpose = Purpose::proposal, .index = 3, .step = 11};
  std::vector<double> first;
  Stream a(key);
  for (int i = 0; i < 9; ++i) first.push_back(a.normal());
  Stream other(key.with_index(4));
  other.uniform();
  Stream b(key);
  for (double const x : first) CHECK(b.normal() == x);
}

TEST_CASE("streams that differ in any part of the key differ") {
  StreamKey const key{.seed = 1, .purpose = Purpose::prior, .index = 2, .step = 3};
  std::set<std::uint64_t> words;
  for (StreamKey const& k : {key, StreamKey{2, Purpose::prior, 2, 3}, StreamKey{1, Purpose::accept, 2, 3}, key.with_index(3),
                             key.with_step(2), key.at(3, 2)})
    words.insert(Stream(k).bits());
  CHECK(words.size() == 6);
}

TEST_CASE("uniforms lie inside the open unit interval and fill it evenly") {
  Stream stream({.seed = 5, .purpose = Purpose::test, .index = 0, .step = 0});
  int const n = 100000;
  std::vector<int> cells(10);
  for (int i = 0; i < n; ++i) {
    double const u = stream.uniform();
    REQUIRE(u > 0);
    REQUIRE(u < 1);
    ++cells[static_cast<std::size_t>(10 * u)];
  }
  double chi_squared = 0;
  for (int const count : cells) chi_squared += (count - n / 10.0) * (count - n / 10.0) / (n / 10.0);
  CHECK(chi_squared < 27.9);  // the 0.999 quantile of chi-squared with 9 degrees of freedom
}

TEST_CASE("normals have mean 0, variance 1 and kurtosis 3") {
  Stream stream({.seed = 6, .purpose = Purpose::test, .index = 0, .step = 0});
  int const n = 200000;
  double sum = 0, squares = 0, fourth = 0;
  for (int i = 0; i < n; ++i) {
    double const z = stream.normal();
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
  }
  // Four standard errors: sd of z is 1, of z^2 sqrt(2), of z^4 sqrt(96).
  CHECK(std::abs(sum / n) < 4 / std::sqrt(n));
  CHECK(std::abs(squares / n - 1) < 4 * std::sqrt(2.0 / n));
  CHECK(std::abs(fourth / n - 3) < 4 * std::sqrt(96.0 / n));
}

TEST_CASE("below(n) draws each of n values equally often") {
  Stream stream({.seed = 8, .purpose = Purpose::test, .index = 0, .step = 0});
  std::vector<int> counts(7);
  int const draws = 70000;
  for (int i = 0; i < draws; ++i) ++counts[stream.below(7)];
  for (int const count : counts) CHECK(std::abs(count - draws / 7) < 4 * std::sqrt(draws / 7.0));
  CHECK(stream.below(1) == 0);
}

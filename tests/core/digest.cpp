// SHA-256 against the vectors NIST publishes for FIPS 180-4.
#include "core/system/digest.hpp"

#include <doctest/doctest.h>

#include <string>

using sysid::sha256;

TEST_CASE("sha256 gives the published digests") {
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(
      sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu") ==
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  CHECK(sha256(std::string(1000000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("sha256 is the same with and without the processor's instructions for it") {
  std::string bytes;
  for (int i = 0; i < 400; ++i) {
    CHECK(sha256(bytes) == sha256(bytes, true));
    bytes += static_cast<char>(i * 37 + i / 7);
  }
}

TEST_CASE("sha256 reads bytes above 127") {
  // The one-byte message of NIST's SHA256ShortMsg vectors (Len = 8).
  CHECK(sha256("\xd3") == "28969cdfa74a12c82f3bad960b0b000aca2ac329deea5c2328ebc6f2ba9802c1");
}

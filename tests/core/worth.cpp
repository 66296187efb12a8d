// When ranks divide a batch: by what exchanges have taken.
#include <doctest/doctest.h>

#include "core/ranks/worth.hpp"

using sysid::ranks::Worth;

TEST_CASE("a batch is divided where that saves more than the exchange takes") {
  Worth worth(1e-5, 1e9, false);
  CHECK(worth.worth(3e-5, 0));
  CHECK_FALSE(worth.worth(1e-5, 0));
  CHECK_FALSE(worth.worth(3e-5, 1e6));  // a millisecond of bytes
  CHECK_FALSE(worth.perhaps(1e-5));
}

TEST_CASE("where ranks outnumber processors an exchange is expected to be slow, until it has been quick") {
  Worth worth(1e-5, 1e9, true);
  CHECK_FALSE(worth.worth(1e-4, 0));
  for (int k = 0; k < 60; ++k) worth.learn(1e-5, 0);
  CHECK(worth.worth(1e-4, 0));
}

TEST_CASE("exchanges that are slower than measured are soon given up, and cost little from then on") {
  Worth worth(1e-5, 1e9, false);
  double lost = 0, saved = 0;
  for (int k = 0; k < 100'000; ++k) {
    double const seconds = 1e-4;
    if (!worth.worth(seconds, 0)) continue;
    worth.learn(1e-2, 0);
    lost += 1e-2;
    saved += seconds;
  }
  CHECK(lost < 0.5);  // of 10 s of work; dividing all of it would take 1000 s
  CHECK(saved > 0);
  // Once they are quick again, it finds out.
  int divided = 0;
  for (int k = 0; k < 100'000; ++k)
    if (worth.worth(1e-4, 0)) {
      worth.learn(1e-5, 0);
      ++divided;
    }
  CHECK(divided > 50'000);
}

TEST_CASE("one slow exchange does not end the division of large batches") {
  Worth worth(1e-5, 1e9, false);
  worth.learn(10, 0);
  CHECK(worth.worth(1e-3, 0));
}

TEST_CASE("the time of the bytes is not that of the exchange") {
  Worth worth(1e-5, 1e6, false);
  for (int k = 0; k < 50; ++k) worth.learn(1 + 1e-5, 1e6);
  CHECK(worth.exchange() < 1.1e-5);
}

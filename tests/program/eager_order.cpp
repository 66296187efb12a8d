// The order of code that holds many values: complete, operands first, and what ends a value's use at once.
#include "program/eager_order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "core/numeric/random.hpp"

using namespace sysid;

TEST_CASE("a reader that ends a value's use comes at once") {
  // 0 and 1 are read by 4 and 5 alone; 2 and 3 have further readers.
  std::vector<std::vector<std::size_t>> const operands = {{}, {}, {}, {}, {0, 2}, {1, 2}, {2, 3}, {4, 5, 6}};
  std::vector<bool> kept(8);
  kept[7] = true;
  CHECK(eager_order(operands, kept) == std::vector<std::size_t>{0, 1, 2, 5, 4, 3, 6, 7});
  // What is wanted at the end is held in any case: only 3, which 6 alone reads, ends with its reader.
  kept[0] = kept[1] = true;
  CHECK(eager_order(operands, kept) == std::vector<std::size_t>{0, 1, 2, 3, 6, 4, 5, 7});
}

TEST_CASE("each operation comes once, behind its operands") {
  for (std::uint64_t index = 0; index < 50; ++index) {
    Stream stream({.seed = 6, .purpose = Purpose::test, .index = index, .step = 0});
    std::vector<std::vector<std::size_t>> operands(60);
    std::vector<bool> kept(operands.size());
    for (std::size_t i = 1; i < operands.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        std::size_t const operand = stream.below(i);
        if (std::ranges::find(operands[i], operand) == operands[i].end()) operands[i].push_back(operand);
      }
      kept[i] = stream.below(8) == 0;
    }
    std::vector<std::size_t> const order = eager_order(operands, kept);
    REQUIRE(order.size() == operands.size());
    std::vector<bool> done(operands.size());
    for (std::size_t const i : order) {
      CHECK_FALSE(done[i]);
      for (std::size_t const operand : operands[i]) CHECK(done[operand]);
      done[i] = true;
    }
  }
}

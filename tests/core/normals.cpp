// Normal numbers in lanes against one stream after another.
#include "core/numeric/normals.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace sysid;

TEST_CASE("normal numbers of many streams are those of each, bit for bit, for any number of rows and lanes") {
  for (int const width : {1, 7, 8, 61})
    for (int const rows : {0, 1, 2, 5, 6, 31}) {
      CAPTURE(width);
      CAPTURE(rows);
      std::vector<Stream> together, alone;
      for (int w = 0; w < width; ++w) {
        StreamKey const key{.seed = 3, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 9};
        together.emplace_back(key);
        alone.emplace_back(key);
        // What was drawn before, however much, shifts a stream and not its neighbours.
        for (int i = 0; i < w % 3; ++i) {
          together.back().uniform();
          alone.back().uniform();
        }
      }
      LaneArray out(rows, width);
      draw_normals(together, out);
      for (int w = 0; w < width; ++w)
        for (int r = 0; r < rows; ++r) CHECK(out(r, w) == alone[static_cast<std::size_t>(w)].normal());
      // Pairs are drawn whole: behind an even number of them both stand at the same place.
      if (rows % 2 == 0)
        for (std::size_t w = 0; w < together.size(); ++w) CHECK(together[w].bits() == alone[w].bits());
    }
}

// Standard normal numbers of many streams at once: elementary functions in lanes make them several times cheaper than one by one.
#pragma once
#include <span>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"

namespace sysid {

/// Row by row what `normal()` of each stream would give, bit for bit; out: [N x streams]. The streams must not have drawn a normal
/// number before; of an odd N the second number of the last pair is lost.
void draw_normals(std::span<Stream> streams, Lanes out);

}  // namespace sysid

// SHA-256 by x86 instructions, which do two rounds each (compiled for them, see CMakeLists.txt). They hold the working variables as
// a, b, e, f and c, d, g, h.                    Gulley et al. 2013, "Intel SHA Extensions"
#include "core/system/digest_sha.hpp"

#include <immintrin.h>

namespace sysid {
namespace {

__m128i words_at(void const* from) { return _mm_loadu_si128(static_cast<__m128i const*>(from)); }

}  // namespace

void add_blocks_by_instructions(std::uint32_t* state, std::uint32_t const* constants, unsigned char const* data,
                                std::size_t blocks) {
  __m128i const big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  __m128i const cdab = _mm_shuffle_epi32(words_at(state), 0xb1), efgh = _mm_shuffle_epi32(words_at(state + 4), 0x1b);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8), cdgh = _mm_blend_epi16(efgh, cdab, 0xf0);
  for (; blocks > 0; --blocks, data += 64) {
    __m128i const abef_before = abef, cdgh_before = cdgh;
    __m128i w[4];  // the schedule's last 16 words, each four of them replaced in their turn
    for (int i = 0; i < 4; ++i) w[i] = _mm_shuffle_epi8(words_at(data + 16 * i), big_endian);
#pragma GCC unroll 16
    for (int i = 0; i < 16; ++i) {
      __m128i const now = w[i & 3], sum = _mm_add_epi32(now, words_at(constants + 4 * i));
      __m128i &next = w[(i + 1) & 3], &last = w[(i + 3) & 3];
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      if (i >= 3 && i < 15) next = _mm_sha256msg2_epu32(_mm_add_epi32(next, _mm_alignr_epi8(now, last, 4)), now);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0e));
      if (i >= 1 && i < 13) last = _mm_sha256msg1_epu32(last, now);
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  __m128i const feba = _mm_shuffle_epi32(abef, 0x1b), dchg = _mm_shuffle_epi32(cdgh, 0xb1);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state), _mm_blend_epi16(feba, dchg, 0xf0));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state + 4), _mm_alignr_epi8(dchg, feba, 8));
}

}  // namespace sysid

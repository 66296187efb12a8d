// Inflates piece by piece.
#include "data/table/gzip.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "core/system/interrupt.hpp"
#include "core/system/memory.hpp"
#include "data/table/file_errors.hpp"

namespace sysid {
namespace {

struct Inflation {
  z_stream stream{};
  bool good;
  Inflation() : good(inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK) {}
  ~Inflation() {
    if (good) inflateEnd(&stream);
  }
  Inflation(Inflation const&) = delete;
};

/// Tapes and some loggers fill a file up to whole blocks.
bool only_zeros(z_stream const& stream, std::string_view not_given) {
  std::string_view const left(reinterpret_cast<char const*>(stream.next_in), stream.avail_in);
  return left.find_first_not_of('\0') == std::string_view::npos && not_given.find_first_not_of('\0') == std::string_view::npos;
}

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string gunzip(std::string const& name, std::string_view bytes) {
  constexpr std::size_t piece = 1U << 20U;
  constexpr std::size_t large = 100U << 20U;  // of less nobody runs out of memory
  constexpr double memory_per_byte = 3;       // of its text: as read, where its cells begin, its numbers
  Inflation inflation;
  if (!inflation.good) throw InternalError("zlib cannot begin");
  z_stream& stream = inflation.stream;
  std::string out;
  std::size_t asked = large, given = 0;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  for (;;) {
    stop_if_interrupted();
    if (out.size() > asked) {
      asked = out.size() * 2;
      require_memory(fmt::format("reading `{}`", name), memory_per_byte * static_cast<double>(asked),
                     "cut the record, or remove columns that are not used");
    }
    std::size_t const before = out.size();
    out.resize(before + piece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = piece;
    if (stream.avail_in == 0) {
      auto const more = static_cast<uInt>(std::min<std::size_t>(bytes.size() - given, 1U << 30U));
      stream.avail_in = more;
      given += more;
    }
    int const state = inflate(&stream, Z_NO_FLUSH);
    out.resize(before + piece - stream.avail_out);
    bool const at_end = stream.avail_in == 0 && given == bytes.size();
    if (state == Z_STREAM_END) {
      if (at_end || only_zeros(stream, bytes.substr(given))) return out;
      if (inflateReset(&stream) == Z_OK) continue;
    }
    if (state != Z_OK || (at_end && stream.avail_out > 0)) throw UserError(data_errors::damaged(name, "gzip file", std::nullopt));
  }
}

}  // namespace sysid

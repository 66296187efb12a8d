// Walks the elements as "MAT-File Format" of MathWorks describes them; compressed ones are inflated in pieces and not kept.
#include "data/format/matlab_elements.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace sysid {
namespace {

constexpr std::size_t header_size = 128, tag_size = 8;
constexpr std::uint32_t matrix_type = 14, compressed_type = 15;
constexpr int most_nested = 64;  // arrays in arrays

/// Bytes one after the other.
class Source {
 public:
  virtual ~Source() = default;
  virtual bool read(char* to, std::size_t count) = 0;
  virtual bool skip(std::size_t count) = 0;
};

class PlainSource final : public Source {
 public:
  explicit PlainSource(std::string_view bytes) : bytes_(bytes) {}
  bool read(char* to, std::size_t count) override {
    if (count > bytes_.size()) return false;
    std::memcpy(to, bytes_.data(), count);
    return skip(count);
  }
  bool skip(std::size_t count) override {
    if (count > bytes_.size()) return false;
    bytes_.remove_prefix(count);
    return true;
  }

 private:
  std::string_view bytes_;
};

class InflatedSource final : public Source {
 public:
  explicit InflatedSource(std::string_view bytes) : good_(inflateInit(&stream_) == Z_OK) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());  // lengths in a file have 32 bits
  }
  ~InflatedSource() override { inflateEnd(&stream_); }
  InflatedSource(InflatedSource const&) = delete;

  bool read(char* to, std::size_t count) override {
    while (good_ && count > 0) {
      auto const piece = static_cast<uInt>(std::min<std::size_t>(count, 1U << 30U));
      stream_.next_out = reinterpret_cast<Bytef*>(to);
      stream_.avail_out = piece;
      int const state = ended_ ? Z_STREAM_END : inflate(&stream_, Z_NO_FLUSH);
      std::size_t const made = piece - stream_.avail_out;
      ended_ = state == Z_STREAM_END;
      good_ = (state == Z_OK || ended_) && made > 0;
      to += made;
      count -= made;
    }
    return good_;
  }
  bool skip(std::size_t count) override {
    while (count > 0) {
      std::size_t const piece = std::min(count, rest_.size());
      if (!read(rest_.data(), piece)) return false;
      count -= piece;
    }
    return true;
  }
  /// To the end, where zlib compares its checksum of all that was inflated.
  bool ends_well() {
    while (!ended_)
      if (!read(rest_.data(), 1)) break;
    return ended_;
  }

 private:
  z_stream stream_{};
  bool good_, ended_ = false;
  std::array<char, 1U << 16U> rest_{};
};

class Walk {
 public:
  explicit Walk(bool big_endian) : big_endian_(big_endian) {}

  bool top(std::string_view bytes) const {
    while (!bytes.empty()) {
      PlainSource head(bytes);
      Tag tag;
      if (!read_tag(head, tag) || tag.small || tag.length > bytes.size() - tag_size) return false;
      std::string_view const inside = bytes.substr(tag_size, tag.length);
      if (tag.type == matrix_type) {
        PlainSource source(inside);
        if (!matrix(source, tag.length, 0)) return false;
      } else if (tag.type != compressed_type || !compressed(inside)) {
        return false;
      }
      bytes.remove_prefix(tag_size + tag.length);
    }
    return true;
  }

 private:
  struct Tag {
    std::uint32_t type = 0, length = 0;
    bool small = false;  // the data, up to four bytes, stand in the tag
  };

  std::uint32_t number(char const* at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(at[i])) << (8 * (big_endian_ ? 3 - i : i));
    return value;
  }
  bool read_tag(Source& source, Tag& tag) const {
    std::array<char, tag_size> bytes{};
    if (!source.read(bytes.data(), bytes.size())) return false;
    std::uint32_t const first = number(bytes.data());
    tag.small = first >> 16U != 0;
    tag.type = first & 0xffffU;
    tag.length = tag.small ? first >> 16U : number(bytes.data() + 4);
    if (tag.small) return tag.length <= 4;
    tag.type = first;
    return true;
  }
  /// A tag, and whether what it announces fits into the `left` bytes of the array around it, from which it is taken.
  bool next(Source& source, std::size_t& left, Tag& tag, std::size_t& stored) const {
    if (left < tag_size || !read_tag(source, tag)) return false;
    left -= tag_size;
    stored = tag.small ? 0 : tag.length;
    if (stored > left) return false;
    stored = std::min((stored + 7) / 8 * 8, left);  // the last one need not be filled up
    left -= stored;
    return true;
  }
  bool compressed(std::string_view bytes) const {
    InflatedSource source(bytes);
    Tag tag;
    return read_tag(source, tag) && tag.type == matrix_type && !tag.small && matrix(source, tag.length, 0) && source.ends_well();
  }
  bool matrix(Source& source, std::size_t left, int depth) const {
    if (left == 0) return true;  // an empty array
    Tag tag;
    std::size_t stored = 0;
    std::array<char, 8> flags{};
    if (depth > most_nested || !next(source, left, tag, stored) || stored != flags.size() || !source.read(flags.data(), stored))
      return false;
    std::uint32_t const all = number(flags.data()), kind = all & 0xffU;
    bool const is_complex = (all & 0x800U) != 0, numeric = kind >= 6 && kind <= 15;
    if (numeric && !numbers(source, left, is_complex)) return false;
    while (left > 0) {
      if (!next(source, left, tag, stored)) return false;
      if (tag.type == matrix_type && !tag.small) {
        if (!matrix(source, tag.length, depth + 1)) return false;
        stored -= tag.length;
      }
      if (!source.skip(stored)) return false;
    }
    return true;
  }
  /// Size, name, and the numbers, of which there must be as many as the size says.
  bool numbers(Source& source, std::size_t& left, bool is_complex) const {
    Tag tag;
    std::size_t stored = 0;
    if (!next(source, left, tag, stored) || tag.small || tag.length == 0 || tag.length % 4 != 0 || stored > 1024) return false;
    std::array<char, 1024> size{};
    if (!source.read(size.data(), stored)) return false;
    double count = 1;
    for (std::size_t at = 0; at < tag.length; at += 4) count *= number(size.data() + at);
    if (!next(source, left, tag, stored) || !source.skip(stored)) return false;
    for (int part = 0; part < (is_complex ? 2 : 1) && count > 0; ++part) {
      if (!next(source, left, tag, stored) || !source.skip(stored)) return false;
      static constexpr std::array<std::uint32_t, 14> widths{0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};
      std::uint32_t const width = tag.type < widths.size() ? widths[tag.type] : 0;
      if (width == 0 || static_cast<double>(tag.length) != count * width) return false;
    }
    return true;
  }

  bool big_endian_;
};

}  // namespace

bool matlab_elements_are_whole(std::string_view bytes) {
  return bytes.size() >= header_size && Walk(bytes[126] == 'M').top(bytes.substr(header_size));
}

}  // namespace sysid

// Latin-1 is read as Windows-1252, which is what programs mean by it: the signs 0x80 to 0x9f are no controls in any record.
#include "data/table/encoding.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace sysid {
namespace {

void append(std::string& out, std::uint32_t c) {
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xc0U | (c >> 6U));
    out += static_cast<char>(0x80U | (c & 0x3fU));
  } else if (c < 0x10000) {
    out += static_cast<char>(0xe0U | (c >> 12U));
    out += static_cast<char>(0x80U | ((c >> 6U) & 0x3fU));
    out += static_cast<char>(0x80U | (c & 0x3fU));
  } else {
    out += static_cast<char>(0xf0U | (c >> 18U));
    out += static_cast<char>(0x80U | ((c >> 12U) & 0x3fU));
    out += static_cast<char>(0x80U | ((c >> 6U) & 0x3fU));
    out += static_cast<char>(0x80U | (c & 0x3fU));
  }
}

/// 0x80 to 0x9f in Windows-1252; 0: not assigned.
constexpr std::array<std::uint16_t, 32> windows_signs{
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0, 0x017d, 0,
    0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0, 0x017e, 0x0178};

std::optional<std::string> from_latin1(std::string_view bytes) {
  std::string out;
  out.reserve(bytes.size() + bytes.size() / 16);
  for (char const c : bytes) {
    std::uint32_t code = static_cast<unsigned char>(c);
    if (code == 0) return std::nullopt;
    if (code >= 0x80 && code < 0xa0) code = windows_signs[code - 0x80];
    if (code == 0) return std::nullopt;
    append(out, code);
  }
  return out;
}

std::optional<std::string> from_utf16(std::string_view bytes) {
  bool const marked = has_utf16_mark(bytes);
  bool const big = marked ? bytes[0] == '\xfe' : bytes.size() > 1 && bytes[0] == 0;
  if (bytes.size() % 2 != 0) return std::nullopt;
  auto const unit = [&](std::size_t at) {
    auto const a = static_cast<unsigned char>(bytes[at]), b = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(big ? a << 8U | b : b << 8U | a);
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t at = marked ? 2 : 0; at < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code == 0 || (code >= 0xdc00 && code < 0xe000)) return std::nullopt;
    if (code >= 0xd800 && code < 0xdc00) {
      if (at + 3 >= bytes.size()) return std::nullopt;
      std::uint32_t const low = unit(at += 2);
      if (low < 0xdc00 || low >= 0xe000) return std::nullopt;
      code = 0x10000 + ((code - 0xd800) << 10U) + (low - 0xdc00);
    }
    append(out, code);
  }
  return out;
}

}  // namespace

bool is_utf8(std::string_view text) {
  auto const* p = reinterpret_cast<unsigned char const*>(text.data());
  auto const* const end = p + text.size();
  auto const continues = [&](std::ptrdiff_t i, unsigned low = 0x80, unsigned high = 0xbf) {
    return end - p > i && p[i] >= low && p[i] <= high;
  };
  while (p != end) {
    unsigned const lead = *p;
    if (lead == 0) return false;
    if (lead < 0x80) {
      p += 1;
    } else if (lead >= 0xc2 && lead <= 0xdf && continues(1)) {
      p += 2;
    } else if ((lead & 0xf0) == 0xe0 && continues(1, lead == 0xe0 ? 0xa0 : 0x80, lead == 0xed ? 0x9f : 0xbf) && continues(2)) {
      p += 3;
    } else if (lead >= 0xf0 && lead <= 0xf4 && continues(1, lead == 0xf0 ? 0x90 : 0x80, lead == 0xf4 ? 0x8f : 0xbf) &&
               continues(2) && continues(3)) {
      p += 4;
    } else {
      return false;
    }
  }
  return true;
}

bool has_utf16_mark(std::string_view bytes) { return bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"); }

std::optional<Encoding> likely_encoding(std::string_view bytes) {
  constexpr std::size_t looked_at = 4096;
  std::string_view const head = bytes.substr(0, std::min(bytes.size() / 2 * 2, looked_at));
  if (has_utf16_mark(bytes)) return Encoding::utf16;
  // Text in UTF-16 is mostly signs below 256: every second byte is 0.
  std::size_t zeros = 0, controls = 0;
  for (char const c : head) {
    zeros += c == 0;
    controls += static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != 0;
  }
  if (controls > 0) return std::nullopt;
  if (zeros > 0) return zeros * 3 > head.size() ? std::optional(Encoding::utf16) : std::nullopt;
  return Encoding::latin1;
}

std::optional<std::string> to_utf8(std::string bytes, Encoding encoding) {
  if (has_utf16_mark(bytes) || encoding == Encoding::utf16) return from_utf16(bytes);
  if (encoding == Encoding::latin1) return from_latin1(bytes);
  if (!is_utf8(bytes)) return std::nullopt;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);
  return bytes;
}

}  // namespace sysid

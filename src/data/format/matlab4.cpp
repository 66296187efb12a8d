// "MAT-File Format" of MathWorks, Level 4: type = 1000 M + 100 O + 10 P + T, rows, columns, imaginary, length of the name; the
// name, the numbers. M: 0 little-endian, 1 big-endian; P: the type of the numbers; T: 0 full, 1 text, 2 sparse.
#include "data/format/matlab4.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sysid {
namespace {

constexpr std::size_t matrix_header = 20, longest_name = 64;

std::uint32_t number(std::string_view bytes, std::size_t at, bool big) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[at + (big ? i : 3 - i)]);
  return value;
}

bool is_name(std::string_view name) {
  auto const is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (name.size() < 2 || name.back() != '\0' || !is_letter(name.front())) return false;
  name.remove_suffix(1);
  for (char const c : name)
    if (!is_letter(c) && !(c >= '0' && c <= '9') && c != '_') return false;
  return true;
}

/// Bytes of the matrix that begins these, with its header; nothing where none does.
std::optional<std::uint64_t> size_of_matrix(std::string_view bytes) {
  if (bytes.size() < matrix_header) return std::nullopt;
  constexpr std::array<std::uint64_t, 6> sizes{8, 4, 4, 2, 2, 1};
  for (bool const big : {false, true}) {
    std::uint32_t const type = number(bytes, 0, big), rows = number(bytes, 4, big), columns = number(bytes, 8, big),
                        imaginary = number(bytes, 12, big), name = number(bytes, 16, big);
    if (type / 1000 != (big ? 1U : 0U)) continue;
    std::uint32_t const order = type / 100 % 10, precision = type / 10 % 10, kind = type % 10;
    if (order != 0 || precision >= sizes.size() || kind > 2 || imaginary > 1 || name > longest_name) continue;
    if (rows > INT32_MAX || columns > INT32_MAX || bytes.size() < matrix_header + name) continue;
    if (!is_name(bytes.substr(matrix_header, name))) continue;
    constexpr std::uint64_t most = std::uint64_t{1} << 48U;  // of a file
    std::uint64_t const count = std::uint64_t{rows} * columns;
    return matrix_header + name + (count < most ? count * sizes[precision] * (imaginary + 1) : most);
  }
  return std::nullopt;
}

}  // namespace

bool is_matlab4(std::string_view bytes) { return size_of_matrix(bytes).has_value(); }

bool matlab4_is_whole(std::string_view bytes) {
  while (!bytes.empty()) {
    auto const size = size_of_matrix(bytes);
    if (!size || *size > bytes.size()) return false;
    bytes.remove_prefix(static_cast<std::size_t>(*size));
  }
  return true;
}

}  // namespace sysid

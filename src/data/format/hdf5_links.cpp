// A link message (HDF5 File Format Specification 3.0, IV.A.2.g): version 1, flags, the type, perhaps an order and a character set,
// the name, and for an external link the length of what follows, a zero, the name of the file and that of the object.
#include "data/format/hdf5_links.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace sysid {
namespace {

class LinkMessage {
 public:
  LinkMessage(std::string_view bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  /// The name of the file; nothing where no external link begins here.
  std::optional<std::string> file() {
    constexpr unsigned has_order = 4, has_type = 8, has_characters = 16, known = 31, external = 64;
    if (number(1) != 1) return std::nullopt;
    auto const flags = static_cast<unsigned>(number(1));
    if ((flags & has_type) == 0 || flags > known || number(1) != external) return std::nullopt;
    if ((flags & has_order) != 0) at_ += 8;
    if ((flags & has_characters) != 0 && number(1) > 1) return std::nullopt;
    std::uint64_t const name = number(std::size_t{1} << (flags & 3U));
    if (name == 0 || name > longest || !text(name)) return std::nullopt;
    std::uint64_t const length = number(2);
    if (length < 5 || length > 2 * longest || number(1) != 0) return std::nullopt;
    auto const target = terminated(), object = terminated();
    if (!target || !object || target->size() + object->size() + 3 != length) return std::nullopt;
    return target;
  }

 private:
  static constexpr std::size_t longest = 4096;

  /// Little-endian; beyond the end no number that is looked for.
  std::uint64_t number(std::size_t size) {
    if (at_ > bytes_.size() || size > bytes_.size() - at_) return ~std::uint64_t{0};
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[at_ + i])) << (8 * i);
    at_ += size;
    return value;
  }
  std::optional<std::string> text(std::size_t size) {
    if (at_ > bytes_.size() || size > bytes_.size() - at_) return std::nullopt;
    std::string out(bytes_.substr(at_, size));
    for (char const c : out)
      if (static_cast<unsigned char>(c) < 0x20) return std::nullopt;
    at_ += size;
    return out;
  }
  std::optional<std::string> terminated() {
    std::size_t const end = bytes_.find('\0', at_);
    if (end == std::string_view::npos || end == at_ || end - at_ > longest) return std::nullopt;
    auto out = text(end - at_);
    ++at_;
    return out;
  }

  std::string_view bytes_;
  std::size_t at_;
};

}  // namespace

std::string external_link_in(std::string_view bytes) {
  for (std::size_t at = bytes.find('\1'); at != std::string_view::npos; at = bytes.find('\1', at + 1))
    if (auto const file = LinkMessage(bytes, at).file()) return *file;
  return {};
}

}  // namespace sysid

// A map of three members: the form, the checksum of the content's bytes, these bytes.
#include "report/file/sealed_cbor.hpp"

#include <boost/crc.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr std::size_t deepest = 64;

/// Any change of up to 32 neighbouring bits shows, and of others all but one in four thousand million. Of the form too: a flipped
/// bit in it is damage, not another version.
std::uint32_t checksum(std::vector<std::uint8_t> const& bytes, std::uint64_t form) {
  boost::crc_32_type sum;
  sum.process_bytes(bytes.data(), bytes.size());
  for (int shift = 0; shift < 64; shift += 8) sum.process_byte(static_cast<unsigned char>(form >> shift));
  return sum.checksum();
}

/// Reads the heads of CBOR values (RFC 8949, section 3).
class Heads {
 public:
  explicit Heads(std::string_view bytes) : bytes_(bytes) {}

  bool at_end() const { return bytes_.empty(); }
  /// False where there is none of the kinds that are written.
  bool next() {
    if (bytes_.empty()) return false;
    auto const first = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    major = first >> 5;
    unsigned const info = first & 31U;
    if (info < 24) {
      argument = info;
      return major != 7 || (info >= 20 && info <= 22);  // false, true, null
    }
    if (info > 27 || (major == 7 && info == 24)) return false;  // no stated length; a simple value
    std::size_t const size = std::size_t{1} << (info - 24);
    if (bytes_.size() < size) return false;
    argument = 0;
    for (std::size_t i = 0; i < size; ++i) argument = argument << 8 | static_cast<unsigned char>(bytes_[i]);
    bytes_.remove_prefix(size);
    return true;
  }
  bool skip(std::uint64_t size) {
    if (bytes_.size() < size) return false;
    bytes_.remove_prefix(static_cast<std::size_t>(size));
    return true;
  }
  std::size_t left() const { return bytes_.size(); }

  unsigned major = 0;
  std::uint64_t argument = 0;

 private:
  std::string_view bytes_;
};

}  // namespace

bool is_plain_cbor(std::string_view bytes) {
  Heads heads(bytes);
  std::vector<std::uint64_t> open = {1};  // values still to come at each level
  while (!open.empty()) {
    if (open.back() == 0) {
      open.pop_back();
      continue;
    }
    --open.back();
    if (!heads.next()) return false;
    switch (heads.major) {
      case 2:
      case 3:
        if (!heads.skip(heads.argument)) return false;
        break;
      case 4:
      case 5:
        // Each value takes a byte at least.
        if (heads.argument > heads.left() || open.size() > deepest) return false;
        open.push_back(heads.major == 5 ? 2 * heads.argument : heads.argument);
        break;
      case 6:
        return false;
      default:
        break;
    }
  }
  return heads.at_end();
}

std::string sealed_cbor(json const& content, int form) {
  std::vector<std::uint8_t> const inner = json::to_cbor(content);
  std::vector<std::uint8_t> const bytes = json::to_cbor(
      {{"form", form}, {"crc32", checksum(inner, static_cast<std::uint64_t>(form))}, {"content", json::binary(inner)}});
  return std::string(reinterpret_cast<char const*>(bytes.data()), bytes.size());  // of iterators it would go byte by byte
}

Seal open_cbor(std::string_view bytes, int form, json& content) {
  if (!is_plain_cbor(bytes)) return Seal::damaged;
  json const outer = json::from_cbor(bytes, true, false);
  if (!outer.is_object()) return Seal::damaged;
  auto const number = [&](char const* name) { return outer.contains(name) && outer[name].is_number_unsigned(); };
  if (!number("form") || !number("crc32") || !outer.contains("content") || !outer["content"].is_binary()) return Seal::damaged;
  json::binary_t const& inner = outer["content"].get_binary();
  if (outer["crc32"].get<std::uint64_t>() != checksum(inner, outer["form"].get<std::uint64_t>())) return Seal::damaged;
  if (outer["form"].get<std::uint64_t>() != static_cast<std::uint64_t>(form)) return Seal::other_form;
  if (!is_plain_cbor({reinterpret_cast<char const*>(inner.data()), inner.size()})) return Seal::damaged;
  content = json::from_cbor(inner, true, false);
  return content.is_discarded() ? Seal::damaged : Seal::whole;
}

}  // namespace sysid

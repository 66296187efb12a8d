// CBOR that this program stores for itself: with the number of its form and a checksum, so that what is read is what was written.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace sysid {

/// `content` with the number of the form that it has.
std::string sealed_cbor(nlohmann::json const& content, int form);

enum class Seal { whole, damaged, other_form };

/// The inverse: `content` is set where the seal is whole. Any bytes are an answer, never a crash.
Seal open_cbor(std::string_view bytes, int form, nlohmann::json& content);

/// Whether the bytes are one value as `to_cbor` of the library writes it: lengths stated, no tags, not nested deeper than 64. The
/// library's reader calls itself for each level, so that deeper ones would end the stack.
bool is_plain_cbor(std::string_view bytes);

}  // namespace sysid

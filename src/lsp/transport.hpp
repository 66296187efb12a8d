// Messages of the base protocol: a header with Content-Length, an empty line, that many bytes of JSON.
#pragma once
#include <istream>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace sysid::lsp {

/// More is no message of an editor.
inline constexpr std::size_t most_message_bytes = 64U << 20U;

struct Incoming {
  std::string body;
  std::string fault;  // why there is no body: a header without a length, or one that is no number; reading can go on
};

/// The next message; nothing at the end of the stream, also where it ends within a message.
std::optional<Incoming> read_message(std::istream& in);
/// Written whole and flushed.
void write_message(std::ostream& out, std::string_view body);

}  // namespace sysid::lsp

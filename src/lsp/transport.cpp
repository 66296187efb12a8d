// Framing. A header that cannot be used costs that header alone: the next line that is one begins the next message.
#include "lsp/transport.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "core/text/words.hpp"

namespace sysid::lsp {
namespace {

constexpr std::string_view blanks = " \t\r\n\v\f";

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) { return std::tolower(x) == y; });
}

}  // namespace

std::optional<Incoming> read_message(std::istream& in) {
  std::optional<std::size_t> length;
  std::string fault;
  bool any = false;
  for (std::string line; std::getline(in, line);) {
    std::string_view const text = trimmed(line, blanks);
    if (text.empty()) {
      if (!any) continue;
      if (!length) return Incoming{{}, fault.empty() ? "a header without Content-Length" : fault};
      Incoming message;
      message.body.resize(*length);
      if (!in.read(message.body.data(), static_cast<std::streamsize>(*length))) return std::nullopt;
      return message;
    }
    any = true;
    std::size_t const colon = text.find(':');
    if (colon == std::string_view::npos || !same_name(trimmed(text.substr(0, colon), blanks), "content-length")) continue;
    std::string_view const digits = trimmed(text.substr(colon + 1), blanks);
    std::size_t value = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value > most_message_bytes)
      fault = "Content-Length is not a usable number";
    else
      length = value;
  }
  return std::nullopt;
}

void write_message(std::ostream& out, std::string_view body) {
  out << "Content-Length: " << body.size() << "\r\n\r\n" << body << std::flush;
}

}  // namespace sysid::lsp

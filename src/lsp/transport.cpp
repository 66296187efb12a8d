// Framing. A header that cannot be used costs that header alone: the next line that is one begins the next message.
#include "lsp/transport.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace sysid::lsp {
namespace {

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) { return std::tolower(x) == y; });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<Incoming> read_message(std::istream& in) {
  std::optional<std::size_t> length;
  std::string fault;
  bool any = false;
  for (std::string line; std::getline(in, line);) {
    std::string_view const text = trimmed(line);
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
    if (colon == std::string_view::npos || !same_name(trimmed(text.substr(0, colon)), "content-length")) continue;
    std::string_view const digits = trimmed(text.substr(colon + 1));
    std::size_t value = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value > most_message_bytes)
      fault = "Content-Length is no usable number";
    else
      length = value;
  }
  return std::nullopt;
}

void write_message(std::ostream& out, std::string_view body) {
  out << "Content-Length: " << body.size() << "\r\n\r\n" << body << std::flush;
}

}  // namespace sysid::lsp

// Offsets in bytes against positions in lines and UTF-16 units.
#include "lsp/positions.hpp"

#include <doctest/doctest.h>

#include <random>

#include "client.hpp"

using namespace sysid;
using namespace sysid::lsp;
using namespace sysid::test;

TEST_CASE("columns count UTF-16 code units: one for é and β, two for a character beyond the basic plane") {
  std::string const text = "aé β\r\n𝛼x\rz\n";
  Lines const lines(text);
  CHECK(lines.position(0) == Position{0, 0});
  CHECK(lines.position(3) == Position{0, 2});  // behind é
  CHECK(lines.position(2) == Position{0, 1});  // within é
  CHECK(lines.position(6) == Position{0, 4});  // behind β
  CHECK(lines.position(8) == Position{1, 0});
  CHECK(lines.position(12) == Position{1, 2});  // behind 𝛼
  CHECK(lines.position(14) == Position{2, 0});  // behind CR
  CHECK(lines.position(99) == Position{3, 0});
  CHECK(lines.offset({0, 2}) == 3);
  CHECK(lines.offset({1, 1}) == 8);  // within the pair
  CHECK(lines.offset({1, 2}) == 12);
  CHECK(lines.offset({0, 99}) == 6);
  CHECK(lines.offset({9, 0}) == text.size());
  CHECK(lines.offset({-1, 0}) == 0);
}

TEST_CASE("every byte that begins a character goes to its position and back") {
  std::string const text = content(model_folder / "morison/morison.sysid") + "\n# Größe β 𝛼𝛽\nlet 变量 = 1\r\n";
  Lines const lines(text);
  for (std::uint32_t i = 0; i < text.size(); ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U || (i > 0 && text[i - 1] == '\r')) continue;
    CHECK(lines.offset(lines.position(i)) == i);
  }
}

TEST_CASE("incremental changes give the text that full ones give") {
  std::mt19937 random(7);
  std::string text = "aé𝛼\nβ = 1\r\n";
  Client client;
  client.open("/nowhere/a.sysid", text);
  std::vector<std::string> const pieces = {"", "x", "é", "𝛼", "\n", "let β = 2\n", "\r\n"};
  for (int i = 0; i < 300; ++i) {
    auto const any = [&] {
      auto at = static_cast<std::uint32_t>(random() % (text.size() + 1));
      while (at < text.size() && ((static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U || (at > 0 && text[at - 1] == '\r')))
        ++at;
      return at;
    };
    std::uint32_t a = any(), b = any();
    Span const span{std::min(a, b), std::min(std::max(a, b), std::min(a, b) + 6)};
    Span whole = span;
    while (whole.end < text.size() &&
           ((static_cast<unsigned char>(text[whole.end]) & 0xC0U) == 0x80U || (whole.end > 0 && text[whole.end - 1] == '\r')))
      ++whole.end;
    std::string const piece = pieces[random() % pieces.size()];
    client.notify("textDocument/didChange", {{"textDocument", {{"uri", client.uri}, {"version", i}}},
                                             {"contentChanges", {{{"range", range(Lines(text), whole)}, {"text", piece}}}}});
    text.replace(whole.begin, whole.end - whole.begin, piece);
  }
  // The outline of both texts is the same, to the last column.
  Json const incremental = client.request("textDocument/documentSymbol", {{"textDocument", {{"uri", client.uri}}}});
  Json const incremental_diagnostics = client.diagnostics;
  client.replace(text);
  CHECK(client.request("textDocument/documentSymbol", {{"textDocument", {{"uri", client.uri}}}}) == incremental);
  CHECK(client.diagnostics == incremental_diagnostics);
}

// Messages with their headers, whole and broken.
#include "lsp/transport.hpp"

#include <doctest/doctest.h>

#include <sstream>

#include "client.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string framed(std::string const& body) { return "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body; }
std::string sent(Json const& message) { return framed(message.dump()); }

/// What the server writes for these bytes, and its exit code.
std::pair<std::vector<Json>, int> served(std::string const& bytes) {
  std::istringstream in(bytes);
  std::ostringstream out;
  int const exit = lsp::serve(in, out);
  std::istringstream written(out.str());
  std::vector<Json> messages;
  while (auto const message = lsp::read_message(written)) messages.push_back(Json::parse(message->body));
  return {messages, exit};
}

Json request(int id, std::string const& method) {
  return {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", Json::object()}};
}
Json note(std::string const& method) { return {{"jsonrpc", "2.0"}, {"method", method}}; }

}  // namespace

TEST_CASE("messages are framed by their length in bytes, whatever other headers stand there") {
  std::istringstream in("content-length:  4\r\nContent-Type: application/vscode-jsonrpc; charset=utf-8\r\n\r\n\"é\"" +
                        framed("12"));
  auto const first = lsp::read_message(in), second = lsp::read_message(in);
  REQUIRE(first);
  CHECK(first->body == "\"é\"");
  REQUIRE(second);
  CHECK(second->body == "12");
  CHECK_FALSE(lsp::read_message(in));
  std::ostringstream out;
  lsp::write_message(out, "\"é\"");
  CHECK(out.str() == "Content-Length: 4\r\n\r\n\"é\"");
}

TEST_CASE("a message that breaks off is the end of the stream") {
  std::istringstream in("Content-Length: 10\r\n\r\n123");
  CHECK_FALSE(lsp::read_message(in));
}

TEST_CASE("the server survives input that is no message") {
  std::string const life = sent(request(1, "initialize")) + sent(request(2, "shutdown")) + sent(note("exit"));
  for (std::string const& noise :
       {std::string("Content-Length: many\r\n\r\n"), std::string("Content-Type: x\r\n\r\n"),
        std::string("Content-Length: 99999999999999999999\r\n\r\n"), framed("{\"jsonrpc\": "), framed("[]"), framed("17"),
        framed("\"\xff\""), framed("{\"id\": 3}"), framed("{\"id\": 3, \"method\": 4}"),
        framed("{\"method\": \"textDocument/didOpen\", \"params\": [1]}")}) {
    CAPTURE(noise);
    auto const [messages, exit] = served(noise + life);
    CHECK(exit == 0);
    REQUIRE(messages.size() >= 2);
    CHECK(messages[messages.size() - 2].at("result").contains("capabilities"));
    if (messages.size() == 3) CHECK(messages.front().at("error").at("code").get<int>() < 0);
  }
}

TEST_CASE("requests wait for initialize, unknown ones are refused, exit tells whether shutdown came before") {
  auto const [messages, exit] =
      served(sent(request(1, "textDocument/hover")) + sent(request(2, "initialize")) + sent(request(3, "initialize")) +
             sent(request(4, "workspace/fly")) + sent(note("$/whatever")) + sent(request(5, "textDocument/hover")) +
             sent(request(6, "shutdown")) + sent(request(7, "textDocument/hover")) + sent(note("exit")));
  REQUIRE(messages.size() == 7);
  auto const code = [&](int i) { return messages[static_cast<std::size_t>(i)].at("error").at("code").get<int>(); };
  CHECK(code(0) == lsp::not_initialized);
  CHECK(messages[1].contains("result"));
  CHECK(code(2) == lsp::invalid_request);
  CHECK(code(3) == lsp::method_not_found);
  CHECK(code(4) == lsp::invalid_params);
  CHECK(messages[5].at("result").is_null());
  CHECK(code(6) == lsp::invalid_request);
  CHECK(exit == 0);
  CHECK(served(sent(note("exit"))).second == 1);
  CHECK(served(sent(request(1, "initialize")) + sent(note("exit"))).second == 1);
  CHECK(served(sent(request(1, "initialize"))).second == 1);
}

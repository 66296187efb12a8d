// A table of requests, and the loop around it.
#include "lsp/server.hpp"

#include <functional>

#include "lsp/features.hpp"
#include "lsp/transport.hpp"

namespace sysid::lsp {
namespace {

struct RequestRow {
  char const* method;
  Json (*answer)(Documents&, Json const& params);
};
constexpr RequestRow requests[] = {{"textDocument/hover", &hover},
                                   {"textDocument/completion", &completion},
                                   {"textDocument/definition", &definition},
                                   {"textDocument/references", &references},
                                   {"textDocument/documentHighlight", &document_highlight},
                                   {"textDocument/prepareRename", &prepare_rename},
                                   {"textDocument/rename", &rename},
                                   {"textDocument/formatting", &formatting},
                                   {"textDocument/documentSymbol", &document_symbols}};

Json capabilities() {
  return {{"positionEncoding", "utf-16"},
          {"textDocumentSync", {{"openClose", true}, {"change", 2}}},
          {"hoverProvider", true},
          {"completionProvider", {{"triggerCharacters", {".", "[", "(", "\"", "/", "~", "="}}}},
          {"definitionProvider", true},
          {"referencesProvider", true},
          {"documentHighlightProvider", true},
          {"renameProvider", {{"prepareProvider", true}}},
          {"documentFormattingProvider", true},
          {"documentSymbolProvider", true}};
}

Json reply(Json const& id, Json result) { return {{"jsonrpc", "2.0"}, {"id", id}, {"result", std::move(result)}}; }
Json refusal(Json const& id, int code, std::string const& message) {
  return {{"jsonrpc", "2.0"}, {"id", id}, {"error", {{"code", code}, {"message", message}}}};
}
Json publication(Json params) {
  return {{"jsonrpc", "2.0"}, {"method", "textDocument/publishDiagnostics"}, {"params", std::move(params)}};
}

}  // namespace

Document& document_of(Documents& documents, Json const& params) {
  return documents.at(params.at("textDocument").at("uri").get<std::string>());
}

ReadPlace place_of(Documents& documents, Json const& params) {
  return read_place(documents, document_of(documents, params), position_from(params.at("position")));
}

Json Server::answer(std::string const& method, Json const& params) {
  if (method == "initialize") {
    if (state_ != State::new_born) throw RequestError(invalid_request, "the server is initialized already");
    state_ = State::running;
    return {{"capabilities", capabilities()}, {"serverInfo", {{"name", "sysid"}, {"version", SYSID_VERSION}}}};
  }
  if (state_ == State::new_born) throw RequestError(not_initialized, "the first request must be `initialize`");
  if (state_ == State::shut_down) throw RequestError(invalid_request, "the server is shut down");
  if (method == "shutdown") {
    state_ = State::shut_down;
    return nullptr;
  }
  for (RequestRow const& row : requests)
    if (method == row.method) return row.answer(documents_, params);
  throw RequestError(method_not_found, "there is no method `" + method + "`");
}

namespace {

/// That of a client which counts: until version 3.15 of the protocol it may be null.
std::int64_t version_of(Json const& document, std::int64_t otherwise) {
  auto const given = document.find("version");
  return given != document.end() && given->is_number_integer() ? given->get<std::int64_t>() : otherwise;
}

}  // namespace

std::vector<Json> Server::notified(std::string const& method, Json const& params) {
  if (method == "exit") exit_code_ = state_ == State::shut_down ? 0 : 1;
  if (state_ != State::running) return {};
  if (method == "textDocument/didOpen") {
    Json const& document = params.at("textDocument");
    documents_.open(document.at("uri").get<std::string>(), document.at("text").get<std::string>(), version_of(document, 0));
  } else if (method == "textDocument/didChange") {
    Document& document = document_of(documents_, params);
    documents_.change(document, params.at("contentChanges"), version_of(params.at("textDocument"), document.version + 1));
  } else if (method == "textDocument/didClose") {
    std::string const uri = document_of(documents_, params).uri;
    documents_.close(uri);
    return {publication({{"uri", uri}, {"diagnostics", Json::array()}})};
  }
  return {};
}

std::vector<Json> Server::handle(Json const& message) {
  if (!message.is_object()) return {refusal(nullptr, invalid_request, "a message must be an object")};
  auto const method = message.find("method");
  auto const id = message.find("id");
  if (method == message.end() || !method->is_string()) {
    if (id != message.end() && (message.contains("result") || message.contains("error"))) return {};  // an answer to nothing
    return {refusal(id == message.end() ? Json(nullptr) : *id, invalid_request, "a message must have a method")};
  }
  static Json const none = Json::object();
  auto const given = message.find("params");
  Json const& params = given == message.end() || given->is_null() ? none : *given;
  std::vector<Json> out;
  try {
    if (id == message.end()) return notified(*method, params);
    out = publish();
    out.push_back(reply(*id, answer(*method, params)));
  } catch (RequestError const& error) {
    if (id != message.end()) out.push_back(refusal(*id, error.code(), error.what()));
  } catch (Json::exception const& error) {
    if (id != message.end()) out.push_back(refusal(*id, invalid_params, error.what()));
  } catch (std::exception const& error) {
    if (id != message.end()) out.push_back(refusal(*id, internal_error, error.what()));
  }
  return out;
}

std::vector<Json> Server::publish() {
  std::vector<Json> out;
  for (auto& [uri, document] : documents_.all())
    if (!document.analysed) out.push_back(publication(diagnostics(documents_, document)));
  return out;
}

int serve(std::istream& in, std::ostream& out) {
  Server server;
  auto const write = [&](std::vector<Json> const& messages) {
    // The user's text may hold any bytes.
    for (Json const& each : messages) write_message(out, each.dump(-1, ' ', false, Json::error_handler_t::replace));
  };
  while (!server.exit_code()) {
    auto const incoming = read_message(in);
    if (!incoming) return 1;
    if (!incoming->fault.empty()) {
      write({refusal(nullptr, parse_error, incoming->fault)});
      continue;
    }
    Json const message = Json::parse(incoming->body, nullptr, false);
    if (message.is_discarded())
      write({refusal(nullptr, parse_error, "the message is not JSON")});
    else
      write(server.handle(message));
    // While more has come already the texts may change again.
    if (in.rdbuf()->in_avail() <= 0) write(server.publish());
  }
  return *server.exit_code();
}

}  // namespace sysid::lsp

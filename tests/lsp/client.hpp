// A scripted client: messages in, answers out, without an editor.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "lsp/server.hpp"

namespace sysid::test {

using lsp::Json;

inline std::filesystem::path const model_folder = std::filesystem::path(SYSID_SOURCE_DIR) / "models";

inline std::string content(std::filesystem::path const& path) {
  std::ifstream const in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

inline std::vector<std::filesystem::path> shipped_models() {
  std::vector<std::filesystem::path> files;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(model_folder))
    if (entry.path().extension() == ".sysid") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class Client {
 public:
  Client() {
    Json const answer = request("initialize", {{"capabilities", Json::object()}});
    capabilities = answer.at("capabilities");
    notify("initialized", Json::object());
  }

  /// The result of a request; `error` holds the error where there is one.
  Json request(std::string const& method, Json params) {
    Json const message = {{"jsonrpc", "2.0"}, {"id", ++id_}, {"method", method}, {"params", std::move(params)}};
    std::vector<Json> const out = server.handle(message);
    REQUIRE(!out.empty());
    take(out);
    Json const& last = out.back();
    REQUIRE(last.at("id") == id_);
    error = last.value("error", Json(nullptr));
    return last.value("result", Json(nullptr));
  }
  void notify(std::string const& method, Json params) {
    take(server.handle({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}}));
  }

  /// What the server says when nothing more comes.
  void settle() { take(server.publish()); }

  /// Opens a text under a URI; the requests below are about the last one opened.
  void open(std::string const& path, std::string const& text) {
    uri = lsp::uri_of(path);
    notify("textDocument/didOpen", {{"textDocument", {{"uri", uri}, {"languageId", "sysid"}, {"version", 1}, {"text", text}}}});
    settle();
  }
  void replace(std::string const& text) {
    notify("textDocument/didChange",
           {{"textDocument", {{"uri", uri}, {"version", ++version_}}}, {"contentChanges", {{{"text", text}}}}});
    settle();
  }
  /// Bytes of `old` replaced, as an editor sends it.
  void edit(std::string const& old, Span span, std::string const& text) {
    type(old, span, text);
    settle();
  }
  /// The same, while more is being typed: nothing is said yet.
  void type(std::string const& old, Span span, std::string const& text) {
    notify("textDocument/didChange", {{"textDocument", {{"uri", uri}, {"version", ++version_}}},
                                      {"contentChanges", {{{"range", lsp::range(lsp::Lines(old), span)}, {"text", text}}}}});
  }
  Json at(std::string const& method, std::string const& text, std::size_t offset, Json more = Json::object()) {
    more["textDocument"] = {{"uri", uri}};
    more["position"] = lsp::to_json(lsp::Lines(text).position(static_cast<std::uint32_t>(offset)));
    return request("textDocument/" + method, std::move(more));
  }

  lsp::Server server;
  Json capabilities, error;
  std::string uri;
  Json diagnostics = Json::array();  // of the text opened last

 private:
  void take(std::vector<Json> const& messages) {
    for (Json const& each : messages)
      if (each.value("method", "") == "textDocument/publishDiagnostics" && each.at("params").at("uri") == uri)
        diagnostics = each.at("params").at("diagnostics");
  }
  int id_ = 0, version_ = 1;
};

inline Span span_of(std::string const& text, Json const& range) {
  lsp::Lines const lines(text);
  return {lines.offset(lsp::position_from(range.at("start"))), lines.offset(lsp::position_from(range.at("end")))};
}
inline std::string text_of(std::string const& text, Json const& range) {
  Span const span = span_of(text, range);
  return text.substr(span.begin, span.end - span.begin);
}
inline std::vector<std::string> labels(Json const& completion) {
  std::vector<std::string> all;
  for (Json const& item : completion.at("items")) all.push_back(item.at("label"));
  return all;
}
inline bool has(std::vector<std::string> const& all, std::string const& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace sysid::test

// The texts that an editor holds open.
#pragma once
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "assist/analysis.hpp"
#include "lsp/positions.hpp"

namespace sysid::lsp {

using Json = nlohmann::json;

/// What a client asks for and cannot have: answered as an error of the protocol, the server goes on.
class RequestError : public std::runtime_error {
 public:
  RequestError(int code, std::string const& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};
inline constexpr int parse_error = -32700, invalid_request = -32600, method_not_found = -32601, invalid_params = -32602,
                     internal_error = -32603, not_initialized = -32002, request_failed = -32803;

/// `file:///a/b%20c.sysid` to a path and back; a URI of another kind is itself.
std::string path_of(std::string const& uri);
std::string uri_of(std::string const& path);

struct Document {
  std::string uri, path, text;
  std::int64_t version = 0;
  bool analysed = false;                           // its diagnostics are those of this text
  std::vector<std::string> asked;                  // files that its last analysis looked for, there or not
  std::shared_ptr<assist::Reading const> reading;  // of this text; null: not read yet, or it cannot be read
  bool read = false;
  std::shared_ptr<assist::Reading const> last_reading;  // the last that there was, with its text
  std::string last_text;
};

class Documents {
 public:
  Document& open(std::string const& uri, std::string text, std::int64_t version);
  void close(std::string const& uri);
  /// RequestError where it is not open.
  Document& at(std::string const& uri);
  /// Full and incremental changes, in order.
  void change(Document& document, Json const& changes, std::int64_t version);
  std::map<std::string, Document>& all() { return all_; }

  /// What stands in place of files that are open.
  assist::Reading const* reading(Document& document);
  UnsavedText unsaved() const;

 private:
  /// Those that use it as a module say something else now.
  void touch_users(Document const& module);

  std::map<std::string, Document> all_;
};

/// A place in the reading that serves a document: of its present text, or of the last one that could be read.
struct ReadPlace {
  std::shared_ptr<assist::Reading const> reading;  // null: there was none yet
  std::uint32_t offset = 0;
};
ReadPlace read_place(Documents& documents, Document& document, Position position);

Position position_from(Json const& json);
Json to_json(Position position);
Json range(Lines const& lines, Span span);
/// A place in any of a source's files.
Json location(Source const& source, Span span);

}  // namespace sysid::lsp

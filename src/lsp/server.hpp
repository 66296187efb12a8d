// The life of a language server: initialize, requests and notifications, shutdown, exit.
#pragma once
#include <istream>
#include <optional>
#include <ostream>
#include <vector>

#include "lsp/documents.hpp"

namespace sysid::lsp {

class Server {
 public:
  /// Answers and notifications that one message brings about, in order. Diagnostics of texts that have changed come before the
  /// answer to a request; behind notifications they wait for `publish`.
  std::vector<Json> handle(Json const& message);
  /// Diagnostics of all texts that have changed since theirs were published.
  std::vector<Json> publish();
  /// The exit code, once the client has asked to exit: 0 after `shutdown`, else 1.
  std::optional<int> exit_code() const { return exit_code_; }

 private:
  enum class State { new_born, running, shut_down };
  Json answer(std::string const& method, Json const& params);
  std::vector<Json> notified(std::string const& method, Json const& params);

  State state_ = State::new_born;
  std::optional<int> exit_code_;
  Documents documents_;
};

/// Serves until the client exits or the stream ends, which is exit code 1.
int serve(std::istream& in, std::ostream& out);

}  // namespace sysid::lsp

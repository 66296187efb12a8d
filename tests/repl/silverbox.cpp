// The dialogue of docs/repl.md, typed again: it finds the cubic stiffness of the Silverbox, and what the page shows is what comes.
#include <doctest/doctest.h>

#include <cstdlib>
#include <sstream>

#include "core/system/files.hpp"
#include "pseudo_terminal.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

namespace {

struct Statement {
  std::vector<std::string> lines;  // typed
  std::vector<std::string> shown;  // by the page; "..." leaves something out
};

std::vector<std::string> lines_of(std::string const& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<Statement> statements_of(std::string const& page) {
  std::vector<Statement> statements;
  bool inside = false;
  for (std::string const& line : lines_of(page)) {
    if (line.starts_with("```")) {
      inside = line == "```text dialogue";
    } else if (inside && line.starts_with("sysid> ")) {
      statements.push_back({{line.substr(7)}, {}});
    } else if (inside && line.starts_with("  ...> ")) {
      statements.back().lines.push_back(line.substr(7));
    } else if (inside && !line.empty() && !statements.empty()) {
      statements.back().shown.push_back(line);
    }
  }
  return statements;
}

/// What stays on the screen: bars that were drawn over are gone, and so is what moved the cursor.
std::string settled(std::string const& text) {
  std::string out;
  std::size_t line = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && text.compare(i, 4, "\r\033[K") == 0) {
      out.resize(line);
      i += 3;
    } else if (text[i] == '\033') {
      while (i < text.size() && !std::isalpha(static_cast<unsigned char>(text[i]))) ++i;
    } else if (text[i] != '\r') {
      out += text[i];
      if (text[i] == '\n') line = out.size();
    }
  }
  return out;
}

}  // namespace

TEST_CASE("the dialogue of the documentation comes out as it is shown, and finds the cubic stiffness in under 20 statements") {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  auto const statements = statements_of(read_file(root / "docs" / "repl.md"));
  REQUIRE(statements.size() > 10);
  CHECK(statements.size() < 20);
  TemporaryFolder folder;
  std::filesystem::copy_file(root / "models" / "silverbox" / "silverbox.csv", folder.path() / "silverbox.csv");
  RunOptions options;
  options.seed = 1;
  options.execution.threads = 0;
  PseudoTerminal terminal(folder.path(), options);
  terminal.until(terminal.prompt);
  std::string transcript;
  for (Statement const& statement : statements) {
    CAPTURE(statement.lines.front());
    for (std::size_t i = 0; i < statement.lines.size(); ++i) {
      terminal.type(statement.lines[i] + "\r");
      terminal.until("\n");
      if (i + 1 < statement.lines.size()) terminal.until("...> ");
    }
    std::string said = settled(terminal.until(terminal.prompt, 300));
    if (said.ends_with(terminal.prompt)) said.resize(said.size() - std::string(terminal.prompt).size());
    for (std::size_t i = 0; i < statement.lines.size(); ++i)
      transcript += (i == 0 ? "sysid> " : "  ...> ") + statement.lines[i] + "\n";
    transcript += said;
    auto const lines = lines_of(said);
    auto at = lines.begin();
    for (std::string const& shown : statement.shown) {
      if (shown == "...") continue;
      at = std::find(at, lines.end(), shown);
      CHECK_MESSAGE(at != lines.end(), "not shown, or not here: " << shown);
      if (at == lines.end()) break;
      ++at;
    }
  }
  terminal.type("\x04");
  CHECK(terminal.ended() == 0);
  // For whoever writes the page: what was said.
  if (char const* path = std::getenv("SYSID_TRANSCRIPT")) write_file(path, transcript);
  CHECK(std::filesystem::exists(folder.path() / "silverbox.sysid"));
}

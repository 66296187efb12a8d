// A file of the language that a program has opened, with all that its models and tasks refer to.
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <sstream>
#include <string>

#include "app/density/fit_density.hpp"
#include "app/session/session.hpp"
#include "embed/errors.hpp"
#include "load/load.hpp"

namespace sysid::embed {

/// A checked file. Records of data blocks may lie elsewhere than the text says.
class OpenFile {
 public:
  /// text: in place of what the file at `path` holds. records: the path of a table, absolute, by the name of a data block, which
  /// then needs no `file` line. awaits_records: nor does any other, since the file is opened to learn what tables it needs. Throws
  /// Raised where the text or the names of blocks are wrong.
  OpenFile(std::string const& path, std::optional<std::string> const& text, std::map<std::string, std::string> const& records,
           bool awaits_records = false);

  Source const& source() const { return source_; }
  CheckedFile const& file() const { return *file_; }
  /// Warnings about the text, as the command line prints them; empty: none.
  std::string const& warnings() const { return warnings_; }

 private:
  Source source_;
  std::optional<CheckedFile> file_;
  std::string warnings_;
};

/// A density with the session that it is of.
class OpenDensity {
 public:
  OpenDensity(std::shared_ptr<OpenFile const> file, std::string const& task, int threads);

  std::shared_ptr<OpenFile const> const& file() const { return file_; }
  FitDensity const& density() const { return *density_; }
  FitDensity& density() { return *density_; }
  Target const& target() const { return density_->target(); }
  /// Of all calls so far. Held while another thread adds to it.
  Ledger ledger() const;
  void add(Ledger const& ledger);
  /// Held shared by whoever uses the density, and alone for FitDensity::prepare, which replaces what the others compute with.
  std::shared_mutex& in_use() const { return in_use_; }

 private:
  std::shared_ptr<OpenFile const> file_;
  RunOptions options_;
  SilentProgress silent_;
  std::ostringstream out_, notices_;
  Session session_;
  std::unique_ptr<FitDensity> density_;
  mutable std::mutex mutex_;
  mutable std::shared_mutex in_use_;
  Ledger ledger_;
};

}  // namespace sysid::embed

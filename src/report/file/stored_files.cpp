// The digest of the summary is checked on its text, before anything of it is parsed.
#include "report/file/stored_files.hpp"

#include <fmt/format.h>

#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "report/file/replacement.hpp"
#include "report/file/result_files.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view key = "\"summary_sha256\": \"";  // in a string of JSON the quotes would have backslashes
constexpr std::size_t digest_size = 64;

void require_files(fs::path const& folder, std::string const& summary) {
  FileDigests const files = interpreted(
      folder / "summary.json", [&] { return nlohmann::json::parse(summary).at("versions").at("files").get<FileDigests>(); });
  for (auto const& [name, digest] : files) {
    std::error_code error;  // of names that no file can have
    if (!is_stored_table(name) || name.find('/') != name.npos || !fs::exists(folder / name, error))
      throw unusable_result(fmt::format("`{}`, a file of this result, is missing", (folder / name).string()));
    if (sha256(read_regular_file(folder / name)) != digest)
      throw unusable_result(fmt::format("`{}` has been changed since it was written", (folder / name).string()));
  }
  for (fs::directory_entry const& entry : fs::directory_iterator(folder))
    if (std::string const name = entry.path().filename();
        is_stored_table(name) && !files.contains(name) && !fs::is_directory(entry.symlink_status()))
      throw unusable_result(fmt::format("`{}` does not belong to the result in its folder", entry.path().string()));
}

}  // namespace

UserError unusable_result(std::string message) { return UserError(result_error("E6209", std::move(message), run_again())); }

void throw_damaged(fs::path const& path) {
  UserError const damaged = unusable_result(fmt::format("`{}` is damaged", path.string()));
  try {
    throw;
  } catch (nlohmann::json::exception const&) {
    throw damaged;
  } catch (std::out_of_range const&) {
    throw damaged;
  } catch (std::length_error const&) {
    throw damaged;
  } catch (std::bad_alloc const&) {  // of a length that nothing has
    throw damaged;
  }
}

bool is_stored_table(std::string const& name) {
  ResultFileRow const* const row = result_file_row(name);
  return row != nullptr && row->sealed;
}

std::string unsealed() { return std::string(digest_size, '0'); }

std::string sealed_summary(std::string text) {
  std::size_t const place = text.find(key) + key.size();
  text.replace(place, digest_size, unsealed());
  text.replace(place, digest_size, sha256(text));
  return text;
}

std::string read_summary(fs::path const& folder) {
  (void)summary_stands(folder);
  fs::path const path = folder / "summary.json";
  std::string text = read_regular_file(path);
  auto const place = text.find(key);
  if (place == text.npos && text.find("\"versions\"") == text.npos)
    throw unusable_result(fmt::format("`{}` is not the result of a task", path.string()));
  if (place == text.npos) throw unusable_result(fmt::format("`{}` was written by an older version of sysid", folder.string()));
  std::string zeros = text;
  if (place + key.size() + digest_size <= text.size()) zeros.replace(place + key.size(), digest_size, unsealed());
  if (text.compare(place + key.size(), digest_size, sha256(zeros)) != 0)
    throw unusable_result(fmt::format("`{}` has been changed since it was written", path.string()));
  if (interpreted(path, [&] { return nlohmann::json::parse(text).at("versions").value("form", 0); }) != stored_form)
    throw unusable_result(fmt::format("`{}` was written by another version of sysid", folder.string()));
  return text;
}

std::string read_whole_summary(fs::path const& folder) {
  std::string text = read_summary(folder);
  require_files(folder, text);
  return text;
}

}  // namespace sysid

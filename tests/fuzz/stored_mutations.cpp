// Reads what was changed as the program does, once with the digests that were written and once with those of the change.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/system/digest.hpp"
#include "core/text/diagnostic.hpp"
#include "fuzz/files.hpp"
#include "fuzz/mutator.hpp"
#include "fuzz/stored.hpp"
#include "report/example.hpp"
#include "report/file/number_table.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/sealed_cbor.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/stored_report.hpp"
#include "report/file/task_folder.hpp"

namespace sysid::fuzz {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

template <class Rows>
void append_rows(std::string& all, Rows const& rows) {
  for (auto const& row : rows)
    for (double const value : row) all.append(reinterpret_cast<char const*>(&value), sizeof value);
}

void append_draws(std::string& all, Draws const& draws) {
  for (Chain const& chain : draws.chains) {
    append_rows(all, std::array{chain.log_density, chain.log_prior, chain.log_likelihood, chain.acceptance});
    append_rows(all, chain.values);
  }
}

/// All numbers of a result, those of its tables too.
std::string all_of(Report const& report) {
  std::string all = record_bytes(report);
  append_draws(all, report.draws);
  for (Prediction const& prediction : report.predictions) {
    append_rows(all, std::array{prediction.time});
    all.append(prediction.scored.begin(), prediction.scored.end());
    for (PredictedQuantity const& quantity : prediction.quantities) {
      for (Band const* band : {&quantity.response, &quantity.noisy})
        append_rows(all, std::array{band->mean, band->sd, band->lower, band->upper});
      append_rows(all, std::array{quantity.measured});
    }
  }
  for (FunctionReport const& function : report.functions)
    for (FunctionPoint const& point : function.grid)
      append_rows(all, std::array{point.inputs, std::vector{point.mean, point.sd, point.q5, point.q95}});
  if (!report.selection) return all;
  for (SelectedModel const& model : report.selection->result.models) {
    append_rows(all, std::array{model.weight, model.distance});
    for (int d = 0; d < model.declared.rows(); ++d) append_rows(all, std::array{model.declared.row(d)});
  }
  for (Draws const& draws : report.selection->refined_draws) append_draws(all, draws);
  return all;
}

/// What the file gives, as text; throws where it is refused.
std::string read_back(fs::path const& folder, StoredFile const& file) {
  if (file.name == "summary.json") return read_whole_summary(folder) + all_of(read_result(folder));
  return all_of(read_result(folder));
}

/// Whether columns of a forged report are of lengths that can be filled a hundred thousand times.
bool moderate(json const& value) {
  if (value.is_number_integer()) return value.get<double>() < 1e5 && value.get<double>() > -1e5;
  if (value.is_structured()) return std::all_of(value.begin(), value.end(), [](json const& each) { return moderate(each); });
  return true;
}

std::string with_zeros(std::string text) {
  std::string const key = "\"summary_sha256\": \"";
  auto const place = text.find(key);
  if (place != text.npos && place + key.size() + unsealed().size() <= text.size())
    text.replace(place + key.size(), unsealed().size(), unsealed());
  return text;
}

/// A summary that has the digest of `changed` for that of the file.
std::string summary_with(std::string summary, StoredFile const& file, std::string const& changed) {
  std::string const digest = sha256(file.bytes);
  auto const place = summary.find(digest);
  if (place != summary.npos) summary.replace(place, digest.size(), sha256(changed));
  return sealed_summary(with_zeros(std::move(summary)));
}

using Reader = std::function<std::string()>;

/// Nothing where the file is refused.
std::optional<std::string> unless_refused(Reader const& reader) {
  try {
    return reader();
  } catch (UserError const&) {
    return std::nullopt;
  } catch (IoError const&) {
    return std::nullopt;
  }
}

/// Behind the checksums: with every digest and checksum as a writer of these bytes would have left it, readers meet any bytes.
/// False: there are none that a reader would get to see.
bool forge(fs::path const& folder, StoredFile const& file, std::string const& summary, std::string const& changed,
           Mutator& mutator) {
  if (file.name.ends_with(".csv")) {
    put(folder / "summary.json", summary_with(summary, file, changed));
    put(folder / file.name, changed);
    return true;
  }
  if (file.name == "summary.json") {
    std::string const text = with_zeros(changed);
    if (text.find(unsealed()) == text.npos) return false;
    put(folder / file.name, sealed_summary(text));
    return true;
  }
  json const outer = json::from_cbor(file.bytes);
  json::binary_t const& inner = outer.at("content").get_binary();
  std::string const other = mutator(std::string(inner.begin(), inner.end()));
  if (!is_plain_cbor(other)) return false;
  json const content = json::from_cbor(other, true, false);
  if (content.is_discarded() || !moderate(content)) return false;
  put(folder / file.name, sealed_cbor(content, outer.at("form").get<int>()));
  return true;
}

/// Whatever is read of it, every reader must come back.
void read_forged(std::vector<Reader> const& readers) {
  for (Reader const& reader : readers) {
    try {
      (void)unless_refused(reader);
    } catch (std::bad_alloc const&) {
    }
  }
}

}  // namespace

std::vector<StoredFile> write_example(fs::path const& folder) {
  Report report = example::duffing(12);
  Prediction& prediction = report.predictions.front();
  auto const shorten = [](auto&... columns) { (columns.resize(std::min<std::size_t>(columns.size(), 20)), ...); };
  shorten(prediction.time, prediction.scored);
  for (PredictedQuantity& each : prediction.quantities)
    for (Band* band : {&each.response, &each.noisy}) shorten(band->mean, band->sd, band->lower, band->upper, each.measured);
  write_result(report, folder, {});
  return stored_files(folder);
}

std::vector<StoredFile> stored_files(fs::path const& folder) {
  std::vector<StoredFile> files;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder)) {
    std::string const name = entry.path().filename();
    if (name != "summary.json" && name != "report.cbor" && !is_stored_table(name)) continue;
    files.push_back({name, bytes_of(entry.path())});
  }
  std::sort(files.begin(), files.end(), [](StoredFile const& a, StoredFile const& b) { return a.name < b.name; });
  return files;
}

Outcome mutate(fs::path const& folder, StoredFile const& file, std::uint64_t count, std::uint64_t seed, Reader const& later) {
  Outcome outcome;
  Mutator mutator({seed, Purpose::test, std::hash<std::string>()(file.name), 0});
  std::vector<Reader> readers = {[&] { return read_back(folder, file); }};
  if (later) readers.push_back(later);
  std::vector<std::string> meant;
  for (Reader const& reader : readers) meant.push_back(reader());
  std::string const summary = fs::exists(folder / "summary.json") ? bytes_of(folder / "summary.json") : "";
  for (std::uint64_t i = 0; i < count && outcome.fault.empty(); ++i) {
    std::string const changed = mutator(file.bytes);
    put(folder / file.name, changed);
    bool seen = true, same = true;  // by all readers, to all of them
    for (std::size_t r = 0; r < readers.size(); ++r) {
      auto const read = unless_refused(readers[r]);
      seen = seen && !read;
      same = same && read;
      if (read && *read != meant[r]) outcome.fault = file.name + ": read as something else: " + changed;
    }
    ++(same ? outcome.same : outcome.refused);
    if (!seen && changed != file.bytes && file.name != "report.cbor")
      outcome.fault = file.name + ": a change was not seen: " + changed;
    if (forge(folder, file, summary, changed, mutator)) read_forged(readers);
    if (file.name.ends_with(".csv")) put(folder / "summary.json", summary);
  }
  put(folder / file.name, file.bytes);
  return outcome;
}

}  // namespace sysid::fuzz

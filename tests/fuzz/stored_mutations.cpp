// Mutations as disks, networks and editors make them: bits and bytes, cuts, repeated and moved parts, other numbers.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
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

constexpr int checkpoint_form = 3;

/// Without flushing to the disk, which would take all of the time.
void put(fs::path const& path, std::string const& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string checkpoint() {
  std::vector<std::uint8_t> const numbers(800, 0x3f);
  json const content = {{"preparation", {{"moves", {0.5, 0.25}}, {"modes", json::array()}}},
                        {"state", {{"next", 120}, {"chains", json::binary(numbers)}, {"widths", {1.5, 2.5}}}}};
  return sealed_cbor({{"who", {{"task", "posterior"}, {"seed", 7}, {"model", std::string(300, 'm')}}}, {"content", content}},
                     checkpoint_form);
}

class Mutator {
 public:
  explicit Mutator(StreamKey key) : stream_(key) {}

  std::string operator()(std::string bytes) {
    for (std::uint64_t changes = 1 + below(3); changes > 0; --changes) change(bytes);
    return bytes;
  }

 private:
  std::uint64_t below(std::uint64_t count) { return count == 0 ? 0 : stream_.below(count); }

  void change(std::string& bytes) {
    std::uint64_t const at = below(bytes.size()), length = below(std::min<std::uint64_t>(bytes.size() - at, 1 + below(200)) + 1);
    switch (below(8)) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << below(8)));
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(below(bytes.size() + 1), bytes.substr(at, length));
        break;
      case 5:
        bytes.insert(at, 1 + below(3), static_cast<char>(below(256)));
        break;
      case 6: {  // another digit
        auto const digit = bytes.find_first_of("0123456789", at);
        if (digit != std::string::npos) bytes[digit] = static_cast<char>('0' + below(10));
        break;
      }
      default:  // deep nesting
        bytes.insert(at, 1 + below(5000), "\x81[{\x9f\x7f\xd8"[below(6)]);
        break;
    }
  }

  Stream stream_;
};

/// What the file gives, as text; throws where it is refused.
std::string read_back(fs::path const& folder, StoredFile const& file, std::string const& bytes) {
  if (file.name == "checkpoint.cbor") {
    json content;
    if (open_cbor(bytes, checkpoint_form, content) != Seal::whole) throw unusable_result("damaged");
    return sealed_cbor(content, checkpoint_form);
  }
  if (file.name == "summary.json") return read_whole_summary(folder);
  Report const report = read_result(folder);
  std::string all = record_bytes(report);
  for (Chain const& chain : report.draws.chains)
    for (auto const* column : {&chain.log_density, &chain.log_prior, &chain.log_likelihood, &chain.acceptance})
      for (double const value : *column) all.append(reinterpret_cast<char const*>(&value), sizeof value);
  for (Chain const& chain : report.draws.chains)
    for (auto const& row : chain.values)
      for (double const value : row) all.append(reinterpret_cast<char const*>(&value), sizeof value);
  return all;
}

/// Whether columns of a forged report are of lengths that can be filled a hundred thousand times.
bool moderate(json const& value) {
  if (value.is_number_integer()) return value.get<double>() < 1e5 && value.get<double>() > -1e5;
  if (value.is_structured()) return std::all_of(value.begin(), value.end(), [](json const& each) { return moderate(each); });
  return true;
}

/// Behind the checksums: parsers meet any bytes.
void read_forged(StoredFile const& file, std::string const& bytes, Mutator& mutator) {
  try {
    if (file.name.ends_with(".csv")) {
      (void)parse_number_table(bytes, file.name);
    } else if (file.name == "summary.json") {
      auto const zeros = [&](std::string text) {
        std::string const key = "\"summary_sha256\": \"";
        auto const place = text.find(key);
        if (place != text.npos && place + key.size() + unsealed().size() <= text.size())
          text.replace(place + key.size(), unsealed().size(), unsealed());
        return text;
      };
      if (std::string const text = zeros(bytes); text.find(unsealed()) != text.npos) (void)sealed_summary(text);
    } else {
      json const outer = json::from_cbor(file.bytes);
      json::binary_t const& inner = outer.at("content").get_binary();
      std::string const changed = mutator(std::string(inner.begin(), inner.end()));
      if (!is_plain_cbor(changed)) return;
      json const content = json::from_cbor(changed, true, false);
      if (!content.is_discarded() && file.name == "report.cbor" && moderate(content))
        (void)read_record(sealed_cbor(content, outer.at("form").get<int>()), file.name);
    }
  } catch (UserError const&) {
  } catch (std::bad_alloc const&) {
  }
}

}  // namespace

std::vector<StoredFile> write_example(fs::path const& folder) {
  write_result(example::duffing(12), folder, {});
  put(folder / "checkpoint.cbor", checkpoint());
  std::vector<StoredFile> files;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder)) {
    std::string const name = entry.path().filename();
    if (name != "summary.json" && name != "report.cbor" && name != "checkpoint.cbor" && !is_stored_table(name)) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    files.push_back({name, {std::istreambuf_iterator<char>(in), {}}});
  }
  std::sort(files.begin(), files.end(), [](StoredFile const& a, StoredFile const& b) { return a.name < b.name; });
  return files;
}

Outcome mutate(fs::path const& folder, StoredFile const& file, std::uint64_t count, std::uint64_t seed) {
  Outcome outcome;
  Mutator mutator({seed, Purpose::test, std::hash<std::string>()(file.name), 0});
  std::string const meant = read_back(folder, file, file.bytes);
  for (std::uint64_t i = 0; i < count && outcome.fault.empty(); ++i) {
    std::string const changed = mutator(file.bytes);
    put(folder / file.name, changed);
    try {
      bool const same = read_back(folder, file, changed) == meant;
      ++(same ? outcome.same : outcome.refused);
      if (!same) outcome.fault = file.name + ": read as something else: " + changed;
      if (same && changed != file.bytes && file.name != "checkpoint.cbor" && file.name != "report.cbor")
        outcome.fault = file.name + ": a change was not seen: " + changed;
    } catch (UserError const&) {
      ++outcome.refused;
    } catch (IoError const&) {
      ++outcome.refused;
    }
    read_forged(file, changed, mutator);
  }
  put(folder / file.name, file.bytes);
  return outcome;
}

}  // namespace sysid::fuzz

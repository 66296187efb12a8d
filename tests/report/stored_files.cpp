// Results that were changed behind the back of the program are refused; whole ones are read.
#include "report/file/stored_files.hpp"

#include <doctest/doctest.h>

#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/system/files.hpp"
#include "example.hpp"
#include "fuzz/stored.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/sealed_cbor.hpp"
#include "report/file/task_folder.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
namespace fs = std::filesystem;

namespace {

std::string refusal(fs::path const& folder) {
  try {
    read_whole_summary(folder);
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E6209");
    CHECK(error.diagnostic().help == "run the task again with --force");
    std::string message = error.what();
    for (auto at = message.find(folder.string() + "/"); at != message.npos; at = message.find(folder.string() + "/"))
      message.erase(at, folder.string().size() + 1);
    return message;
  }
  return "";
}

}  // namespace

TEST_CASE("a result with a file missing, cut short, changed or too many is refused, and a whole one is not") {
  TemporaryFolder const folder;
  write_result(example::duffing(20), folder.path(), {});
  CHECK(refusal(folder.path()) == "");
  write_file(folder.path() / "notes.txt", "mine");
  write_file(folder.path() / "report.html", "made again");  // what is not read back may change
  CHECK(refusal(folder.path()) == "");

  fs::path const draws = folder.path() / "draws_2.csv";
  std::string const content = read_file(draws);
  remove_file(draws);
  CHECK(refusal(folder.path()) == "`draws_2.csv`, a file of this result, is missing");
  write_file(draws, content.substr(0, content.rfind('\n', content.size() / 4) + 1));
  CHECK(refusal(folder.path()) == "`draws_2.csv` has been changed since it was written");
  write_file(draws, content);
  write_file(folder.path() / "draws_5.csv", content);
  CHECK(refusal(folder.path()) == "`draws_5.csv` does not belong to the result in its folder");
  remove_file(folder.path() / "draws_5.csv");
  make_folder(folder.path() / "draws_of_before.csv");  // the user's
  CHECK(refusal(folder.path()) == "");

  fs::create_directory(folder.path() / "draws_6.csv");  // the user's, who may call a folder what he likes
  CHECK(refusal(folder.path()) == "");

  fs::path const summary = folder.path() / "summary.json";
  std::string text = read_file(summary);
  text.replace(text.find("\"seed\": 1"), 9, "\"seed\": 2");
  write_file(summary, text);
  CHECK(refusal(folder.path()) == "`summary.json` has been changed since it was written");
  write_file(summary, "{\"task\": 1}");
  CHECK(refusal(folder.path()) == "`summary.json` is not the result of a task");
  write_file(summary, "{\"versions\": {}}");
  CHECK(refusal(folder.path()) == "`" + folder.path().string() + "` was written by an older version of sysid");
  write_file(summary, std::string(1000000, '['));
  CHECK(refusal(folder.path()) == "`summary.json` is not the result of a task");
}

TEST_CASE("lengths that no memory holds are damage, errors of ours pass on") {
  auto const reading = [](auto const& error) { interpreted("report.cbor", [&] { throw error; }); };
  CHECK_THROWS_AS(reading(std::bad_alloc()), UserError);
  CHECK_THROWS_AS(reading(std::length_error("")), UserError);
  CHECK_THROWS_AS(reading(InternalError("")), InternalError);
}

TEST_CASE("a whole file with other content than is written is damaged") {
  TemporaryFolder const folder;
  write_result(example::duffing(20), folder.path(), {});
  fs::path const path = folder.path() / "summary.json";
  auto const original = nlohmann::ordered_json::parse(read_file(path));
  auto const refusal_of = [&](char const* pointer, nlohmann::ordered_json const& value) {
    auto forged = original;
    forged[nlohmann::ordered_json::json_pointer(pointer)] = value;
    forged["versions"]["summary_sha256"] = unsealed();
    write_file(path, sealed_summary(forged.dump(2) + "\n"));
    return refusal(folder.path());
  };
  CHECK(refusal_of("/seed", 2) == "");
  CHECK(refusal_of("/versions/files", 3) == "`summary.json` is damaged");
  CHECK(refusal_of("/versions/files", {{"draws_1.csv", 7}}) == "`summary.json` is damaged");
  CHECK(refusal_of("/versions/form", "one") == "`summary.json` is damaged");

  Report const report = example::duffing(20);
  nlohmann::json const outer = nlohmann::json::from_cbor(record_bytes(report));
  nlohmann::json const content = nlohmann::json::from_cbor(outer.at("content").get_binary());
  auto const read = [&](char const* pointer, nlohmann::json const& value) {
    nlohmann::json forged = content;
    forged[nlohmann::json::json_pointer(pointer)] = value;
    return read_record(sealed_cbor(forged, outer.at("form").get<int>()), "report.cbor");
  };
  CHECK(read("/seed", 5).seed == 5);
  CHECK_THROWS_AS(read("/seed", "five"), UserError);
  CHECK_THROWS_AS(read("/draws/chains/0/0", std::uint64_t{1} << 62), UserError);
  CHECK_THROWS_AS(read("/draws/chains/0/1", std::uint64_t{1} << 40), UserError);
}

TEST_CASE("CBOR of any depth and length is an answer") {
  nlohmann::json content;
  std::string const whole = sealed_cbor({{"numbers", {1, 2.5, nullptr, true}}, {"text", "a"}}, 3);
  CHECK(open_cbor(whole, 3, content) == Seal::whole);
  CHECK(content["numbers"][1] == 2.5);
  CHECK(open_cbor(whole, 4, content) == Seal::other_form);
  for (char const byte : {'\x81', '\x9f', '\x7f', '\x5f', '\xa1', '\xc1'})
    CHECK(open_cbor(std::string(1000000, byte), 3, content) == Seal::damaged);
  CHECK_FALSE(is_plain_cbor("\x9b\xff\xff\xff\xff\xff\xff\xff\xff"));  // an array of 2^64 - 1
  for (std::size_t size = 0; size < whole.size(); ++size) CHECK(open_cbor(whole.substr(0, size), 3, content) == Seal::damaged);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string changed = whole;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
    CHECK(open_cbor(changed, 3, content) != Seal::whole);
  }
}

TEST_CASE("no change of a stored file is read as another number") {
  TemporaryFolder const folder;
  auto const files = fuzz::write_example(folder.path());
  CHECK(files.size() >= 6);
  std::uint64_t refused = 0;
  for (auto const& file : files) {
    fuzz::Outcome const outcome = fuzz::mutate(folder.path(), file, 2000 / files.size(), 20);
    CHECK_MESSAGE(outcome.fault == "", file.name);
    refused += outcome.refused;
  }
  CHECK(refused > 1900);
}

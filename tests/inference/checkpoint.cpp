// Checkpoints come back bit for bit through CBOR.
#include "inference/backend/checkpoint.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "inference/targets.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("doubles survive storing to the last bit, infinities, zeros and NaN included") {
  using limits = std::numeric_limits<double>;
  std::vector<double> const values = {0.1,
                                      -0.0,
                                      1.0 / 3,
                                      infinity,
                                      -infinity,
                                      limits::quiet_NaN(),
                                      -limits::quiet_NaN(),
                                      limits::signaling_NaN(),
                                      limits::denorm_min(),
                                      limits::max()};
  for (std::size_t n = 0; n <= values.size(); ++n) {
    std::vector<double> const part(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
    nlohmann::json const stored = {{"block", checkpoint::encode(part)}};
    nlohmann::json const back = nlohmann::json::from_cbor(nlohmann::json::to_cbor(stored));
    std::vector<double> const read = checkpoint::decode(back.at("block"));
    REQUIRE(read.size() == n);
    if (n > 0) CHECK(std::memcmp(read.data(), part.data(), n * sizeof(double)) == 0);
  }
}

TEST_CASE("damaged numbers are refused, not guessed") {
  CHECK_THROWS_AS(checkpoint::decode("AAAAAAAA8D8"), checkpoint::Mismatch);  // text, as an older format stored numbers
  CHECK_THROWS_AS(checkpoint::decode(nlohmann::json::binary({1, 2, 3})), checkpoint::Mismatch);
  CHECK_THROWS_AS(checkpoint::decode(checkpoint::encode(std::vector<double>{1, 2, 3}), 2, 2), checkpoint::Mismatch);
  CHECK_THROWS_AS(checkpoint::decode(checkpoint::encode(std::vector<double>{1, 2, 3}), 3, -1), checkpoint::Mismatch);
}

TEST_CASE("ledgers and modes survive storing") {
  Ledger ledger;
  ledger.add_solves(12345678901234ULL);
  ledger.add_failure(FailureClass::step_limit, "k3*y^3", infinity, {1, -0.0}, 7, {"k", "c"});
  Ledger const back = checkpoint::decode_ledger(checkpoint::encode(ledger));
  CHECK(back.solves() == ledger.solves());
  REQUIRE(back.failures().size() == 1);
  CHECK(back.failures()[0].where == "k3*y^3");
  CHECK(back.failures()[0].kind == FailureClass::step_limit);
  CHECK(back.failures()[0].count == 7);
  CHECK(back.failures()[0].time == infinity);
  CHECK(back.failures()[0].names == std::vector<std::string>{"k", "c"});

  Mode const mode{{1, 2}, {3, 4}, {5, 6}, {7, 8, 9, 10}, -1.5, 2.5, 0.125, 3, {0.5, -0.5}};
  Mode const read = checkpoint::decode_mode(checkpoint::encode(mode));
  CHECK(read.theta == mode.theta);
  CHECK(read.declared == mode.declared);
  CHECK(read.sd == mode.sd);
  CHECK(read.covariance == mode.covariance);
  CHECK(read.log_density == mode.log_density);
  CHECK(read.log_mass == mode.log_mass);
  CHECK(read.share == mode.share);
  CHECK(read.hits == mode.hits);
  CHECK(read.flat == mode.flat);
  Mode torn = mode;
  torn.covariance.pop_back();
  CHECK_THROWS_AS(checkpoint::decode_mode(checkpoint::encode(torn)), checkpoint::Mismatch);
}

TEST_CASE("a checkpoint knows its run, and says what differs") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows = w; });
  Settings settings;
  settings.set("samples", std::int64_t{10});
  nlohmann::json const own = checkpoint::identity("mh", settings, 1, target);
  CHECK_FALSE(checkpoint::refuse({{"identity", own}}, own));
  settings.set("samples", std::int64_t{11});
  auto const refused = checkpoint::refuse({{"identity", own}}, checkpoint::identity("mh", settings, 1, target));
  REQUIRE(refused);
  CHECK(refused->message.find("settings") != std::string::npos);
  CHECK(checkpoint::refuse(nlohmann::json::array(), own));
  CHECK(checkpoint::refuse({{"iteration", 3}}, own));
}

TEST_CASE("a checkpoint of candidates knows them") {
  Settings settings;
  settings.set("samples", std::int64_t{10});
  nlohmann::json const own = checkpoint::identity("abc_smc", settings, 1, nlohmann::json::array({"a", "b"}));
  CHECK_FALSE(checkpoint::refuse({{"identity", own}}, own));
  auto const refused =
      checkpoint::refuse({{"identity", own}}, checkpoint::identity("abc_smc", settings, 1, nlohmann::json::array({"a"})));
  REQUIRE(refused);
  CHECK(refused->message.find("models differs") != std::string::npos);
}

TEST_CASE("a state is stored where checkpoints are wanted, and in between no more often than they are") {
  Ledger ledger;
  SilentProgress progress;
  int given = 0, asked = 0;
  RunContext context{1, progress, ledger, {}, {}, 60, {}, {}, {}};
  auto const state = [&] { return nlohmann::json(++asked); };
  checkpoint::Saver(context, state).save();
  CHECK(asked == 0);
  context.checkpoint = [&](nlohmann::json const&) { ++given; };
  context.checkpoint_interval = 1e9;
  checkpoint::Saver saver(context, state);
  saver.save_sometimes();
  CHECK(given == 0);
  saver.save();
  CHECK(given == 1);
  context.checkpoint_interval = 0;
  saver.save_sometimes();
  CHECK(given == 2);
  CHECK(asked == 2);
}

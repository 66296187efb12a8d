// A slip in the syntax hides no other mistake, and makes none.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

// The codes of all errors, in the order of the text.
std::string codes(std::string const& text) {
  std::string const shown = messages(text);
  std::string found;
  for (std::size_t at = shown.find("error["); at != std::string::npos; at = shown.find("error[", at + 1))
    found += (found.empty() ? "" : " ") + shown.substr(at + 6, 5);
  return found;
}

std::string const slip = "let broken = (2*k 3)\n";  // E1105

std::string model_with(std::string const& statements) {
  return "model m {\ninput x [N]\nstate y [m]\ninitial y = 0\nparameter k [N/m] ~ normal(1, sd = 1)\n" + statements +
         "1 [N s/m]*y' = x - k*y\nobserve displacement ~ normal(y, sd = 1)\n}\n";
}
std::string const data_block =
    "data d {\nfile \"d.csv\"\ntime t [s]\ninput x = x [N] hold linear\nmeasure displacement = y [m]\n}\n";

}  // namespace

TEST_CASE("errors in statements that can be read are told beside an error of syntax") {
  CHECK(codes(model_with(slip)) == "E1105");
  CHECK(codes(model_with(slip + "let a = kk\n")) == "E1105 E2001");
  CHECK(codes(model_with(slip + "let a = y + k\n")) == "E1105 E2103");
  CHECK(codes(model_with(slip + "parameter q ~ norml(0, sd = 1)\nlet a = sinn(2)\n")) == "E1105 E2101 E2003");
  CHECK(codes(model_with(slip) + "data d {\nfile \"d.csv\"\nrate -1 [Hz]\n}\n") == "E1105 E4107");
  CHECK(codes(model_with(slip) + "model n {\nstate y [m]\nobserve d ~ normal(y, sd = 1)\n}\n") == "E1105 E3001");
}

TEST_CASE("what an unreadable statement may declare, determine or observe is not missed") {
  CHECK(codes(model_with("let broken = (2*k 3)\nlet a = broken\n")) == "E1105");
  CHECK(codes("model m {\nstate y [m]\ninitial y 0\nparameter k [1/s] ~ normal(1, sd = 1)\ny' = k y\nobserve d ~ normal(y, sd = "
              "1)\n}\n") == "E1101 E1105");
  std::string const unobserved =
      "model m {\nstate y [m]\ninitial y = 0\nparameter k [1/s] ~ normal(1, sd = 1)\ny' = -k*y\nobserve d normal(y, sd = 1)\n}\n";
  CHECK(codes(unobserved + "data b {\nfile \"d.csv\"\ntime t [s]\nmeasure d = y [m]\n}\nfit m to b with mh\n") == "E1113");
  // Of a damaged model, data block or fit nothing is asked.
  CHECK(codes(model_with(slip) + data_block + "p = fit m to d with map\nf = predict p on d with draws(2)\n") == "E1105");
  CHECK(codes(model_with("") + "data d {\nfile \"d.csv\"\ntime t [s] [s]\n}\np = fit m to d with map\n") == "E1118");
  CHECK(codes(model_with("") + data_block + "p = fit m too d with map\nf = predict p on d with draws(2)\n").substr(0, 2) == "E1");
  CHECK(codes(model_with("") + data_block + "p = fit m too d with map\nf = predict p on d with draws(2)\n").find(' ') ==
        std::string::npos);
}

TEST_CASE("what cannot be read between the items may be a model, a function or a module") {
  std::string const rig =
      "model m {\ninput x [N]\nstate y [m]\ninitial y = 0, y' = 0\npart joint = bouc_wen(displacement = y)\n"
      "1 [kg]*y'' + joint.force = x\nobserve d ~ normal(y, sd = 1)\n}\n";
  CHECK(codes("ues hysteresis\n" + rig) == "E1110");
  CHECK(codes("ues hysteresis\n" + rig + "model n {\nstate y [m]\ninitial y = 0\ny' = zz\n}\n") == "E1110 E2001");
}

TEST_CASE("behind a data block that does not end nothing is believed") {
  std::string const open = "model m {\nstate y [m]\nlet a = zz\n";
  CHECK(codes(open) == "E1102");
}

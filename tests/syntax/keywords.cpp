// Keywords are contextual; every statement gives its node.
#include "parsing.hpp"
#include "syntax/words.hpp"

using namespace sysid;
using test::parsed;
using test::statements;

namespace {

template <class Node>
Node only(std::string const& body) {
  auto const all = statements(body);
  REQUIRE(all.size() == 1);
  REQUIRE(std::holds_alternative<Node>(all[0]));
  return std::get<Node>(all[0]);
}

template <class Node>
Node only_data(std::string const& body) {
  ast::File const file = parsed("data d {\n" + body + "\n}");
  auto const& all = std::get<ast::Data>(file.items.at(0)).statements;
  REQUIRE(all.size() == 1);
  REQUIRE(std::holds_alternative<Node>(all[0]));
  return std::get<Node>(all[0]);
}

ast::Task only_task(std::string const& text) { return std::get<ast::Task>(parsed(text).items.at(0)); }

}  // namespace

TEST_CASE("a keyword followed by what continues an expression is a name in an equation") {
  for (std::string_view const view : words::model_statements) {
    std::string const word(view);
    CAPTURE(word);
    only<ast::Equation>(word + " + 3*y = x");
    only<ast::Equation>(word + " = 4");
    only<ast::Equation>(word + "*y' = 3");
    only<ast::Equation>(word + "' = 3");
    only<ast::Equation>(word + "(y) = 3");
    only<ast::Equation>(word + " and a = b");
    only<ast::Definition>("let " + word + " = " + word + " - " + word);
    CHECK(only<ast::ParameterDeclaration>("parameter " + word + " [kg]").name.name.text == word);
  }
}

TEST_CASE("the words of tasks and data blocks are names elsewhere") {
  for (std::string const word :
       {"model", "data", "fit",     "simulate", "predict", "with", "to",    "on", "from", "hold", "rows", "file",
        "rate",  "step", "measure", "split",    "alpha",   "beta", "gamma", "n",  "A",    "x",    "y",    "t"}) {
    CAPTURE(word);
    only<ast::Equation>(word + "' = 2*" + word);
    CHECK(only<ast::StateDeclaration>("state " + word).names.at(0).name.text == word);
    CHECK(only_task(word + " = fit " + word + " to " + word + "." + word).name->text == word);
    CHECK(std::get<ast::Model>(parsed("model " + word + " { }").items.at(0)).name.text == word);
    CHECK(only_data<ast::DataInput>("input " + word + " = " + word + " hold " + word).column.name == word);
  }
}

TEST_CASE("a keyword is a whole word") {
  only<ast::Equation>("statey = 3");
  only<ast::Equation>("let_a = 3");
  only<ast::Equation>("inputµ = 3");
}

TEST_CASE("each declaration of a model gives its node") {
  CHECK(only<ast::TimeDeclaration>("time t [s]").time.name.text == "t");
  CHECK(only<ast::InputDeclaration>("input x [N], u [V], v").names.size() == 3);
  auto const initial = only<ast::InitialDeclaration>("initial y = 0, y' = v0");
  REQUIRE(initial.values.size() == 2);
  CHECK(initial.values[1].state.primes == 1);
  auto const prior = only<ast::ParameterDeclaration>("parameter m [kg] ~ log_uniform(0.1, 10)");
  CHECK(prior.name.unit.has_value());
  CHECK(prior.prior->function.text == "log_uniform");
  CHECK_FALSE(prior.value.has_value());
  CHECK(only<ast::ParameterDeclaration>("parameter m = 1 [kg]").value.has_value());
  CHECK(only<ast::Definition>("constant g [m/s^2] = 9.81").kind == ast::DefinitionKind::constant);
  CHECK(only<ast::Definition>("let w0 = sqrt(k/m)").kind == ast::DefinitionKind::local);
  CHECK(only<ast::Definition>("derive fn [Hz] = w0/(2*pi)").kind == ast::DefinitionKind::derived);
  CHECK(only<ast::FunctionDefinition>("function f(a, b) = a*b").parameters.size() == 2);
  auto const observation = only<ast::Observation>("observe displacement [m] ~ normal(y, precision = beta)");
  CHECK(observation.channel.name.text == "displacement");
  CHECK(observation.noise.arguments.at(1).name->text == "precision");
  CHECK(only<ast::Equation>("m*y'' + c*y' + k*y + k3*y^3 = x") == only<ast::Equation>("((m*y'' + c*y') + k*y) + (k3*(y^3)) = x"));
}

TEST_CASE("each statement of a data block gives its node") {
  CHECK(only_data<ast::DataFile>("file \"a b.csv\"").path.value == "a b.csv");
  CHECK(only_data<ast::DataTime>("time \"t / s\" [s]").column.name == "t / s");
  CHECK_FALSE(only_data<ast::DataRate>("rate 1000 [Hz]").step);
  CHECK(only_data<ast::DataRate>("step 1 [ms]").step);
  auto const input = only_data<ast::DataInput>("input x = force [N] hold zero_order");
  CHECK(input.rule->text == "zero_order");
  CHECK(input.column.unit.has_value());
  CHECK_FALSE(only_data<ast::DataInput>("input x = force").rule.has_value());
  CHECK(only_data<ast::DataMeasure>("measure displacement = y_noisy [mm]").channel.text == "displacement");
  auto const reading =
      only_data<ast::DataReading>("read names = 4, values = 7..106, missing = (\"NaN\", -9999, none), separator = tab");
  REQUIRE(reading.settings.size() == 4);
  CHECK(reading.settings[0].items.at(0).value == "4");
  CHECK(reading.settings[1].range);
  CHECK(reading.settings[1].items.at(1).value == "106");
  CHECK(reading.settings[2].items.at(0).quoted);
  CHECK(reading.settings[2].items.at(1).value == "-9999");
  CHECK(reading.settings[2].items.at(2).value == "none");
  CHECK(reading.settings[3].items.at(0).value == "tab");
  auto const split = only_data<ast::DataSplit>("split train = rows 1..500, test = rows 501 .. n - 1");
  REQUIRE(split.parts.size() == 2);
  CHECK(std::get<ast::Number>(split.parts[0].last.node).value == 500);
  CHECK(unparse(split.parts[1].last) == "n - 1");
}

TEST_CASE("candidates are models with arguments and a probability, and what they share") {
  auto const set = std::get<ast::Candidates>(
      parsed(
          "candidates laws \"which law?\" {\nlinear\nbouc_wen(n = 1..4, m = (1, 3)) probability 1/16\nshared m, spring.k, q[1]\n}")
          .items.at(0));
  CHECK(set.name.text == "laws");
  CHECK(set.title->value == "which law?");
  REQUIRE(set.statements.size() == 3);
  auto const& linear = std::get<ast::Candidate>(set.statements[0]);
  CHECK(linear.model.text == "linear");
  CHECK(linear.arguments.empty());
  CHECK_FALSE(linear.probability.has_value());
  auto const& family = std::get<ast::Candidate>(set.statements[1]);
  CHECK(family.arguments.size() == 2);
  CHECK(unparse(family.arguments[0].value) == "1..4");
  CHECK(unparse(*family.probability) == "1/16");
  CHECK(std::get<ast::SharedParameters>(set.statements[2]).names.at(2).text == "q[1]");
  auto const one_line =
      std::get<ast::Candidates>(parsed("candidates c { linear; shared; shared probability 1; shared x }").items.at(0));
  REQUIRE(one_line.statements.size() == 4);
  CHECK(std::get<ast::Candidate>(one_line.statements[1]).model.text == "shared");
  CHECK(std::get<ast::Candidate>(one_line.statements[2]).probability.has_value());
  CHECK(std::holds_alternative<ast::SharedParameters>(one_line.statements[3]));
  CHECK(only_task("candidates = fit candidates to d").name->text == "candidates");
}

TEST_CASE("a dictionary binds states to channels and lists targets, terms and units") {
  auto const dictionary = std::get<ast::Dictionary>(
      parsed("dictionary d \"which?\" {\ninput x [N], u\nstate y [m] = q[1], y'' [m/s^2] = a\nparameter m [kg]; parameter k = 2\n"
             "target = m*y'' - x\nterms = polynomial(y, y', degree = 3),\n  1\nexclude = y^2\ncoefficients = [N/m], [-]\n}")
          .items.at(0));
  CHECK(dictionary.title->value == "which?");
  REQUIRE(dictionary.statements.size() == 8);
  auto const& states = std::get<ast::DictionaryStates>(dictionary.statements[1]).states;
  CHECK(states.at(0).channel->text == "q[1]");
  CHECK(states.at(1).primes == 2);
  CHECK(states.at(1).unit.has_value());
  CHECK_FALSE(std::get<ast::DictionaryParameter>(dictionary.statements[2]).value.has_value());
  CHECK(std::get<ast::DictionaryParameter>(dictionary.statements[3]).value.has_value());
  CHECK(std::get<ast::DictionaryList>(dictionary.statements[4]).kind == ast::DictionaryListKind::target);
  CHECK(std::get<ast::DictionaryList>(dictionary.statements[5]).items.size() == 2);
  CHECK(std::get<ast::DictionaryList>(dictionary.statements[6]).kind == ast::DictionaryListKind::exclude);
  CHECK(std::get<ast::CoefficientUnits>(dictionary.statements[7]).units.size() == 2);
  CHECK(only_task("dictionary = discover discover from target").name->text == "dictionary");
}

TEST_CASE("tasks have an optional name, a place and options") {
  ast::Task const simulate =
      only_task("truth = simulate duffing with values(m = 1), input x = gaussian(sd = 10), noise = 1 [percent], seed = 1");
  CHECK(simulate.name->text == "truth");
  CHECK(simulate.data.empty());
  REQUIRE(simulate.options.size() == 4);
  CHECK_FALSE(simulate.options[0].key.has_value());
  CHECK(simulate.options[1].input);
  CHECK(simulate.options[1].key->text == "x");
  CHECK_FALSE(simulate.options[2].input);
  CHECK(simulate.options[2].key->text == "noise");
  ast::Task const fit = only_task("fit duffing to bench.train with mh(samples = 25000, chains = 4), start = estimated(rows = 50)");
  CHECK_FALSE(fit.name.has_value());
  CHECK(fit.preposition->text == "to");
  CHECK(fit.data.front().part->text == "train");
  ast::Task const predict = only_task("forecast = predict posterior on bench");
  CHECK(predict.verb.text == "predict");
  CHECK(predict.subject.text == "posterior");
  CHECK_FALSE(predict.data.front().part.has_value());
  ast::Task const average = only_task("predict posterior, other, third on bench, hall.test with draws(20)");
  REQUIRE(average.others.size() == 2);
  CHECK(average.others[1].text == "third");
  CHECK(average.data.size() == 2);
  CHECK(average.called() == "predict_posterior_other_third");
  CHECK_FALSE(only_task("fit a with input = 3").options.at(0).input);
  CHECK_FALSE(only_task("fit a with input").options.at(0).key.has_value());
}

TEST_CASE("a model may have a title, a file functions") {
  CHECK(std::get<ast::Model>(parsed("model duffing \"Duffing's oscillator\" { }").items.at(0)).title->value ==
        "Duffing's oscillator");
  CHECK(std::holds_alternative<ast::FunctionDefinition>(parsed("function f() = 1").items.at(0)));
}

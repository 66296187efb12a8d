// The syntax tree: what the user wrote, in the user's order, with places. No meaning is attached here. Statements, blocks and
// files; expressions and units: ast_expression.hpp.
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "syntax/ast_expression.hpp"

namespace sysid::ast {

// --- inside a model ---

/// `time t [s]`.
struct TimeDeclaration : Located {
  Declared time;
  friend bool operator==(TimeDeclaration const&, TimeDeclaration const&) = default;
};
/// `time discrete 0.25 [s]`: one step from each sample to the next; `step` may be left to the data.
struct DiscreteTimeDeclaration : Located {
  std::optional<Expression> step;
  friend bool operator==(DiscreteTimeDeclaration const&, DiscreteTimeDeclaration const&) = default;
};
/// `input x [N], u [V]`.
struct InputDeclaration : Located {
  std::vector<Declared> names;
  friend bool operator==(InputDeclaration const&, InputDeclaration const&) = default;
};
/// `state y [m], z`.
struct StateDeclaration : Located {
  std::vector<Declared> names;
  friend bool operator==(StateDeclaration const&, StateDeclaration const&) = default;
};
/// `disturbance w [N] ~ white(intensity = q)`: what moves the states and was not measured.
struct DisturbanceDeclaration : Located {
  Declared name;
  Call law;
  friend bool operator==(DisturbanceDeclaration const&, DisturbanceDeclaration const&) = default;
};
/// `initial y = 0, y' = v0`; at random: `initial y ~ normal(0, sd = 0.1)`. One of both.
struct InitialValue : Located {
  Reference state;
  std::optional<Expression> value;
  std::optional<Call> law;
  friend bool operator==(InitialValue const&, InitialValue const&) = default;
};
struct InitialDeclaration : Located {
  std::vector<InitialValue> values;
  friend bool operator==(InitialDeclaration const&, InitialDeclaration const&) = default;
};
/// `parameter m [kg] ~ log_uniform(0.1, 10)`, `parameter m [kg] = 1`; neither: `prior` and `value` empty, which the checker
/// refuses.
struct ParameterDeclaration : Located {
  Declared name;
  std::optional<Call> prior;
  std::optional<Expression> value;
  friend bool operator==(ParameterDeclaration const&, ParameterDeclaration const&) = default;
};
/// `constant g [m/s^2] = 9.81`, `let w0 = sqrt(k/m)`, `derive fn [Hz] = w0/(2*pi)`.
enum class DefinitionKind { constant, local, derived };
struct Definition : Located {
  DefinitionKind kind = DefinitionKind::local;
  Declared name;
  Expression value;
  friend bool operator==(Definition const&, Definition const&) = default;
};
/// `function f(a, b) = a*b`.
struct FunctionDefinition : Located {
  Name name;
  std::vector<Name> parameters;
  Expression value;
  friend bool operator==(FunctionDefinition const&, FunctionDefinition const&) = default;
};
/// `function d(u, v) ~ gp(matern52(amplitude = s, length = (lu, lv)))`: an unknown function of the inputs named.
struct ProcessDefinition : Located {
  Name name;
  std::vector<Name> inputs;
  Call process;
  friend bool operator==(ProcessDefinition const&, ProcessDefinition const&) = default;
};
/// `observe displacement [m] ~ normal(y, precision = beta)`; the unit may be left out.
struct Observation : Located {
  Declared channel;
  Call noise;
  friend bool operator==(Observation const&, Observation const&) = default;
};
/// `part spring = bouc_wen(n = 2, displacement = y)`: another model inside this one; its names are `spring.k`, ...
struct Part : Located {
  Name name;
  Call model;
  friend bool operator==(Part const&, Part const&) = default;
};
/// `m*y'' + c*y' = x`.
struct Equation : Located {
  Expression left, right;
  friend bool operator==(Equation const&, Equation const&) = default;
};

using ModelStatement = std::variant<TimeDeclaration, DiscreteTimeDeclaration, InputDeclaration, StateDeclaration,
                                    DisturbanceDeclaration, InitialDeclaration, ParameterDeclaration, Definition,
                                    FunctionDefinition, ProcessDefinition, Observation, Part, Equation>;

/// `n`, `n = 2`: an argument of a model, a whole number known when the model is used.
struct ModelArgument : Located {
  Name name;
  std::optional<Expression> value;
  friend bool operator==(ModelArgument const&, ModelArgument const&) = default;
};

/// `model duffing "Duffing's oscillator" { ... }`, `model bouc_wen(n) { ... }`.
struct Model : Located {
  Name name;
  std::vector<ModelArgument> arguments;
  std::optional<Text> title;
  std::vector<ModelStatement> statements;
  friend bool operator==(Model const&, Model const&) = default;
};

// --- inside a data block ---

/// A column by its name: an identifier or a text.
struct Column : Located {
  std::string name;
  std::optional<UnitExpression> unit;
  friend bool operator==(Column const&, Column const&) = default;
};
/// `file "duffing.csv"`.
struct DataFile : Located {
  Text path;
  friend bool operator==(DataFile const&, DataFile const&) = default;
};
/// `time t [s]`: the column that holds time.
struct DataTime : Located {
  Column column;
  friend bool operator==(DataTime const&, DataTime const&) = default;
};
/// `rate 1000 [Hz]` or `step 1 [ms]`: equally spaced rows, time 0 at the first.
struct DataRate : Located {
  bool step = false;
  Expression value;
  friend bool operator==(DataRate const&, DataRate const&) = default;
};
/// `input x = force [N] hold zero_order error normal(sd = 0.5)`; the rule must be given (its absence is refused by the checker),
/// the error where the column has one.
struct DataInput : Located {
  Name input;
  Column column;
  std::optional<Name> rule;
  std::optional<Call> error;
  friend bool operator==(DataInput const&, DataInput const&) = default;
};
/// `measure displacement = y_noisy [mm]`.
struct DataMeasure : Located {
  Name channel;
  Column column;
  friend bool operator==(DataMeasure const&, DataMeasure const&) = default;
};
/// `constant dose = 30 [mg]`: what a parameter is in this experiment.
struct DataConstant : Located {
  Name parameter;
  Expression value;
  friend bool operator==(DataConstant const&, DataConstant const&) = default;
};
/// `split train = rows 1..500, test = rows 501..1500`; rows count from 1, both ends included.
struct SplitPart : Located {
  Name name;
  Expression first, last;
  friend bool operator==(SplitPart const&, SplitPart const&) = default;
};
struct DataSplit : Located {
  std::vector<SplitPart> parts;
  friend bool operator==(DataSplit const&, DataSplit const&) = default;
};

/// `","`, `NaN`, `-9999`: a text, or a word or number as it is written.
struct ReadingItem : Located {
  std::string value;
  bool quoted = false;
  friend bool operator==(ReadingItem const&, ReadingItem const&) = default;
};
/// `names = 4`, `values = 7..106`, `missing = ("NaN", "-9999")`.
struct ReadingSetting : Located {
  Name name;
  std::vector<ReadingItem> items;
  bool range = false;  // two items with `..` between them
  friend bool operator==(ReadingSetting const&, ReadingSetting const&) = default;
};
/// `read decimal = ",", names = 4`: how the file is written.
struct DataReading : Located {
  std::vector<ReadingSetting> settings;
  friend bool operator==(DataReading const&, DataReading const&) = default;
};

using DataStatement = std::variant<DataFile, DataTime, DataRate, DataInput, DataMeasure, DataConstant, DataSplit, DataReading>;

/// `data bench { ... }`.
struct Data : Located {
  Name name;
  std::vector<DataStatement> statements;
  friend bool operator==(Data const&, Data const&) = default;
};

// --- candidate models ---

/// `linear`, `bouc_wen(n = 1..4) probability 0.2`: one model, or several where an argument is a range or a list. The probability is
/// that of each.
struct Candidate : Located {
  Name model;
  std::vector<Argument> arguments;
  std::optional<Expression> probability;
  friend bool operator==(Candidate const&, Candidate const&) = default;
};
/// `shared m, c`: parameters that mean the same in every model that has them.
struct SharedParameters : Located {
  std::vector<Name> names;
  friend bool operator==(SharedParameters const&, SharedParameters const&) = default;
};

using CandidateStatement = std::variant<Candidate, SharedParameters>;

/// `candidates hysteresis "which law?" { ... }`.
struct Candidates : Located {
  Name name;
  std::optional<Text> title;
  std::vector<CandidateStatement> statements;
  friend bool operator==(Candidates const&, Candidates const&) = default;
};

// --- dictionaries ---

/// `y [m] = displacement`, `y'' = acceleration`: a state or a derivative of it, and the channel that measures it.
struct DictionaryState : Located {
  Name name;
  int primes = 0;
  std::optional<UnitExpression> unit;
  std::optional<Name> channel;
  friend bool operator==(DictionaryState const&, DictionaryState const&) = default;
};
/// `state y [m] = displacement, y'' = acceleration`.
struct DictionaryStates : Located {
  std::vector<DictionaryState> states;
  friend bool operator==(DictionaryStates const&, DictionaryStates const&) = default;
};
/// `parameter m [kg]`: a coefficient that is looked for; `parameter m [kg] = 1`: known; `parameter K [mol] ~ uniform(0, 1)`: looked
/// for inside terms.
struct DictionaryParameter : Located {
  Declared name;
  std::optional<Call> prior;
  std::optional<Expression> value;
  friend bool operator==(DictionaryParameter const&, DictionaryParameter const&) = default;
};
/// `target = m*y'' - x`, `terms = polynomial(y, degree = 3), 1`, `exclude = y^2`.
enum class DictionaryListKind { target, terms, exclude };
struct DictionaryList : Located {
  DictionaryListKind kind = DictionaryListKind::terms;
  std::vector<Expression> items;
  friend bool operator==(DictionaryList const&, DictionaryList const&) = default;
};
/// `coefficients = [N/m], [N s/m]`: the units that coefficients may have.
struct CoefficientUnits : Located {
  std::vector<UnitExpression> units;
  friend bool operator==(CoefficientUnits const&, CoefficientUnits const&) = default;
};

using DictionaryStatement = std::variant<TimeDeclaration, DiscreteTimeDeclaration, InputDeclaration, DictionaryStates,
                                         DictionaryParameter, Definition, FunctionDefinition, DictionaryList, CoefficientUnits>;

/// `dictionary restoring "which restoring force?" { ... }`.
struct Dictionary : Located {
  Name name;
  std::optional<Text> title;
  std::vector<DictionaryStatement> statements;
  friend bool operator==(Dictionary const&, Dictionary const&) = default;
};

// --- tasks ---

/// `bench` or `bench.train`.
struct DataReference : Located {
  Name data;
  std::optional<Name> part;
  friend bool operator==(DataReference const&, DataReference const&) = default;
};

/// After `with` or a comma: `mh(samples = 25000)`, `start = rest`, `input x = gaussian(sd = 10)`.
struct Option : Located {
  bool input = false;
  std::optional<Name> key;
  Expression value;
  friend bool operator==(Option const&, Option const&) = default;
};

/// `posterior = fit duffing to bench.train with mh(samples = 25000), start = rest`; `fit bouc_wen(n = 2) to spring, summer`.
struct Task : Located {
  std::optional<Name> name;
  Name verb;                        // simulate, fit, select, discover, predict
  Name subject;                     // a model (simulate, fit), candidates (select), a dictionary (discover) or a task (predict)
  std::vector<Argument> arguments;  // of the model
  std::vector<Name> others;         // further fits, over which a prediction averages
  std::optional<Name> preposition;  // to, on, from
  std::vector<DataReference> data;  // one experiment each
  std::vector<Option> options;
  /// Its name; without one, what it does: "predict_posterior".
  std::string called() const {
    if (name) return name->text;
    std::string all = verb.text + "_" + subject.text;
    for (Name const& other : others) all += "_" + other.text;
    return all;
  }
  friend bool operator==(Task const&, Task const&) = default;
};

/// `use hysteresis`: the models and functions of hysteresis.sysid, beside this file or in the standard library.
struct Use : Located {
  Name module;
  friend bool operator==(Use const&, Use const&) = default;
};

using Item = std::variant<Use, Model, Data, Candidates, Dictionary, FunctionDefinition, Task>;

struct File {
  std::vector<Item> items;
  friend bool operator==(File const&, File const&) = default;
};

}  // namespace sysid::ast

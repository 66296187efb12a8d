// The names of one use of a model inside a whole, and what they stand for there.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "check/elaborate/array.hpp"
#include "check/elaborate/derivative.hpp"
#include "check/elaborate/flatten.hpp"

namespace sysid {

struct Frame;

struct FrameSymbol {
  enum class Kind { time, input, state, disturbance, parameter, definition };
  Kind kind = Kind::parameter;
  ast::Declared const* declared = nullptr;
  Shape shape;
  bool shape_known = true;                 // false: a definition without sizes, before it is looked at
  ast::Expression const* value = nullptr;  // of a definition; of an input or parameter that the whole binds
  Frame* value_frame = nullptr;            // whose names `value` means
  bool evaluating = false, evaluated = false;
  std::optional<Array> array;  // once evaluated, unless that failed

  bool bound() const { return value != nullptr && kind != Kind::definition; }
};

struct Frame {
  Frame* outer = nullptr;
  Instance instance;
  std::string prefix;  // "" or "spring."
  Span use;            // where the part stands
  std::map<std::string, FrameSymbol> symbols;
  std::map<std::string, std::unique_ptr<Frame>> parts;
  std::map<std::string, ast::FunctionDefinition const*> functions;

  ast::Model const& model() const { return *instance.model.tree; }
};

/// Where a path such as `spring.force` leads; nulls where nowhere.
struct Found {
  Frame* frame = nullptr;
  FrameSymbol* symbol = nullptr;
  std::string name;  // in its frame
};
Found find(Frame& frame, std::string const& path);

/// Frames of a model and its parts: names declared, sizes known, arguments of parts told apart and bound.
class FrameBuilder {
 public:
  explicit FrameBuilder(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}
  std::unique_ptr<Frame> build(Instance const& instance);

 private:
  void declare(Frame& frame);
  void declare(Frame& frame, ast::Declared const& declared, FrameSymbol symbol);
  std::optional<Shape> shape_of(Frame const& frame, ast::Declared const& declared);
  void add_part(Frame& frame, ast::Part const& part);
  void bind(Frame& inner, ast::Part const& part);

  Diagnostics& diagnostics_;
  std::size_t frames_ = 0;
  bool too_large_ = false;  // and said so
};

/// Expressions of a model in terms of numbers.
class Evaluator {
 public:
  Evaluator(Diagnostics& diagnostics, std::size_t most_nodes) : diagnostics_(diagnostics), algebra_(diagnostics, most_nodes) {}

  std::optional<Array> evaluate(ast::Expression const& expression, Frame& frame);
  /// The value of a definition or of what is bound, in its shape; computed once, and kept in `symbol`.
  std::optional<Array> value_of(Frame& frame, std::string const& name, FrameSymbol& symbol);
  /// Its arguments, each number by number; lists stay lists.
  std::optional<ast::Call> call_arguments(ast::Call const& call, Frame& frame);
  /// The call once for each element of a shape.
  std::optional<std::vector<ast::Call>> calls(ast::Call const& call, Shape const& shape, Frame& frame);

  ArrayAlgebra& algebra() { return algebra_; }
  /// The name under which the whole knows its time; empty: none.
  std::string time_name;

 private:
  using Locals = std::map<std::string, Array>;
  std::optional<Array> evaluate_node(ast::Expression const& expression, Frame& frame);
  std::optional<Array> reference(ast::Reference const& reference, Frame& frame);
  std::optional<Array> undeclared(ast::Reference const& reference, Frame const& frame);
  std::optional<Array> declared(ast::Reference const& reference, Found const& found, Frame const& frame);
  std::optional<Diagnostic> sample_index(ast::Reference const& reference, Frame const& frame, bool is_channel) const;
  std::optional<Array> element(Array array, ast::Reference const& reference, Frame const& frame);
  std::optional<Array> call(ast::Call const& call, Span span, Frame& frame);
  std::optional<Array> user_function(ast::FunctionDefinition const& function, ast::Call const& call, std::vector<Array> arguments,
                                     Span span, Frame& frame);
  std::optional<Array> array_function(ast::Call const& call, std::vector<Array>& arguments, Span span, Frame const& frame);
  ast::FunctionDefinition const* find_function_definition(Frame const& frame, std::string const& name) const;
  bool is_plain(ast::FunctionDefinition const& function, Frame const& frame,
                std::vector<ast::FunctionDefinition const*>& seen) const;
  std::optional<ast::Expression> rate(ast::Expression expression, int primes, Span use, std::string const& input);
  std::optional<OverTime> motion_of(std::string const& name) const;

  Diagnostics& diagnostics_;
  ArrayAlgebra algebra_;
  Locals const* locals_ = nullptr;
  Environment const* function_home_ = nullptr;  // of the function that is being expanded
  int depth_ = 0;                               // of evaluate
  std::vector<ast::FunctionDefinition const*> expanding_;
  std::map<std::string, ast::Expression> definitions_;  // by flat name
  std::map<std::string, OverTime::Kind> motions_;
};

}  // namespace sysid

// The syntax tree of expressions, units and declared names, of which statements consist (syntax/ast.hpp).
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/text/source.hpp"

namespace sysid::ast {

/// A value on the heap with value semantics: deep copies, deep equality. Lets a variant hold itself.
template <class T>
class Box {
 public:
  Box() : value_(std::make_unique<T>()) {}
  Box(T value) : value_(std::make_unique<T>(std::move(value))) {}
  Box(Box const& other) : value_(std::make_unique<T>(*other.value_)) {}
  Box(Box&&) noexcept = default;
  Box& operator=(Box const& other) { return *this = Box(other); }
  Box& operator=(Box&&) noexcept = default;
  T& operator*() { return *value_; }
  T const& operator*() const { return *value_; }
  T* operator->() { return value_.get(); }
  T const* operator->() const { return value_.get(); }
  friend bool operator==(Box const& a, Box const& b) { return *a == *b; }

 private:
  std::unique_ptr<T> value_;
};

// Spans take no part in equality: parse(unparse(tree)) == tree.
struct Located {
  Span span;
  friend bool operator==(Located const&, Located const&) { return true; }
};

struct Name : Located {
  std::string text;
  friend bool operator==(Name const&, Name const&) = default;
};

struct Expression;
struct UnitExpression;

/// `m`, `s^2`, `s^-1`, `N^(1-n)`, `(m s)`: an atom or a group, a power, and whether a `/` stands before it.
struct UnitFactor : Located {
  std::variant<Name, Box<UnitExpression>> base;  // Name "1" for the digit 1
  std::optional<Box<Expression>> exponent;
  bool reciprocal = false;
  friend bool operator==(UnitFactor const&, UnitFactor const&) = default;
};

/// What stands between `[` and `]`: `[N s/m]`, `[1/m^2]`, `[-]`. Blank and `*` multiply; `/` divides by the next factor only.
struct UnitExpression : Located {
  std::vector<UnitFactor> factors;
  friend bool operator==(UnitExpression const&, UnitExpression const&) = default;
};

/// `9.81`, `9.81 [m/s^2]`.
struct Number : Located {
  double value = 0;
  std::optional<UnitExpression> unit;
  friend bool operator==(Number const&, Number const&) = default;
};

/// `"text"`, without quotes; escapes \" \\ \n resolved.
struct Text : Located {
  std::string value;
  friend bool operator==(Text const&, Text const&) = default;
};

/// `y''`, `spring.force`, `q[2]'`: a name, with those of the parts it lies in before it, its index and how many primes follow it.
struct Reference : Located {
  Name name;                      // the whole path: "spring.force"
  std::vector<Expression> index;  // `[i]` or `[i, j]`; empty: none
  int primes = 0;
  friend bool operator==(Reference const&, Reference const&);
};

/// `- a`, `not a`.
struct Unary : Located {
  std::string symbol;
  Box<Expression> operand;
  friend bool operator==(Unary const&, Unary const&) = default;
};

/// `a + b`; symbols + - * / ^ < <= > >= == != and or .. (range).
struct Binary : Located {
  std::string symbol;
  Box<Expression> left, right;
  friend bool operator==(Binary const&, Binary const&) = default;
};

/// `f(a, sd = b)`: positional and named arguments.
struct Argument;
struct Call : Located {
  Name function;
  std::vector<Argument> arguments;
  friend bool operator==(Call const&, Call const&);
};

/// `if a < b then c else d`.
struct Conditional : Located {
  Box<Expression> condition, then, otherwise;
  friend bool operator==(Conditional const&, Conditional const&) = default;
};

/// `(a, b, c)`: two or more expressions.
struct List : Located {
  std::vector<Expression> items;
  friend bool operator==(List const&, List const&);
};

struct Expression : Located {
  std::variant<Number, Text, Reference, Box<Unary>, Box<Binary>, Box<Call>, Box<Conditional>, Box<List>> node;
  friend bool operator==(Expression const&, Expression const&) = default;
};

struct Argument : Located {
  std::optional<Name> name;
  Expression value;
  friend bool operator==(Argument const&, Argument const&) = default;
};

inline bool operator==(Reference const& a, Reference const& b) {
  return a.name == b.name && a.index == b.index && a.primes == b.primes;
}
inline bool operator==(Call const& a, Call const& b) { return a.function == b.function && a.arguments == b.arguments; }
inline bool operator==(List const& a, List const& b) { return a.items == b.items; }

/// `m [kg]`, `q(3) [m]`, `M(2, 2)`, `k per experiment [N/m]`.
struct Declared : Located {
  Name name;
  std::vector<Expression> sizes;  // of a vector or a matrix; empty: a number
  bool per_experiment = false;    // parameters only
  std::optional<UnitExpression> unit;
  friend bool operator==(Declared const&, Declared const&) = default;
};

}  // namespace sysid::ast

// Formulas of the table `systems` as functions of numbers: + - * / ^, parentheses, exp log sin cos sqrt abs tanh.
#pragma once
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

using Expression = std::function<double(std::vector<double> const&)>;

class ExpressionParser {
 public:
  ExpressionParser(std::string const& text, std::map<std::string, std::size_t> const& places) : places_(places) {
    for (char const c : text)
      if (!std::isspace(static_cast<unsigned char>(c))) text_ += c;
  }
  Expression parse() {
    Expression const whole = sum();
    if (at_ != text_.size()) fail();
    return whole;
  }

 private:
  [[noreturn]] void fail() const { throw std::runtime_error("cannot read `" + text_ + "` at " + std::to_string(at_)); }
  bool take(char c) { return at_ < text_.size() && text_[at_] == c ? (++at_, true) : false; }

  Expression sum() {
    Expression left = product();
    while (true) {
      if (take('+'))
        left = [a = left, b = product()](auto const& x) { return a(x) + b(x); };
      else if (take('-'))
        left = [a = left, b = product()](auto const& x) { return a(x) - b(x); };
      else
        return left;
    }
  }
  Expression product() {
    Expression left = sign();
    while (true) {
      if (take('*'))
        left = [a = left, b = sign()](auto const& x) { return a(x) * b(x); };
      else if (take('/'))
        left = [a = left, b = sign()](auto const& x) { return a(x) / b(x); };
      else
        return left;
    }
  }
  Expression sign() {
    if (take('-')) return [a = sign()](auto const& x) { return -a(x); };
    return power();
  }
  Expression power() {
    Expression const base = atom();
    if (!take('^')) return base;
    return [a = base, b = sign()](auto const& x) { return std::pow(a(x), b(x)); };
  }
  Expression atom() {
    if (take('(')) {
      Expression const inside = sum();
      if (!take(')')) fail();
      return inside;
    }
    if (at_ < text_.size() && (std::isdigit(static_cast<unsigned char>(text_[at_])) || text_[at_] == '.')) {
      char* end = nullptr;
      double const value = std::strtod(text_.c_str() + at_, &end);
      at_ = static_cast<std::size_t>(end - text_.c_str());
      return [value](auto const&) { return value; };
    }
    std::string name;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) name += text_[at_++];
    if (take('(')) {
      Expression const inside = sum();
      if (!take(')')) fail();
      static std::map<std::string, double (*)(double)> const functions{
          {"exp", [](double x) { return std::exp(x); }},   {"log", [](double x) { return std::log(x); }},
          {"sin", [](double x) { return std::sin(x); }},   {"cos", [](double x) { return std::cos(x); }},
          {"sqrt", [](double x) { return std::sqrt(x); }}, {"abs", [](double x) { return std::fabs(x); }},
          {"tanh", [](double x) { return std::tanh(x); }}};
      auto const found = functions.find(name);
      if (found == functions.end()) fail();
      return [f = found->second, inside](auto const& x) { return f(inside(x)); };
    }
    auto const place = places_.find(name);
    if (place == places_.end()) fail();
    return [i = place->second](auto const& x) { return x[i]; };
  }

  std::string text_;
  std::map<std::string, std::size_t> places_;
  std::size_t at_ = 0;
};

inline Expression parse_expression(std::string const& text, std::map<std::string, std::size_t> const& places) {
  return ExpressionParser(text, places).parse();
}

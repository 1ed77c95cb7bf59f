#include "common/scene/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>

namespace tandem::scene {
namespace expressions {
namespace {

using Arguments = std::vector<Quantity>;

[[noreturn]] void fail(const std::string& problem) {
  throw ExpressionError(problem);
}

double number(const Quantity& q, const char* function) {
  if (q.angle != 0) fail(fmt::format("{}() of an angle: divide it by deg or by rad", function));
  return q.value;
}

struct Function {
  std::size_t arguments;  // 0: any number, from one on
  std::function<Quantity(const Arguments&)> of;
};

Function trigonometric(double (*f)(double), const char* name) {
  return {1, [f, name](const Arguments& a) {
            if (a[0].angle != 0 && a[0].angle != 1) fail(fmt::format("{}() of a power of an angle", name));
            return Quantity{f(a[0].value), 0};
          }};
}
Function inverse(double (*f)(double), const char* name) {
  return {1, [f, name](const Arguments& a) { return Quantity{f(number(a[0], name)), 1}; }};
}
Function plain(double (*f)(double), const char* name) {
  return {1, [f, name](const Arguments& a) { return Quantity{f(number(a[0], name)), 0}; }};
}
// Of values of one kind, which the result has as well.
void expect_one_kind(const Arguments& a, const char* what) {
  for (const Quantity& q : a)
    if (q.angle != a[0].angle)
      fail(fmt::format("{} of an angle and a number: write the number as an angle, 5*deg or 0.1*rad", what));
}
Function extreme(bool largest, const char* name) {
  return {0, [largest, name](const Arguments& a) {
            expect_one_kind(a, name);
            const auto by_value = [](const Quantity& x, const Quantity& y) { return x.value < y.value; };
            return largest ? *std::max_element(a.begin(), a.end(), by_value)
                           : *std::min_element(a.begin(), a.end(), by_value);
          }};
}

const std::map<std::string, Function>& functions() {
  static const std::map<std::string, Function> all{
      {"sin", trigonometric(std::sin, "sin")},
      {"cos", trigonometric(std::cos, "cos")},
      {"tan", trigonometric(std::tan, "tan")},
      {"asin", inverse(std::asin, "asin")},
      {"acos", inverse(std::acos, "acos")},
      {"atan", inverse(std::atan, "atan")},
      {"atan2",
       {2,
        [](const Arguments& a) {
          expect_one_kind(a, "atan2()");
          return Quantity{std::atan2(a[0].value, a[1].value), 1};
        }}},
      {"hypot",
       {2,
        [](const Arguments& a) {
          expect_one_kind(a, "hypot()");
          return Quantity{std::hypot(a[0].value, a[1].value), a[0].angle};
        }}},
      {"sqrt", plain(std::sqrt, "sqrt")},
      {"exp", plain(std::exp, "exp")},
      {"log", plain(std::log, "log")},
      {"floor", plain(std::floor, "floor")},
      {"ceil", plain(std::ceil, "ceil")},
      {"round", plain(std::round, "round")},
      {"abs",
       {1,
        [](const Arguments& a) {
          return Quantity{std::fabs(a[0].value), a[0].angle};
        }}},
      {"min", extreme(false, "min()")},
      {"max", extreme(true, "max()")}};
  return all;
}

class Reader {
 public:
  Reader(std::string_view text, const std::function<Quantity(const std::string&)>& value_of)
      : text_(text), value_of_(value_of) {}

  Quantity all() {
    const Quantity q = sum();
    skip();
    if (at_ < text_.size()) unexpected("an operator");
    return q;
  }

 private:
  Quantity sum() {
    Quantity left = product();
    while (const char sign = take_one_of("+-")) {
      const Quantity right = product();
      expect_one_kind({left, right}, sign == '+' ? "the sum" : "the difference");
      left.value += sign == '+' ? right.value : -right.value;
    }
    return left;
  }
  Quantity product() {
    Quantity left = signed_power();
    while (const char sign = take_one_of("*/")) {
      const Quantity right = signed_power();
      if (sign == '/' && right.value == 0) fail("a division by zero");
      left.value = sign == '*' ? left.value * right.value : left.value / right.value;
      left.angle += sign == '*' ? right.angle : -right.angle;
    }
    return left;
  }
  Quantity signed_power() {
    const Depth one(*this);
    if (const char sign = take_one_of("+-")) {
      Quantity q = signed_power();
      if (sign == '-') q.value = -q.value;
      return q;
    }
    const Quantity base = atom();
    if (!take_one_of("^")) return base;
    const double exponent = number(signed_power(), "a power");
    if (base.angle != 0 && exponent != std::round(exponent)) fail("a broken power of an angle");
    return {std::pow(base.value, exponent), base.angle * static_cast<int>(exponent)};
  }
  Quantity atom() {
    skip();
    if (take_one_of("(")) {
      const Quantity q = sum();
      expect(')');
      return q;
    }
    if (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) return literal();
    const std::string name = take_name();
    if (name.empty()) unexpected("a number, a name or '('");
    if (name == "pi") return {std::numbers::pi, 0};
    if (name == "deg") return {std::numbers::pi / 180, 1};
    if (name == "rad") return {1, 1};
    const auto function = functions().find(name);
    return function == functions().end() ? value_of_(name) : call(name, function->second);
  }
  Quantity call(const std::string& name, const Function& function) {
    expect('(');
    Arguments arguments{sum()};
    while (take_one_of(",")) arguments.push_back(sum());
    expect(')');
    if (function.arguments != 0 && arguments.size() != function.arguments)
      fail(fmt::format("{}() takes {} value{}, not {}", name, function.arguments,
                       function.arguments == 1 ? "" : "s", arguments.size()));
    return function.of(arguments);
  }
  Quantity literal() {
    const std::string rest(text_.substr(at_));
    // strtod would read hexadecimal numbers as well.
    if (rest.size() > 1 && (rest[1] == 'x' || rest[1] == 'X')) unexpected("a decimal number");
    char* end = nullptr;
    const double value = std::strtod(rest.c_str(), &end);
    if (end == rest.c_str()) unexpected("a number");
    at_ += static_cast<std::size_t>(end - rest.c_str());
    return {value, 0};
  }

  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  char take_one_of(std::string_view signs) {
    skip();
    if (at_ == text_.size() || signs.find(text_[at_]) == std::string_view::npos) return 0;
    return text_[at_++];
  }
  void expect(char c) {
    if (!take_one_of(std::string_view(&c, 1))) unexpected(fmt::format("'{}'", c));
  }
  std::string take_name() {
    std::string name;
    while (at_ < text_.size() && (is_letter(text_[at_]) || (!name.empty() && is_digit(text_[at_]))))
      name += text_[at_++];
    return name;
  }
  [[noreturn]] void unexpected(const std::string& wanted) const {
    fail(at_ < text_.size()
             ? fmt::format("'{}' in column {}, where {} is expected", text_[at_], at_ + 1, wanted)
             : fmt::format("it ends where {} is expected", wanted));
  }

  struct Depth {
    explicit Depth(Reader& of) : reader(of) {
      constexpr int most = 100;
      if (++reader.depth_ > most) fail("more than 100 levels of brackets and signs");
    }
    ~Depth() { --reader.depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    Reader& reader;
  };

  std::string_view text_;
  const std::function<Quantity(const std::string&)>& value_of_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace
}  // namespace expressions

Quantity evaluate(std::string_view text, const std::function<Quantity(const std::string&)>& value_of) {
  const Quantity q = expressions::Reader(text, value_of).all();
  if (!std::isfinite(q.value)) throw ExpressionError("the result is not a finite number");
  return q;
}

const std::vector<std::string>& reserved_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"pi", "deg", "rad"};
    for (const auto& [name, function] : expressions::functions()) all.push_back(name);
    return all;
  }();
  return names;
}

}  // namespace tandem::scene

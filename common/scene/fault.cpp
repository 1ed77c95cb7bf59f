#include "common/scene/fault.hpp"

#include <array>
#include <charconv>

namespace tandem::scene {

std::string place(const std::string& origin, const std::string& path) {
  return path.empty() ? origin : origin + ": " + path;
}

std::string element(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

void fail(const std::string& origin, const std::string& path, const std::string& problem,
          const std::string& hint) {
  throw Error(ErrorCode::scene, problem, place(origin, path), hint);
}

namespace {

template <class... Format>
std::string number(double value, Format... format) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...).ptr;
  return {buffer.data(), end};
}

std::string list(const std::string& x, const std::string& y, const std::string& z) {
  return "[" + x + ", " + y + ", " + z + "]";
}

}  // namespace

std::string exact_text(double value) {
  return number(value);
}
std::string text(double value) {
  const std::string digits = number(value, std::chars_format::general, 15);
  double read = value;
  std::from_chars(digits.data(), digits.data() + digits.size(), read);
  const std::string exact = number(value), rounded = number(read);
  return rounded.size() + 5 <= exact.size() ? rounded : exact;
}
std::string text(Vec3d value) {
  return list(text(value.x), text(value.y), text(value.z));
}

std::string rounded(double value) {
  return number(value, std::chars_format::general, 6);
}
std::string rounded(Vec3d value) {
  return list(rounded(value.x), rounded(value.y), rounded(value.z));
}

}  // namespace tandem::scene

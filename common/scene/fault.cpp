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

std::string text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string text(Vec3d value) {
  return "[" + text(value.x) + ", " + text(value.y) + ", " + text(value.z) + "]";
}

}  // namespace tandem::scene

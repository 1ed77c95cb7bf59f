// Functions by which the parts of tandem_scene report a fault of the scene.
#pragma once

#include <string>

#include "common/error.hpp"
#include "common/math/vec3.hpp"

namespace tandem::scene {

// "FILE: path", or "FILE" for the whole document.
std::string place(const std::string& origin, const std::string& path);

// "bodies", 2 -> "bodies[2]"
std::string element(const std::string& path, std::size_t index);

[[noreturn]] void fail(const std::string& origin, const std::string& path, const std::string& problem,
                       const std::string& hint);

// Shortest text that is read back as the same number, without the round-off of a sum: 0.1 + 0.2 is "0.3".
std::string text(double value);
std::string text(Vec3d value);  // "[0, 0, 1]"

// With all digits.
std::string exact_text(double value);

// Six significant digits, for computed values.
std::string rounded(double value);
std::string rounded(Vec3d value);

}  // namespace tandem::scene

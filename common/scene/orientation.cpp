#include "common/scene/orientation.hpp"

#include <cmath>
#include <numbers>

#include "common/scene/fault.hpp"
#include "common/scene/tolerance.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

constexpr const char* axis_keys[3] = {"x_axis", "y_axis", "z_axis"};

// Angles under KEY [rad] or KEY_deg, of which one is given.
Vec3d read_angles(const Node& node, const char* key, bool list) {
  const std::string in_degrees = std::string(key) + "_deg";
  const bool degrees = node.has(in_degrees.c_str());
  if (degrees && node.has(key))
    node.fail(in_degrees.c_str(), std::string(key) + " and " + in_degrees + " are both given",
              "keep one of them");
  Vec3d angles;
  const char* given = degrees ? in_degrees.c_str() : key;
  if (list)
    node.read(given, angles);
  else
    node.read(given, angles.x);
  if (degrees)
    for (int k = 0; k < 3; ++k) angles[k] = angles[k] / 180 * std::numbers::pi;
  return angles;
}

bool has_angle(const Node& node, const std::string& key) {
  return node.has(key.c_str()) || node.has((key + "_deg").c_str());
}

Quat about(Vec3d unit_axis, double angle) {
  const double s = std::sin(angle / 2);
  return Quat{std::cos(angle / 2), s * unit_axis.x, s * unit_axis.y, s * unit_axis.z}.normalized();
}

Quat read_euler(const Node& node) {
  if (!node.has("order"))
    node.fail("the key 'order' is missing", "add order: the axes of the three angles, such as \"zyx\"");
  const Vec3d angles = read_angles(node, "euler", true);
  const auto order = node.value().at("order").get<std::string>();
  Quat q;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[order[static_cast<std::size_t>(k)] - 'x'] = 1;
    q = q * about(axis, angles[k]);
  }
  return q.normalized();
}

Quat read_axis_and_angle(const Node& node) {
  for (const bool of_axis : {true, false})
    if (of_axis ? !node.has("axis") : !has_angle(node, "angle"))
      node.fail(std::string("the key '") + (of_axis ? "axis" : "angle_deg") + "' is missing",
                std::string("add ") + (of_axis ? "axis: the unit vector about which the angle is"
                                               : "angle_deg: the angle about the axis [deg]"));
  Vec3d axis;
  node.read_unit("axis", axis);
  if (!is_unit(norm(axis)))
    node.fail("axis", text(axis) + " has length " + text(norm(axis)) + ", not 1",
              norm(axis) > 0 ? "the unit one is " + text(normalized(axis)) : "give a direction");
  return about(axis, read_angles(node, "angle", false).x);
}

// The quaternion of a rotation matrix, from its largest element.
Quat quaternion(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  const double trace = x.x + y.y + z.z;
  if (trace > 0) return Quat{1 + trace, y.z - z.y, z.x - x.z, x.y - y.x}.normalized();
  if (x.x >= y.y && x.x >= z.z)
    return Quat{y.z - z.y, 1 + x.x - y.y - z.z, x.y + y.x, z.x + x.z}.normalized();
  if (y.y >= z.z) return Quat{z.x - x.z, x.y + y.x, 1 + y.y - x.x - z.z, y.z + z.y}.normalized();
  return Quat{x.y - y.x, z.x + x.z, y.z + z.y, 1 + z.z - x.x - y.y}.normalized();
}

Quat read_axes(const Node& node) {
  int given[3] = {}, count = 0;
  Vec3d axes[3];
  for (int k = 0; k < 3; ++k) {
    if (!node.has(axis_keys[k])) continue;
    node.read(axis_keys[k], axes[k]);
    if (norm(axes[k]) == 0) node.fail(axis_keys[k], text(axes[k]) + " has no direction", "give one");
    axes[k] = normalized(axes[k]);
    given[count++] = k;
  }
  if (count == 1)
    node.fail(std::string("there is ") + axis_keys[given[0]] + " alone",
              "two axes make an orientation: add another one");
  if (count == 3) node.fail("there are three axes", "leave one out: it follows from the others");
  const int a = given[0], b = given[1], c = 3 - a - b;
  if (const double cosine = dot(axes[a], axes[b]); std::abs(cosine) > 1e-6)
    node.fail(std::string(axis_keys[a]) + " and " + axis_keys[b] + " enclose an angle of " +
                  rounded(std::acos(std::fmin(1, std::fmax(-1, cosine))) * 180 / std::numbers::pi) +
                  " deg, not 90 deg",
              "the axes of a frame are perpendicular, within 1e-6 rad");
  axes[b] = normalized(axes[b] - dot(axes[a], axes[b]) * axes[a]);
  // x, y, z is right-handed, and so is every cyclic order.
  axes[c] = (b - a + 3) % 3 == 1 ? cross(axes[a], axes[b]) : cross(axes[b], axes[a]);
  return quaternion(axes[0], axes[1], axes[2]);
}

}  // namespace

Quat read_rotation(const Node& node) {
  const bool euler = has_angle(node, "euler") || node.has("order");
  const bool axis_and_angle = node.has("axis") || has_angle(node, "angle");
  const bool axes = node.has("x_axis") || node.has("y_axis") || node.has("z_axis");
  const char* one_of = "give euler_deg and order, or axis and angle_deg, or two of x_axis, y_axis, z_axis";
  if (!euler && !axis_and_angle && !axes) node.fail("the orientation is empty", one_of);
  if (euler + axis_and_angle + axes > 1)
    node.fail(std::string("the orientation is given twice, by ") +
                  (euler ? "Euler angles and by " : "an axis with an angle and by ") +
                  (axes ? "two axes" : "an axis with an angle"),
              one_of);
  if (euler && !has_angle(node, "euler"))
    node.fail("order", "there are no Euler angles", "add euler_deg, or leave out order");
  return euler ? read_euler(node) : axes ? read_axes(node) : read_axis_and_angle(node);
}

}  // namespace tandem::scene

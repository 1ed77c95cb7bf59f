#include "protocol/checks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "common/utf8.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

// Round-off of a quaternion after double arithmetic is 1e-15; the tolerance rejects drift only.
constexpr double unit_tolerance = 1e-9;

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

std::string body_name(std::uint32_t body) {
  return body == ground.value ? std::string("ground") : "body " + std::to_string(body);
}

// Thrown by a field and caught by its record, which knows the name, so that no text is formatted for valid
// values.
struct Bad {
  Violation violation;
  std::string part, problem;
};

void check(double x) {
  if (!std::isfinite(x)) throw Bad{Violation::not_finite, "", "is " + text(x) + ", not finite"};
}
void check(Vec3d v) {
  if (is_finite(v)) return;
  throw Bad{Violation::not_finite, "",
            "is (" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + "), not finite"};
}
void check(const Quat& q) {
  const double n = std::sqrt(q.norm2());
  const std::string part = ".q_WB";
  if (!std::isfinite(n)) throw Bad{Violation::not_finite, part, "has the norm " + text(n) + ", not finite"};
  if (std::abs(n - 1) > unit_tolerance)
    throw Bad{Violation::not_unit, part, "has the norm " + text(n) + ", not 1 within 1e-9"};
}
void check_part(const char* part, Vec3d v) {
  try {
    check(v);
  } catch (Bad& bad) {
    bad.part = part;
    throw;
  }
}
void check(const Pose& pose) {
  check_part(".p_WB", pose.p_WB);
  check(pose.q_WB);
}
void check(const Twist& twist) {
  check_part(".v_WB", twist.v_WB);
  check_part(".w_WB", twist.w_WB);
}
void check(const Wrench& wrench) {
  check_part(".force", wrench.force);
  check_part(".torque", wrench.torque);
}
void check(const std::array<double, 36>& matrix) {
  for (int i = 0; i < 36; ++i)
    if (!std::isfinite(matrix[i]))
      throw Bad{Violation::not_finite, "[" + std::to_string(i / 6) + "][" + std::to_string(i % 6) + "]",
                "is " + text(matrix[i]) + ", not finite"};
}
void check(std::uint64_t) {}
void check(std::uint32_t) {}
void check(Nanoseconds) {}

template <class T>
void check_field(const char* field, const T& value, const std::string& owner) {
  try {
    check(value);
  } catch (const Bad& bad) {
    throw ProtocolError(bad.violation, owner + field + bad.part + " " + bad.problem);
  }
}

void expect_zero(std::uint32_t reserved, const std::string& owner) {
  if (reserved != 0) throw ProtocolError(Violation::bad_header, owner + "reserved is not zero");
}

// void check_record(record, owner) for every record of the list. `owner` is short and so costs no allocation
// ("body 7: " fits a std::string's own buffer).
#define RECORD(record, meaning) \
  [[maybe_unused]] void check_record(const record& value, [[maybe_unused]] const std::string& owner) {
#define FIELD(record, field, meaning) check_field(#field, value.field, owner);
#define END(record) }
#include "protocol/records.def"
#undef RECORD
#undef FIELD
#undef END

// Times from zero on have a difference.
void check_window(const Window& window) {
  for (const auto& [name, time] : {std::pair("begin", window.begin), std::pair("end", window.end)})
    if (time < Nanoseconds{})
      throw ProtocolError(Violation::wrong_time, std::string("window.") + name + " is " +
                                                     std::to_string(time.count) + " ns, before the start");
}

void check_motions(const std::vector<BodyMotion>& motions) {
  for (const BodyMotion& motion : motions) {
    const std::string owner = body_name(motion.body) + ": ";
    check_record(motion, owner);
    expect_zero(motion.reserved, owner);
  }
}

void check_mesh(const NamedMesh& named) {
  const auto& [name, mesh] = named;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i]))
      throw ProtocolError(Violation::not_finite,
                          "mesh " + name + ": vertices[" + std::to_string(i) + "] is not finite");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t vertex : mesh.triangles[i])
      if (vertex >= mesh.vertices.size())
        throw ProtocolError(Violation::bad_index, "mesh " + name + ": triangles[" + std::to_string(i) +
                                                      "] has the vertex " + std::to_string(vertex) + " of " +
                                                      std::to_string(mesh.vertices.size()));
}

template <class Items>
void expect_ascending(const Items& items, auto id, const char* what) {
  for (std::size_t i = 1; i < items.size(); ++i)
    if (id(items[i]) <= id(items[i - 1]))
      throw ProtocolError(Violation::bad_index, std::string(what) + "[" + std::to_string(i) + "] is " +
                                                    std::to_string(id(items[i])) + " after " +
                                                    std::to_string(id(items[i - 1])) + ", not ascending");
}

// Compares the bits of the exponents in blocks of a fixed length, which compilers vectorise.
template <class T>
bool all_finite(const std::vector<T>& values) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits exponent = std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
  constexpr std::size_t block = 64;
  std::size_t i = 0;
  for (; i + block <= values.size(); i += block) {
    Bits found = 0;
    for (std::size_t k = 0; k < block; ++k)
      found |= (std::bit_cast<Bits>(values[i + k]) & exponent) == exponent ? 1 : 0;
    if (found != 0) return false;
  }
  for (; i < values.size(); ++i)
    if (!std::isfinite(values[i])) return false;
  return true;
}

template <class T>
void expect_finite(const std::vector<T>& values, std::size_t per_item, const ParticlesFrame& frame,
                   const char* field) {
  if (all_finite(values)) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw ProtocolError(Violation::not_finite, "particle " + std::to_string(frame.id[i / per_item]) + ": " +
                                                     field + " is " + text(values[i]) + ", not finite");
}

}  // namespace

void BoundaryBodies::assign(const std::vector<BodyMotion>& boundary) {
  ids_.clear();
  for (const BodyMotion& motion : boundary) ids_.push_back(motion.body);
  ids_.push_back(ground.value);
  std::ranges::sort(ids_);
  const auto twice = std::ranges::adjacent_find(ids_);
  if (twice != ids_.end())
    throw ProtocolError(*twice == ground.value ? Violation::unknown_body : Violation::repeated_body,
                        body_name(*twice) + (*twice == ground.value ? " has no motion" : " appears twice"));
  seen_.assign(ids_.size(), false);
  known_ = true;
}

void BoundaryBodies::mark(std::uint32_t body, bool may_be_ground) {
  const auto found = std::ranges::lower_bound(ids_, body);
  if (found == ids_.end() || *found != body || (body == ground.value && !may_be_ground))
    throw ProtocolError(Violation::unknown_body, body_name(body) + " is not one of the " +
                                                     std::to_string(ids_.size() - 1) + " boundary bodies");
  const auto at = static_cast<std::size_t>(found - ids_.begin());
  if (seen_[at]) throw ProtocolError(Violation::repeated_body, body_name(body) + " appears twice");
  seen_[at] = true;
}

void BoundaryBodies::expect_all(const std::vector<BodyMotion>& bodies) {
  seen_.assign(ids_.size(), false);
  for (const BodyMotion& motion : bodies) mark(motion.body, false);
  if (bodies.size() + 1 == ids_.size()) return;
  const auto missing = std::ranges::find(seen_, false);
  throw ProtocolError(Violation::missing_body,
                      body_name(ids_[static_cast<std::size_t>(missing - seen_.begin())]) + " is missing");
}

void BoundaryBodies::expect_some(const std::vector<BodyLoad>& bodies) {
  seen_.assign(ids_.size(), false);
  for (const BodyLoad& load : bodies) mark(load.body, true);
}

void BoundaryBodies::expect_some(const std::vector<BodyTangent>& bodies) {
  seen_.assign(ids_.size(), false);
  for (const BodyTangent& tangent : bodies) mark(tangent.body, false);
}

void BoundaryBodies::expect_some(const std::vector<BodyResponse>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i > 0 && bodies[i].body == bodies[i - 1].body) continue;
    seen_.assign(ids_.size(), false);
    mark(bodies[i].body, false);
  }
}

void check_values(const Configuration& value) {
  for (const NamedMesh& mesh : value.meshes) check_mesh(mesh);
}

namespace {

void check_sensors(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    check_field("value", values[i], "sensor column " + std::to_string(i) + ": ");
}

}  // namespace

void check_values(const Configured& value) {
  check_motions(value.boundary);
  check_sensors(value.sensors);
}

void check_values(const MotionSet& value) {
  check_window(value.window);
  check_motions(value.bodies);
}

void check_values(const LoadSet& value) {
  check_window(value.window);
  check_record(value.account, "account: ");
  for (const BodyLoad& load : value.bodies) {
    const std::string owner = body_name(load.body) + ": ";
    check_record(load, owner);
    expect_zero(load.reserved, owner);
  }
  check_sensors(value.sensors);
}

void check_values(const TangentSet& value) {
  for (const BodyTangent& tangent : value.bodies) {
    const std::string owner = body_name(tangent.body) + ": ";
    check_record(tangent, owner);
    expect_zero(tangent.reserved, owner);
  }
  for (const BodyResponse& response : value.responses) {
    const std::string owner = body_name(response.body) + ": ";
    check_record(response, owner);
    expect_zero(response.reserved, owner);
    if (response.time < 0)
      throw ProtocolError(Violation::not_positive, owner + "time is " + text(response.time) + " s, below 0");
    const BodyResponse* before = &response == value.responses.data() ? nullptr : &response - 1;
    if (before &&
        (before->body > response.body || (before->body == response.body && before->time >= response.time)))
      throw ProtocolError(Violation::wrong_time, owner + "the response after " + text(response.time) +
                                                     " s is not in the order of bodies and times");
  }
}

void check_values(const ControlSet& value) {
  for (std::size_t i = 0; i < value.values.size(); ++i)
    check_field("value", value.values[i], "control input " + std::to_string(i) + ": ");
}

void check_values(const Checkpoint& value) {
  if (value.time < Nanoseconds{})
    throw ProtocolError(Violation::wrong_time,
                        "checkpoint: time is " + std::to_string(value.time.count) + " ns, before the start");
  if (!value.path.starts_with('/'))
    throw ProtocolError(Violation::not_allowed,
                        "checkpoint: path is '" + shortened(value.path) + "', not absolute");
}

void check_account(const LoadSet& value) {
  const ParticleAccount& account = value.account;
  if (account.micro_steps == 0) throw ProtocolError(Violation::not_positive, "account: micro_steps is 0");
  if (!(account.micro_step > 0))
    throw ProtocolError(Violation::not_positive,
                        "account: micro_step is " + text(account.micro_step) + " s, not > 0");
  if (account.kinetic_energy < 0)
    throw ProtocolError(Violation::not_positive,
                        "account: kinetic_energy is " + text(account.kinetic_energy) + " J, less than 0");
  if (account.max_overlap_ratio < 0)
    throw ProtocolError(Violation::not_positive,
                        "account: max_overlap_ratio is " + text(account.max_overlap_ratio) + ", less than 0");
  const double covered = static_cast<double>(account.micro_steps) * account.micro_step;
  if (std::abs(covered - value.window.length()) > 1e-9 * value.window.length())
    throw ProtocolError(Violation::wrong_time, "account: " + std::to_string(account.micro_steps) +
                                                   " micro steps of " + text(account.micro_step) +
                                                   " s do not fill the window of " +
                                                   text(value.window.length()) + " s");
}

void check_values(const BodiesFrame& value) {
  for (const BodyState& state : value.bodies) {
    const std::string owner = body_name(state.body) + ": ";
    check_record(state, owner);
    expect_zero(state.reserved, owner);
  }
  for (const JointState& state : value.joints) {
    const std::string owner = "joint " + std::to_string(state.joint) + ": ";
    check_record(state, owner);
    if (state.undetermined >= 64)
      throw ProtocolError(
          Violation::bad_header,
          owner + "undetermined is " + std::to_string(state.undetermined) + ", but has six bits");
  }
  expect_ascending(
      value.bodies, [](const BodyState& s) { return s.body; }, "bodies");
  expect_ascending(
      value.joints, [](const JointState& s) { return s.joint; }, "joints");
  check_field("energy", value.energy, "");
  for (std::size_t i = 0; i < value.elements.size(); ++i)
    check_field("value", value.elements[i], "element column " + std::to_string(i) + ": ");
  for (std::size_t i = 0; i < value.contacts.size(); ++i)
    check_field("value", value.contacts[i], "account of contacts " + std::to_string(i) + ": ");
}

void check_values(const ParticlesFrame& value) {
  const std::size_t n = value.id.size();
  const auto expect_size = [n](const char* field, std::size_t size, std::size_t per_item) {
    if (size != per_item * n)
      throw ProtocolError(Violation::bad_index, std::string(field) + " holds " + std::to_string(size) +
                                                    " numbers for " + std::to_string(n) +
                                                    " particles, expected " + std::to_string(per_item * n));
  };
  expect_size("position", value.position.size(), 3);
  expect_size("velocity", value.velocity.size(), 3);
  expect_size("spin", value.spin.size(), 3);
  expect_size("radius", value.radius.size(), 1);
  if (!value.contacts.empty()) expect_size("contacts", value.contacts.size(), ParticlesFrame::contact_values);
  if (!value.liquid.empty()) expect_size("liquid", value.liquid.size(), ParticlesFrame::liquid_values);
  expect_ascending(
      value.id, [](std::uint32_t id) { return id; }, "id");
  expect_finite(value.position, 3, value, "position");
  expect_finite(value.velocity, 3, value, "velocity");
  expect_finite(value.spin, 3, value, "spin");
  expect_finite(value.radius, 1, value, "radius");
  expect_finite(value.contacts, ParticlesFrame::contact_values, value, "contacts");
  expect_finite(value.liquid, ParticlesFrame::liquid_values, value, "liquid");
  if (value.walls.size() % ParticlesFrame::wall_values != 0)
    throw ProtocolError(Violation::bad_index,
                        "walls holds " + std::to_string(value.walls.size()) + " numbers, expected " +
                            std::to_string(ParticlesFrame::wall_values) + " for each triangle");
  for (std::size_t i = 0; i < value.walls.size(); ++i)
    check_field("value", value.walls[i],
                "triangle " + std::to_string(i / ParticlesFrame::wall_values) + " of the walls: ");
  constexpr std::size_t stride = ParticlesFrame::of_bodies_values;
  if (value.of_bodies.size() % stride != 0)
    throw ProtocolError(Violation::bad_index, "of_bodies holds " + std::to_string(value.of_bodies.size()) +
                                                  " numbers, expected " + std::to_string(stride) +
                                                  " for each contact");
  for (std::size_t i = 0; i < value.of_bodies.size(); ++i) {
    const std::string owner = "contact " + std::to_string(i / stride) + " of bodies: ";
    check_field("value", value.of_bodies[i], owner);
    const double lowest = i % stride == 0 ? -1 : 0;
    if (i % stride < 2 &&
        !(value.of_bodies[i] >= lowest && value.of_bodies[i] == std::floor(value.of_bodies[i])))
      throw ProtocolError(Violation::bad_index, owner + (i % stride == 0 ? "body" : "sphere") + " is " +
                                                    text(value.of_bodies[i]) + ", not an index");
  }
  for (std::size_t i = 0; i < value.contacts.size(); i += ParticlesFrame::contact_values)
    if (const float count = value.contacts[i]; !(count >= 0) || count != std::floor(count))
      throw ProtocolError(Violation::bad_index,
                          "particle " + std::to_string(value.id[i / ParticlesFrame::contact_values]) +
                              ": number of contacts is " + text(count) + ", not a whole number from 0 on");
  for (std::size_t i = 0; i < n; ++i)
    if (!(value.radius[i] > 0))
      throw ProtocolError(Violation::not_positive, "particle " + std::to_string(value.id[i]) +
                                                       ": radius is " + text(value.radius[i]) + ", not > 0");
}

}  // namespace tandem::protocol

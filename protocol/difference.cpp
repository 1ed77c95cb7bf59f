#include "protocol/difference.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "protocol/codec.hpp"

namespace tandem::protocol {
namespace {

using Found = std::optional<Difference>;

std::string number_text(double value, int digits) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

// Bits, not values: 0 and -0 differ, and a value that is not a number is equal to itself.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

Found compare(const std::string& place, double a, double b) {
  if (same_bits(a, b)) return {};
  return Difference{place, number_text(a, 17), number_text(b, 17), number_text(a - b, 3)};
}
Found compare(const std::string& place, float a, float b) {
  if (same_bits(a, b)) return {};
  return Difference{place, number_text(a, 9), number_text(b, 9), number_text(double{a} - double{b}, 3)};
}
template <class T>
requires std::is_integral_v<T> Found compare(const std::string& place, T a, T b) {
  if (a == b) return {};
  return Difference{place, std::to_string(a), std::to_string(b),
                    (a > b ? "" : "-") + std::to_string(a > b ? a - b : b - a)};
}
Found compare(const std::string& place, Nanoseconds a, Nanoseconds b) {
  Found found = compare(place, a.count, b.count);
  if (found)
    for (std::string* text : {&found->replayed, &found->recorded, &found->difference}) *text += " ns";
  return found;
}
Found compare(const std::string& place, const std::string& a, const std::string& b) {
  if (a == b) return {};
  return Difference{place, "'" + a + "'", "'" + b + "'", {}};
}

Found compare(const std::string& place, const Vec3d& a, const Vec3d& b);
Found compare(const std::string& place, const Quat& a, const Quat& b);

// The first that is found; places are made for values that differ only.
template <class... Member>
Found first_of(const std::string& place, const Member&... member) {
  Found found;
  (void)((found = compare(place + member.name, member.a, member.b), found.has_value()) || ...);
  return found;
}
template <class T>
struct Member {
  const char* name;
  const T &a, &b;
};

Found compare(const std::string& place, const Vec3d& a, const Vec3d& b) {
  if (same_bits(a, b)) return {};
  return first_of(place, Member{".x", a.x, b.x}, Member{".y", a.y, b.y}, Member{".z", a.z, b.z});
}
Found compare(const std::string& place, const Quat& a, const Quat& b) {
  if (same_bits(a, b)) return {};
  return first_of(place, Member{".w", a.w, b.w}, Member{".x", a.x, b.x}, Member{".y", a.y, b.y},
                  Member{".z", a.z, b.z});
}
Found compare(const std::string& place, const Pose& a, const Pose& b) {
  return first_of(place, Member{".p_WB", a.p_WB, b.p_WB}, Member{".q_WB", a.q_WB, b.q_WB});
}
Found compare(const std::string& place, const Twist& a, const Twist& b) {
  return first_of(place, Member{".v_WB", a.v_WB, b.v_WB}, Member{".w_WB", a.w_WB, b.w_WB});
}
Found compare(const std::string& place, const Wrench& a, const Wrench& b) {
  return first_of(place, Member{".force", a.force, b.force}, Member{".torque", a.torque, b.torque});
}
Found compare(const std::string& place, const std::array<double, 36>& a, const std::array<double, 36>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same_bits(a[i], b[i]))
      return compare(place + "[" + std::to_string(i / 6) + "][" + std::to_string(i % 6) + "]", a[i], b[i]);
  return {};
}

// compare_record(owner, a, b) for every record of the list.
#define RECORD(record, meaning)                                                                       \
  [[maybe_unused]] Found compare_record(const std::string& owner, const record& a, const record& b) { \
    if (same_bits(a, b)) return {};
#define FIELD(record, field, meaning) \
  if (Found found = compare(#record + owner + ": " #field, a.field, b.field)) return found;
#define END(record) \
  return {};        \
  }
#include "protocol/records.def"
#undef RECORD
#undef FIELD
#undef END

std::string owner_of(const auto& record) {
  if constexpr (requires { record.joint; })
    return " of joint " + std::to_string(record.joint);
  else
    return record.body == ground.value ? " of the ground" : " of body " + std::to_string(record.body);
}

Found compare_count(const char* what, std::size_t a, std::size_t b) {
  return compare(std::string("number of ") + what, a, b);
}

template <class T>
Found compare_list(const char* what, const std::vector<T>& a, const std::vector<T>& b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (Found found = compare_record(owner_of(b[i]), a[i], b[i])) return found;
  return compare_count(what, a.size(), b.size());
}

// "sphere 7: radius", of value i of a list with `width` values of each sphere.
std::string place_of(const char* what, const std::vector<std::uint32_t>& id, std::size_t i, std::size_t width,
                     const char* field) {
  const std::size_t index = i / width;
  return std::string(what) + " " + (index < id.size() ? std::to_string(id[index]) : "?") + ": " + field;
}

// Values of spheres, `width` of each.
template <class T>
Found compare_spheres(const char* field, const std::vector<std::uint32_t>& id, const std::vector<T>& a,
                      const std::vector<T>& b, std::size_t width) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (same_bits(a[i], b[i])) continue;
    std::string place = place_of("sphere", id, i, width, field);
    if (width == 3) place += std::string(".") + "xyz"[i % 3];
    return compare(place, a[i], b[i]);
  }
  return compare_count(field, a.size(), b.size());
}

Found compare_liquid(const std::vector<std::uint32_t>& id, const std::vector<float>& a,
                     const std::vector<float>& b) {
  constexpr std::size_t width = ParticlesFrame::liquid_values;
  static_assert(width == 2);
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (!same_bits(a[i], b[i]))
      return compare(place_of("particle", id, i, width, i % width == 0 ? "pressure" : "density"), a[i], b[i]);
  return compare_count("values of the liquid", a.size(), b.size());
}

Found compare_columns(const std::string& column, const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (Found found = compare(column + " " + std::to_string(i), a[i], b[i])) return found;
  return compare_count((column + "s").c_str(), a.size(), b.size());
}
Found compare_payload(const MotionSet& a, const MotionSet& b) {
  if (Found found = compare_record("", a.window, b.window)) return found;
  return compare_list("bodies", a.bodies, b.bodies);
}
Found compare_payload(const LoadSet& a, const LoadSet& b) {
  if (Found found = compare_record("", a.window, b.window)) return found;
  // Loads first: they are what the balance is made of.
  if (Found found = compare_list("bodies", a.bodies, b.bodies)) return found;
  if (Found found = compare_record("", a.account, b.account)) return found;
  return compare_columns("sensor column", a.sensors, b.sensors);
}
Found compare_payload(const TangentSet& a, const TangentSet& b) {
  if (Found found = compare("time", a.time, b.time)) return found;
  if (Found found = compare_list("bodies", a.bodies, b.bodies)) return found;
  return compare_list("responses", a.responses, b.responses);
}
Found compare_payload(const Configured& a, const Configured& b) {
  if (Found found = compare_list("boundary bodies", a.boundary, b.boundary)) return found;
  return compare_columns("sensor column", a.sensors, b.sensors);
}
Found compare_payload(const BodiesFrame& a, const BodiesFrame& b) {
  if (Found found = compare("time", a.time, b.time)) return found;
  if (Found found = compare_list("bodies", a.bodies, b.bodies)) return found;
  if (Found found = compare_list("joints", a.joints, b.joints)) return found;
  if (Found found = compare("energy", a.energy, b.energy)) return found;
  if (Found found = compare_columns("element column", a.elements, b.elements)) return found;
  return compare_columns("account of contacts", a.contacts, b.contacts);
}
Found compare_payload(const ParticlesFrame& a, const ParticlesFrame& b) {
  if (Found found = compare("time", a.time, b.time)) return found;
  if (Found found = compare_spheres("id", b.id, a.id, b.id, 1)) return found;
  if (Found found = compare_spheres("position", b.id, a.position, b.position, 3)) return found;
  if (Found found = compare_spheres("velocity", b.id, a.velocity, b.velocity, 3)) return found;
  if (Found found = compare_spheres("spin", b.id, a.spin, b.spin, 3)) return found;
  if (Found found = compare_spheres("radius", b.id, a.radius, b.radius, 1)) return found;
  if (Found found = compare_spheres("contacts", b.id, a.contacts, b.contacts, ParticlesFrame::contact_values))
    return found;
  if (Found found = compare_liquid(b.id, a.liquid, b.liquid)) return found;
  if (Found found = compare_columns("value of walls", a.walls, b.walls)) return found;
  return compare_columns("value of the contacts of bodies", a.of_bodies, b.of_bodies);
}
Found compare_payload(const Failure& a, const Failure& b) {
  if (Found found = compare("code", std::string(name(a.code)), std::string(name(b.code)))) return found;
  return compare("what", a.what, b.what);
}

template <class T>
Found compare_as(std::span<const std::byte> replayed, std::span<const std::byte> recorded) {
  if (std::ranges::equal(replayed, recorded)) return {};
  T a, b;
  decode(replayed, a);
  decode(recorded, b);
  return compare_payload(a, b);
}

}  // namespace

std::optional<Difference> first_difference(Kind kind, std::span<const std::byte> replayed,
                                           std::span<const std::byte> recorded) {
  switch (kind) {
    case Kind::configured:
      return compare_as<Configured>(replayed, recorded);
    case Kind::motion:
      return compare_as<MotionSet>(replayed, recorded);
    case Kind::load:
      return compare_as<LoadSet>(replayed, recorded);
    case Kind::tangents:
      return compare_as<TangentSet>(replayed, recorded);
    case Kind::bodies:
      return compare_as<BodiesFrame>(replayed, recorded);
    case Kind::particles:
      return compare_as<ParticlesFrame>(replayed, recorded);
    case Kind::failure:
      return compare_as<Failure>(replayed, recorded);
    default:
      return {};
  }
}

}  // namespace tandem::protocol

// The functions of the C interface that need no solver.
#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/time.hpp"
#include "participant/include/tandem/participant.h"
#include "participant/library/facts.hpp"
#include "participant/library/failure.hpp"
#include "particles/geometry/path.hpp"

namespace {

thread_local struct Failure {
  int code = TANDEM_OK;
  std::string what, where, hint;
} failure;

std::string text_of(const char* text) {
  return text ? text : "";
}

tandem::ErrorCode code_of(int status) {
  switch (status) {
    case TANDEM_ERROR_SCENE:
      return tandem::ErrorCode::scene;
    case TANDEM_ERROR_NUMERICS:
      return tandem::ErrorCode::numerics;
    case TANDEM_ERROR_RESOURCE:
      return tandem::ErrorCode::resource;
    default:
      return tandem::ErrorCode::internal;
  }
}

}  // namespace

namespace tandem::participant {

void expect_ok(int status, const char* function) {
  if (status == TANDEM_OK) return;
  const Failure told = std::exchange(failure, {});
  if (told.code == TANDEM_OK)
    throw Error(ErrorCode::internal, fmt::format("returned {} and gave no reason", status), function,
                "call tandem_fail() and return its value");
  throw Error(code_of(told.code), told.what, told.where.empty() ? function : told.where, told.hint);
}

}  // namespace tandem::participant

extern "C" {

int tandem_fail(int code, const char* what, const char* where, const char* hint) {
  failure = {code == TANDEM_OK ? TANDEM_ERROR_INTERNAL : code, text_of(what), text_of(where), text_of(hint)};
  return failure.code;
}

void tandem_log(char level, const char* sentence) {
  if (level == 'w')
    tandem::log::warn("{}", text_of(sentence));
  else
    tandem::log::info("{}", text_of(sentence));
}

void tandem_fact_number(tandem_facts* facts, const char* key, double value) {
  if (!std::isfinite(value)) {
    facts->refuse(fmt::format("the fact \"{}\" is {}, not finite",
                              tandem::printable_line(tandem::shortened(text_of(key))), value),
                  "leave the key out where there is no value", tandem::ErrorCode::numerics);
    return;
  }
  // A whole number is written without a point.
  const double whole = 9007199254740992;  // 2^53
  if (value == std::floor(value) && std::abs(value) <= whole)
    facts->set(text_of(key), static_cast<std::int64_t>(value));
  else
    facts->set(text_of(key), value);
}

void tandem_fact_text(tandem_facts* facts, const char* key, const char* value) {
  facts->set(text_of(key), text_of(value));
}

void tandem_warn(tandem_facts* facts, const char* sentence) {
  tandem::log::warn("{}", text_of(sentence));
  nlohmann::ordered_json& warnings = facts->values["warnings"];
  if (warnings.size() >= tandem::protocol::most_facts)
    facts->refuse(fmt::format("there are more than {} warnings", tandem::protocol::most_facts));
  else
    warnings.push_back(text_of(sentence));
}

int tandem_pose_at(const tandem_body_motion* motion, const tandem_window* window, double seconds,
                   tandem_pose* pose, tandem_twist* twist) {
  using namespace tandem;
  const auto vector = [](const double* v) { return Vec3d{v[0], v[1], v[2]}; };
  const auto read_pose = [&](const tandem_pose& p) {
    return Pose{vector(p.position), {p.quaternion[0], p.quaternion[1], p.quaternion[2], p.quaternion[3]}};
  };
  const auto read_twist = [&](const tandem_twist& t) {
    return Twist{vector(t.velocity), vector(t.angular_velocity)};
  };
  const double length = to_seconds(Nanoseconds{window->end - window->begin});
  // Round-off of `step * micro_step` may pass the end.
  if (!(seconds >= 0 && seconds <= length * (1 + 1e-9)))
    return tandem_fail(TANDEM_ERROR_INTERNAL,
                       fmt::format("{} s is not in the window of {} s", seconds, length).c_str(),
                       "tandem_pose_at", "give the time since the window's begin");
  try {
    const particles::PreparedPath path =
        particles::prepare_path({read_pose(motion->begin_pose), read_pose(motion->end_pose),
                                 read_twist(motion->begin_twist), read_twist(motion->end_twist)},
                                length);
    const double s = seconds / length;
    if (pose) {
      if (s <= 0) {
        *pose = motion->begin_pose;
      } else if (s >= 1) {
        *pose = motion->end_pose;
      } else {
        const Vec3d p = particles::pose_on_path(path, s).p;
        const Quat q = particles::small_exp(particles::rotation_on_path(path, particles::HermiteBasis(s))) *
                       path.segment.begin.q_WB;
        *pose = {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
      }
    }
    if (twist) {
      const auto [v, w] = s <= 0 ? path.segment.begin_twist : particles::twist_on_path(path, s);
      *twist = {{v.x, v.y, v.z}, {w.x, w.y, w.z}};
    }
    return TANDEM_OK;
  } catch (const Error& error) {
    return tandem_fail(TANDEM_ERROR_NUMERICS, error.problem().c_str(), error.where().c_str(),
                       error.hint().c_str());
  }
}

const char* tandem_participant_version(void) {
  return TANDEM_VERSION;
}

}  // extern "C"

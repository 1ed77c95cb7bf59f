// A check of the judge, and what it finds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/math/vec3.hpp"
#include "common/scene/model.hpp"
#include "launch/conform/session.hpp"

namespace tandem::conform {

// One comparison of a number or a vector.
struct Finding {
  std::string what, unit;
  std::vector<double> measured, expected;
  double deviation = 0;                                   // length of the difference
  double tolerance = 0;                                   // of the deviation
  bool passed() const { return deviation <= tolerance; }  // false for a NaN
};

// The work place of a check: starts the participant on the scene of the check, and takes its findings.
class Examination {
 public:
  Examination(Subject& subject, const JudgedScene& scene, const Limits& limits)
      : subject_(subject), scene_(scene), limits_(limits) {}

  // The participant, registered and configured.
  std::unique_ptr<Session> open(const std::filesystem::path& state_folder = {}) {
    auto session = std::make_unique<Session>(subject_, scene_, limits_, state_folder);
    accepted_ = true;
    return session;
  }
  Subject& subject() { return subject_; }
  const JudgedScene& judged() const { return scene_; }
  const scene::Scene& scene() const { return scene_.scene; }
  const Limits& limits() const { return limits_; }

  void compare(const std::string& what, double measured, double expected, double tolerance,
               const std::string& unit);
  void compare(const std::string& what, Vec3d measured, Vec3d expected, double tolerance,
               const std::string& unit);
  // For what is true or not: `sentence` says what is wrong where it is not.
  void expect(bool holds, const std::string& sentence);

  const std::vector<Finding>& findings() const { return findings_; }
  // Whether the participant has taken the scene.
  bool accepted() const { return accepted_; }
  // The first sentence of a failed expectation; empty: none.
  const std::string& complaint() const { return complaint_; }

 private:
  Subject& subject_;
  const JudgedScene& scene_;
  const Limits& limits_;
  std::vector<Finding> findings_;
  std::string complaint_;
  bool accepted_ = false;
};

struct Check {
  const char* name;
  const char* meaning;    // for the report and docs/conform.md
  std::uint64_t needs;    // capability bits; a participant without them is not judged by this check
  const char* scene_mbd;  // built-in scene for each role; null: the check is not of this role
  const char* scene_dem;
  bool any_scene;  // holds on the user's scene as well
  void (*run)(Examination& examination);
  bool is_long = false;  // only where it is asked for, by Limits::long_run or by its name
  const char* scene_sph = nullptr;

  const char* scene(protocol::Role role) const {
    return role == protocol::Role::mbd ? scene_mbd : role == protocol::Role::dem ? scene_dem : scene_sph;
  }
  bool of(protocol::Role role) const { return scene(role) != nullptr; }
};

// All checks, in the order of the report.
const std::vector<Check>& checks();
// Parts of that table.
void add_session_checks(std::vector<Check>& table);
void add_motion_checks(std::vector<Check>& table);
void add_prediction_checks(std::vector<Check>& table);
void add_joint_checks(std::vector<Check>& table);
void add_load_checks(std::vector<Check>& table);
void add_wall_checks(std::vector<Check>& table);
void add_contact_checks(std::vector<Check>& table);
void add_particle_checks(std::vector<Check>& table);
void add_liquid_checks(std::vector<Check>& table);
void add_long_checks(std::vector<Check>& table);

// The table of docs/conform.md.
std::string checks_as_markdown();

}  // namespace tandem::conform

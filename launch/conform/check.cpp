#include "launch/conform/check.hpp"

#include <fmt/format.h>

#include <cmath>

#include "protocol/registration.hpp"

namespace tandem::conform {

void Examination::compare(const std::string& what, double measured, double expected, double tolerance,
                          const std::string& unit) {
  findings_.push_back({what, unit, {measured}, {expected}, std::abs(measured - expected), tolerance});
}

void Examination::compare(const std::string& what, Vec3d measured, Vec3d expected, double tolerance,
                          const std::string& unit) {
  findings_.push_back({what,
                       unit,
                       {measured.x, measured.y, measured.z},
                       {expected.x, expected.y, expected.z},
                       norm(measured - expected),
                       tolerance});
}

void Examination::expect(bool holds, const std::string& sentence) {
  if (!holds && complaint_.empty()) complaint_ = sentence;
}

const std::vector<Check>& checks() {
  static const std::vector<Check> table = [] {
    std::vector<Check> all;
    add_session_checks(all);
    add_motion_checks(all);
    add_prediction_checks(all);
    add_joint_checks(all);
    add_load_checks(all);
    add_wall_checks(all);
    add_particle_checks(all);
    add_contact_checks(all);
    add_liquid_checks(all);
    add_long_checks(all);
    return all;
  }();
  return table;
}

std::string checks_as_markdown() {
  std::string text =
      "| check | of | capability | scene | any scene | what it means |\n|---|---|---|---|---|---|\n";
  for (const Check& check : checks()) {
    std::string roles, scene;
    for (const protocol::Role role : protocol::all_roles) {
      if (!check.of(role)) continue;
      roles += fmt::format("{}{}", roles.empty() ? "" : ", ", protocol::word_of(role));
      scene += fmt::format("{}`{}`", scene.empty() ? "" : ", ", check.scene(role));
    }
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", check.name, roles,
                        check.needs == 0 ? "-" : "`" + protocol::capability_names(check.needs) + "`", scene,
                        check.any_scene ? "yes" : "no", check.meaning);
  }
  return text;
}

}  // namespace tandem::conform

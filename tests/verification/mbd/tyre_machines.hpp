// Wheels and vehicles on tyres.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/parse.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem::mbd::tyres {

using nlohmann::json;
constexpr double g = 9.81;

inline void expect_share(const std::string& what, double measured, double expected, double share) {
  std::printf("  %-46s expected %14.8g measured %14.8g deviation %8.1e tolerance %.1e\n", what.c_str(),
              expected, measured, measured / expected - 1, share);
  EXPECT_NEAR(measured, expected, share * std::abs(expected)) << what;
}

// A run that is observed at the end of each window.
class TyreRun {
 public:
  explicit TyreRun(const json& document) : TyreRun(scene_of(document)) {}
  // `meshes` are those of the scene's files.
  explicit TyreRun(scene::Scene scene, const std::vector<NamedMesh>& meshes = {}) : scene_(std::move(scene)) {
    log::setup("test", "error");
    columns_ = scene::element_columns(scene_);
    solver_.configure(scene_, meshes);
  }
  static scene::Scene scene_of(json document) {
    document["tandem"] = "1.1", document["name"] = "vehicle", document["end_time"] = 100;
    document["coupling"]["window"] = window_;
    scene::Scene scene = scene::parse(document.dump(), "scene.json");
    scene::validate(scene, "scene.json");
    return scene;
  }
  void advance(double time) {
    for (const double end = this->time() + time - 0.5 * window_; this->time() < end; ++done_) {
      protocol::LoadSet loads;
      loads.window = {done_, to_nanoseconds(static_cast<double>(done_) * window_),
                      to_nanoseconds(static_cast<double>(done_ + 1) * window_)};
      solver_.advance(loads);
    }
    values_ = solver_.observe().elements;
  }
  double time() const { return static_cast<double>(done_) * window_; }
  double operator[](const std::string& column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    EXPECT_NE(found, columns_.end()) << column;
    return found == columns_.end() ? NAN : values_[static_cast<std::size_t>(found - columns_.begin())];
  }
  protocol::BodiesFrame seen() { return solver_.observe(); }
  json facts() { return json::parse(solver_.report().facts); }

 private:
  static constexpr double window_ = 1e-3;
  scene::Scene scene_;
  std::vector<std::string> columns_;
  MbdSolver solver_;
  std::vector<double> values_;
  std::uint64_t done_ = 0;
};

struct TyreData {
  double radius = 0.3, stiffness = 2e5, friction = 0.9, slip = 14, cornering = 11, relaxation = 0.25,
         patch = 0.12, resistance = 0;
  json element(const std::string& name, const std::string& joint) const {
    return {{"name", name},
            {"type", "tyre"},
            {"joint", joint},
            {"radius", radius},
            {"stiffness", stiffness},
            {"damping", 2000},
            {"friction", friction},
            {"slip_stiffness", slip},
            {"cornering_stiffness", cornering},
            {"relaxation_length", relaxation},
            {"rolling_resistance", resistance},
            {"patch_length", patch}};
  }
};

inline json body_of(const std::string& name, double mass, double inertia, std::array<double, 3> position) {
  return {{"name", name}, {"mass", mass}, {"inertia", {inertia, inertia, inertia}}, {"position", position}};
}

// A wheel under a sliding weight on a carriage that moves along x. Its plane is turned by `yaw` about z.
struct Rig {
  TyreData tyre;
  double speed = 10, mass = 400, yaw = 0;

  double load() const { return mass * g; }
  double loaded_radius() const { return tyre.radius - load() / tyre.stiffness; }
  // The wheel rolls with the theoretical slip s along its plane.
  json scene(double s) const {
    const double z = loaded_radius(), rolling = speed * std::cos(yaw) / (1 - s), rate = rolling / z;
    json scene;
    scene["mbd"]["bodies"] = {body_of("carriage", 1, 1, {0, 0, 1}),
                              body_of("weight", mass - 10, 10, {0, 0, z}),
                              body_of("wheel", 10, 0.5, {0, 0, z})};
    scene["mbd"]["joints"] = {{{"name", "rail"},
                               {"type", "prismatic"},
                               {"child", "carriage"},
                               {"position", {0, 0, 1}},
                               {"axis", {1, 0, 0}},
                               {"motion", {{"type", "constant"}, {"rate", speed}}}},
                              {{"name", "guide"},
                               {"type", "prismatic"},
                               {"parent", "carriage"},
                               {"child", "weight"},
                               {"position", {0, 0, z}},
                               {"axis", {0, 0, 1}}},
                              {{"name", "hub"},
                               {"type", "revolute"},
                               {"parent", "weight"},
                               {"child", "wheel"},
                               {"position", {0, 0, z}},
                               {"axis", {-std::sin(yaw), std::cos(yaw), 0}},
                               {"motion", {{"type", "constant"}, {"rate", rate}}}}};
    scene["mbd"]["forces"] = {tyre.element("tyre", "hub")};
    return scene;
  }
};

// Four wheels on a chassis; the front wheels are steered by a fixed angle.
struct Vehicle {
  TyreData front, rear;
  double mass = 1200, a = 1.2, b = 1.4, height = 0.5, track = 1.5, speed = 20, steer = 0, inertia = 1500;
  double wheel_mass = 15, wheel_inertia = 0.6;

  double wheelbase() const { return a + b; }
  double all() const { return mass + 4 * wheel_mass; }
  json scene(double torque_front, double torque_rear) const {
    json scene;
    json& mbd = scene["mbd"];
    const double z = front.radius;
    const double drop = mass * g / 4 / front.stiffness;
    mbd["bodies"] = json::array();
    mbd["bodies"].push_back({{"name", "chassis"},
                             {"mass", mass},
                             {"inertia", {400, inertia, inertia}},
                             {"position", {0, 0, height - drop}},
                             {"velocity", {speed, 0, 0}}});
    mbd["joints"] = json::array(), mbd["forces"] = json::array();
    for (const bool is_front : {true, false})
      for (const double side : {1.0, -1.0}) {
        const std::string name = std::string(is_front ? "front" : "rear") + (side > 0 ? "_left" : "_right");
        const std::array<double, 3> p{is_front ? a : -b, side * track / 2, z - drop};
        const double yaw = is_front ? steer : 0;
        mbd["bodies"].push_back(body_of(name, wheel_mass, wheel_inertia, p));
        mbd["joints"].push_back({{"name", name + "_hub"},
                                 {"type", "revolute"},
                                 {"parent", "chassis"},
                                 {"child", name},
                                 {"position", p},
                                 {"axis", {-std::sin(yaw), std::cos(yaw), 0}},
                                 {"rate", speed * std::cos(yaw) / (z - drop)}});
        mbd["forces"].push_back((is_front ? front : rear).element(name + "_tyre", name + "_hub"));
        const double torque = is_front ? torque_front : torque_rear;
        if (torque != 0)
          mbd["forces"].push_back({{"name", name + "_brake"},
                                   {"type", "actuator"},
                                   {"joint", name + "_hub"},
                                   {"size", {{"type", "constant"}, {"value", torque}}}});
      }
    return scene;
  }
};

}  // namespace tandem::mbd::tyres

// Multibody scenes made in code, and a run of them without the protocol.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/scene/model.hpp"
#include "mbd_server/io/observation.hpp"
#include "mbd_server/setup/build.hpp"
#include "mbd_server/solve/assembly.hpp"
#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd::machines {

scene::Scene empty(Vec3d gravity = {0, 0, -9.81});

// Body with principal inertia `inertia` at `position`, axes of the world.
BodyId add_body(scene::Scene& scene, const std::string& name, double mass, Vec3d inertia, Vec3d position);
scene::Joint& add_joint(scene::Scene& scene, const std::string& name, scene::JointType type, BodyId parent,
                        BodyId child, Vec3d position, Vec3d axis = {0, 0, 1});
// Makes `body` a boundary body: a wall is fixed to it.
void add_wall(scene::Scene& scene, BodyId body);

// A01 of the notes: point mass 1 kg on a massless bar of 1 m in the x-y plane, gravity -y, from (-1, 0) at
// rest.
scene::Scene pendulum();
// Top of the notes on a spherical joint at the origin; its rates are set by heavy_top_state.
scene::Scene heavy_top();
// One body without a joint.
scene::Scene free_body(double mass, Vec3d inertia, Vec3d gravity);
// A bead of `mass` on a rail along x, moving at `speed`, without gravity.
scene::Scene bead(double mass, double speed);
// A02: windows of uniform rods of 1 m and 1 kg side by side, verticals up, turning at -1 rad/s.
scene::Scene ladder(int windows);
// Uniform rods of 0.1 m and 0.1 kg on revolute joints, from the horizontal.
scene::Scene chain(int links);
// launch/scenes/mbd/NAME.json
std::string shipped_folder();
scene::Scene shipped(const std::string& name);
// Every elementary joint, body-to-body and ground springs, rotational spring, dampers, a driven joint,
// branches, a welded body, two boundary bodies.
scene::Scene menagerie();

// A run of one scene with steps of one length.
struct Run {
  scene::Scene scene;
  Model model;
  MachineSystem system;
  State state;
  AssemblyReport assembly;
  GeneralizedAlpha integrator;
  double step;

  Run(const scene::Scene& scene, double step, double rho_inf = 0.9, NewtonSettings newton = {1e-13, 30},
      Constraints constraints = Constraints::index2);
  Run(const Run&) = delete;  // the system refers to the model
  // Another first state than that of the scene.
  void restart(const std::function<void(State&)>& change);
  void advance(int steps);
  // The same; processor time that it took [s].
  double advance_timed(int steps);
  // Position of a body's centre of mass at the present state [m].
  Vector3d position(int body);
  Vector3d velocity(int body);
  // A joint of the scene at the present state.
  JointObservation joint(const std::string& name);
  double energy();  // [J]
};

}  // namespace tandem::mbd::machines

// Checks of a particle participant: contact of spheres with each other, loads of several bodies, inlets and
// outlets.
#include <algorithm>
#include <cmath>

#include "launch/conform/load_run.hpp"

namespace tandem::conform {
namespace {

using protocol::LoadSet;
using protocol::ParticlesFrame;

// The frame has these spheres and no others; a complaint otherwise.
bool has_two_spheres(Examination& e, const ParticlesFrame& frame) {
  const bool both = frame.id == std::vector<std::uint32_t>{0, 1};
  e.expect(both, "the frame has not the two spheres of the scene");
  return both;
}

void sphere_impact(Examination& e) {
  const auto session = e.open();
  LoadSet loads = rest_windows(*session, e.scene(), 40);
  const ParticlesFrame frame = session->particles();
  if (!has_two_spheres(e, frame)) return;
  const Vec3d v[] = {vector_of(frame.velocity, 0), vector_of(frame.velocity, 1)};
  const Vec3d before[] = {e.scene().dem->particles[0].velocity, e.scene().dem->particles[1].velocity};
  const double m[] = {mass_of(e, 0), mass_of(e, 1)};
  const Vec3d closing = before[0] - before[1];
  const double restitution = e.scene().dem->pairs.at(0).restitution;
  // Laws differ in how they end a contact, which changes the velocity by some percent.
  e.compare("velocity of the second sphere relative to the first one after the impact", v[1] - v[0],
            restitution * closing, 0.1 * norm(closing), "m/s");
  const Vec3d momentum = m[0] * before[0] + m[1] * before[1];
  const double size = m[0] * norm(before[0]) + m[1] * norm(before[1]);
  e.compare("momentum of both after the impact", m[0] * v[0] + m[1] * v[1], momentum, 1e-5 * size, "kg m/s");
  const double reach = e.scene().dem->particles[0].radius_min + e.scene().dem->particles[1].radius_min;
  e.expect(vector_of(frame.position, 1).x - vector_of(frame.position, 0).x > reach,
           "the spheres do not leave each other on the sides from which they came");
}

void sphere_stack(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 200);
  constexpr int count = 50;
  Vec3d force;
  for (int i = 0; i < count; ++i)
    force += (1.0 / count) * load_or_zero(rest_windows(*session, e.scene(), 1), 1).mean.force;
  const Vec3d weight = (mass_of(e, 0) + mass_of(e, 1)) * e.scene().gravity;
  e.compare("force of both spheres on the tray", force, weight, 2e-3 * norm(weight), "N");
  const ParticlesFrame frame = session->particles();
  if (!has_two_spheres(e, frame)) return;
  const double small = e.scene().dem->particles[1].radius_min,
               reach = e.scene().dem->particles[0].radius_min + small;
  e.compare("the upper sphere's centre from the lower one's",
            vector_of(frame.position, 1) - vector_of(frame.position, 0), {0, 0, reach}, 0.05 * small, "m");
}

void loads_of_bodies(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 200);
  constexpr int count = 50;
  Wrench mean[2];
  for (int i = 0; i < count; ++i) {
    const LoadSet loads = rest_windows(*session, e.scene(), 1);
    for (std::uint32_t body = 0; body < 2; ++body) {
      mean[body].force += (1.0 / count) * load_or_zero(loads, body).mean.force;
      mean[body].torque += (1.0 / count) * load_or_zero(loads, body).mean.torque;
    }
  }
  for (std::uint32_t body = 0; body < 2; ++body) {
    const Vec3d weight = mass_of(e, body) * e.scene().gravity;
    const std::string of = "'" + e.scene().mbd->bodies[body].name + "'";
    e.compare("force on " + of, mean[body].force, weight, 2e-3 * norm(weight), "N");
    // The sphere lies above the centre of mass.
    e.compare("torque on " + of, mean[body].torque, {}, 1e-3 * norm(weight), "N m");
  }
}

// ---- inlets and outlets

struct InletFlow {
  const scene::ParticleGroup& group;
  const scene::InletFill& fill;
  std::uint32_t first;  // id of its first sphere
  double interval;      // between two spheres [s]
};

// A sphere is due every `interval`; it may come in a window later.
void compare_inlet(Examination& e, const InletFlow& inlet, const ParticlesFrame& frame, double time) {
  const auto count = static_cast<std::uint32_t>(*inlet.fill.count);
  const double due = std::min(std::floor(time / inlet.interval) + 1, static_cast<double>(count));
  std::uint32_t there = 0;
  const double radius = inlet.group.radius_min;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    const std::uint32_t id = frame.id[i];
    if (id < inlet.first || id >= inlet.first + count) continue;
    ++there;
    const std::string of = "sphere " + std::to_string(id) + " of '" + inlet.group.name + "'";
    const Vec3d v = inlet.group.velocity;
    e.compare("velocity of " + of, vector_of(frame.velocity, i), v, 1e-5 * norm(v), "m/s");
    e.compare("radius of " + of, static_cast<double>(frame.radius[i]), radius, 1e-6 * radius, "m");
    // Where it was when it was due.
    const Vec3d x = vector_of(frame.position, i) - (time - inlet.interval * (id - inlet.first)) * v;
    double outside = 0;
    for (int a = 0; a < 3; ++a)
      outside = std::max({outside, inlet.fill.min[a] + radius - x[a], x[a] - (inlet.fill.max[a] - radius)});
    e.compare("distance from the inlet's box at which " + of + " came in", outside, 0, 2 * H * norm(v), "m");
  }
  e.compare("spheres of '" + inlet.group.name + "' by t = " + std::to_string(time) + " s", there, due, 0, "");
}

void inlets(Examination& e) {
  const auto session = e.open();
  const scene::Dem& dem = e.scene().dem.value();
  std::vector<InletFlow> flows;
  std::uint32_t first = 1;  // after the sphere that is there
  for (std::size_t i = 1; i < dem.particles.size(); ++i) {
    const auto& fill = std::get<scene::InletFill>(dem.particles[i].fill);
    flows.push_back(
        {dem.particles[i], fill, first, fill.rate ? 1 / *fill.rate : mass_of(e, i) / *fill.mass_rate});
    first += static_cast<std::uint32_t>(*fill.count);
  }
  Vec3d gone;
  double lost = 0;
  for (int i = 1; i <= 25; ++i) {
    const LoadSet loads = rest_windows(*session, e.scene(), 1);
    gone += loads.account.lost_momentum;
    lost = static_cast<double>(loads.account.lost_particles);
    // Between two arrivals, so that it does not matter at which end of a window a sphere comes in.
    if (i % 5 != 3) continue;
    const ParticlesFrame frame = session->particles();
    for (const InletFlow& flow : flows) compare_inlet(e, flow, frame, session->time());
    e.expect(std::ranges::find(frame.id, 0U) != frame.id.end(),
             "the sphere that was there at the start is gone");
  }
  Vec3d brought;
  double size = 0;
  for (std::size_t i = 1; i < dem.particles.size(); ++i) {
    const Vec3d p =
        (static_cast<double>(*flows[i - 1].fill.count) * mass_of(e, i)) * dem.particles[i].velocity;
    brought += p;
    size += norm(p);
  }
  e.compare("momentum that left, less what came in", gone, -brought, 1e-5 * size, "kg m/s");
  e.compare("spheres lost", lost, 0, 0, "");
}

void outlet(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 8);
  if (!has_two_spheres(e, session->particles())) return;
  const Vec3d leaving = mass_of(e, 0) * e.scene().dem->particles[0].velocity;
  Vec3d gone;
  LoadSet loads;
  for (int i = 0; i < 6; ++i) {
    loads = rest_windows(*session, e.scene(), 1);
    gone += loads.account.lost_momentum;
  }
  e.expect(session->particles().id == std::vector<std::uint32_t>{1},
           "the sphere inside the outlet is still in the frame, or the other one is not, or has another id");
  e.compare("momentum that left", gone, leaving, 1e-4 * norm(leaving), "kg m/s");
  e.compare("spheres lost, to which those of an outlet do not count",
            static_cast<double>(loads.account.lost_particles), 0, 0, "");
}

}  // namespace

void add_contact_checks(std::vector<Check>& table) {
  const auto add = [&](const char* name, const char* meaning, const char* scene, void (*run)(Examination&)) {
    table.push_back({name, meaning, 0, nullptr, scene, false, run});
  };
  add("sphere_impact",
      "two spheres that meet leave each other with the restitution of their materials, and keep their "
      "momentum",
      "impact", sphere_impact);
  add("sphere_stack", "a sphere rests on another one, which bears its weight", "stack", sphere_stack);
  add("loads_of_bodies", "each body has the load of the spheres on its own walls", "trays", loads_of_bodies);
  add("inlets",
      "spheres come in at the rate, or the mass rate, of an inlet: in its box, with its velocity, as many as "
      "it counts; their momentum is recorded",
      "inlets", inlets);
  add("outlet", "a sphere in an outlet is taken out, is not lost, and its momentum is recorded", "outlet",
      outlet);
}

}  // namespace tandem::conform

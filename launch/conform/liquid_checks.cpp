// Checks of a participant that computes a liquid.
#include <algorithm>
#include <cmath>

#include "launch/conform/load_run.hpp"

namespace tandem::conform {
namespace {

using protocol::LoadSet;
using protocol::ParticlesFrame;

// The box that the scenes of these checks fill.
const scene::Box& box_of(const scene::Liquid& liquid) {
  return std::get<scene::Box>(liquid.fill.front());
}
double volume_of(const scene::Liquid& liquid) {
  const Vec3d edges = box_of(liquid).max - box_of(liquid).min;
  return edges.x * edges.y * edges.z;
}
const scene::Liquid& liquid_of(const Examination& e) {
  return e.scene().sph.value().liquids.front();
}
double mass_of_liquid(const Examination& e) {
  return liquid_of(e).density * volume_of(liquid_of(e));
}

void liquid_weight(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 200);
  constexpr int count = 100;
  Wrench mean;
  for (int i = 0; i < count; ++i) {
    const protocol::BodyLoad load = load_or_zero(rest_windows(*session, e.scene(), 1), 0);
    mean.force += (1.0 / count) * load.mean.force;
    mean.torque += (1.0 / count) * load.mean.torque;
  }
  const Vec3d weight = mass_of_liquid(e) * e.scene().gravity;
  e.compare("force on the basin", mean.force, weight, 1e-2 * norm(weight), "N");
  // The liquid is in the middle of the basin.
  e.compare("torque on the basin about its centre of mass", mean.torque, Vec3d{}, 1e-2 * 0.06 * norm(weight),
            "N m");
}

void liquid_flight(Examination& e) {
  const auto session = e.open();
  Vec3d begin, given;
  LoadSet loads;
  for (int i = 0; i < 40; ++i) {
    loads = rest_windows(*session, e.scene(), 1);
    if (i == 0) begin = loads.account.momentum_begin;
    given += loads.account.gravity_impulse;
  }
  const double mass = mass_of_liquid(e);
  const Vec3d start = mass * liquid_of(e).velocity, impulse = (session->time() * mass) * e.scene().gravity;
  e.compare("momentum at the start", begin, start, 1e-6 * norm(start), "kg m/s");
  e.compare("impulse of gravity in the account", given, impulse, 1e-6 * norm(impulse), "N s");
  e.compare("momentum got", loads.account.momentum_end - begin, impulse, 1e-5 * norm(impulse), "N s");
}

void liquid_frame(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 200);
  const ParticlesFrame frame = session->particles();
  const scene::Sph& sph = e.scene().sph.value();
  constexpr std::size_t stride = ParticlesFrame::liquid_values;
  const double spacing = sph.spacing, count = volume_of(liquid_of(e)) / (spacing * spacing * spacing);
  e.compare("number of particles", static_cast<double>(frame.id.size()), std::round(count), 0, "");
  if (frame.liquid.size() != stride * frame.id.size()) {
    e.expect(false, "the frame lacks pressure and density");
    return;
  }
  double lowest = 0, number = 0, inside = 0;
  double density = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    bool in_domain = true;
    for (std::size_t a = 0; a < 3; ++a)
      in_domain = in_domain && frame.position[3 * i + a] >= sph.domain.min[static_cast<int>(a)] &&
                  frame.position[3 * i + a] <= sph.domain.max[static_cast<int>(a)];
    inside += in_domain ? 1 : 0;
    density += static_cast<double>(frame.liquid[stride * i + 1]) / static_cast<double>(frame.id.size());
    // The layer of particles on the floor.
    if (frame.position[3 * i + 2] > box_of(liquid_of(e)).min.z + spacing) continue;
    lowest += static_cast<double>(frame.liquid[stride * i]);
    ++number;
  }
  e.compare("particles inside the domain", inside, static_cast<double>(frame.id.size()), 0, "");
  e.compare("mean density", density, liquid_of(e).density, 0.02 * liquid_of(e).density, "kg/m3");
  const scene::Box& box = box_of(liquid_of(e));
  const double depth = box.max.z - box.min.z - 0.5 * spacing,
               pressure = liquid_of(e).density * norm(e.scene().gravity) * depth;
  e.compare("mean pressure of the lowest layer", lowest / std::max(1.0, number), pressure, 0.1 * pressure,
            "Pa");
}

}  // namespace

void add_liquid_checks(std::vector<Check>& table) {
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* scene,
                       void (*run)(Examination&)) {
    table.push_back({name, meaning, needs, nullptr, nullptr, false, run, false, scene});
  };
  add("liquid_weight", "a liquid at rest loads the body that holds it by its weight", 0, "basin",
      liquid_weight);
  add("liquid_flight", "without walls the momentum of the liquid changes by the impulse of gravity", 0,
      "block", liquid_flight);
  add("liquid_frame",
      "the frame has all particles, inside the domain, with the density of the liquid and a pressure that "
      "grows "
      "with the depth",
      protocol::can_observe_liquid, "basin", liquid_frame);
}

}  // namespace tandem::conform

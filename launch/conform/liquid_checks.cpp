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
  const Vec3d start = mass * liquid_of(e).velocity.value_or(Vec3d{}),
              impulse = (session->time() * mass) * e.scene().gravity;
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

double mass_of_particle(const Examination& e) {
  const double s = e.scene().sph.value().spacing;
  return liquid_of(e).density * s * s * s;
}

// What left with particles less what came in, over so many windows; each closes its balance of momentum.
Vec3d gone_in_windows(Examination& e, Session& session, int count) {
  Vec3d gone;
  double worst = 0, scale = 0;
  for (int i = 0; i < count; ++i) {
    const LoadSet loads = rest_windows(session, e.scene(), 1);
    const protocol::ParticleAccount& a = loads.account;
    gone += a.lost_momentum;
    Vec3d reaction;
    for (const protocol::BodyLoad& load : loads.bodies) reaction += -H * load.mean.force;
    worst = std::max(
        worst, norm(a.momentum_end - a.momentum_begin + a.lost_momentum - a.gravity_impulse - reaction));
    scale = std::max({scale, norm(a.momentum_end), norm(a.lost_momentum)});
    e.expect(a.lost_particles == 0, "particles of an inlet or an outlet count as lost");
  }
  e.compare("largest momentum of a window that no load, inlet or outlet gave", worst, 0, 1e-6 * scale, "N s");
  return gone;
}

void liquid_inlet(Examination& e) {
  const auto session = e.open();
  const ParticlesFrame start = session->particles();
  const Vec3d gone = gone_in_windows(e, *session, 180);
  const ParticlesFrame frame = session->particles();
  const scene::LiquidInlet& inlet = e.scene().sph->inlets.front();
  const auto& [width, height] = std::get<scene::RectangleShape>(inlet.shape);
  const double spacing = e.scene().sph->spacing, t = session->time();
  const Vec3d v = inlet.pose.q_WB.rotate({0, 0, inlet.speed()});
  const std::size_t first = start.id.size();
  if (frame.id.size() < first || !std::equal(start.id.begin(), start.id.end(), frame.id.begin())) {
    e.expect(false, "the particles that were there at the start are gone, or have other ids");
    return;
  }
  const auto came = static_cast<double>(frame.id.size() - first);
  const double flow = liquid_of(e).density * inlet.area() * inlet.speed();
  e.compare("mass that came in, within a layer", came * mass_of_particle(e), flow * t,
            liquid_of(e).density * inlet.area() * spacing, "kg");
  e.compare("momentum that left, less what came in", gone, -came * mass_of_particle(e) * v,
            1e-5 * norm(flow * t * v), "kg m/s");
  double outside = 0;
  Vec3d mean;
  for (std::size_t i = first; i < frame.id.size(); ++i) {
    const Vec3d x = inlet.pose.q_WB.conjugate().rotate(vector_of(frame.position, i) - inlet.pose.p_WB);
    outside = std::max({outside, std::fabs(x.x) - 0.5 * width, std::fabs(x.y) - 0.5 * height, -x.z,
                        x.z - inlet.speed() * t});
    mean += (1 / came) * vector_of(frame.velocity, i);
  }
  e.compare("distance of a particle from the jet of the inlet", outside, 0, spacing, "m");
  e.compare("mean velocity of what came in", mean, v, 5e-2 * norm(v), "m/s");
}

void liquid_outlet(Examination& e) {
  const auto session = e.open();
  const ParticlesFrame start = session->particles();
  const double mass = mass_of_particle(e), layer = 36 * mass;
  const Vec3d v = liquid_of(e).velocity.value_or(Vec3d{});
  const Vec3d half = gone_in_windows(e, *session, 100);
  const auto left =
      static_cast<double>(start.id.size()) - static_cast<double>(session->particles().id.size());
  e.compare("mass that went out with half of the block, within a layer", left * mass, 3 * layer, layer, "kg");
  e.compare("momentum that left with it", half, left * mass * v, 1e-3 * norm(3 * layer * v), "kg m/s");
  const Vec3d all = half + gone_in_windows(e, *session, 100);
  e.compare("momentum that left with the block", all, 6 * layer * v, 1e-3 * norm(6 * layer * v), "kg m/s");
  const std::vector<std::uint32_t> others(
      start.id.begin() + std::min<std::ptrdiff_t>(216, std::ssize(start.id)), start.id.end());
  e.expect(session->particles().id == others,
           "particles inside the outlet are still in the frame, or others are not, or have other ids");
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
  add("liquid_inlet",
      "liquid comes in through an inlet, as a jet of its shape with its velocity and its mass per time; its "
      "momentum is recorded",
      0, "spout", liquid_inlet);
  add("liquid_outlet",
      "liquid that reaches an outlet is taken out, is not lost, and its momentum is recorded", 0, "drain",
      liquid_outlet);
}

}  // namespace tandem::conform

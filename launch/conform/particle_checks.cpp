// Checks of a particle participant: the particles themselves, and its account of them.
#include <algorithm>
#include <cmath>

#include "coordinator/watch/particle_watch.hpp"
#include "launch/conform/load_run.hpp"
#include "launch/conform/state_folder.hpp"

namespace tandem::conform {
namespace {

using protocol::LoadSet;
using protocol::ParticlesFrame;

double mass_of_radius(const Examination& e, double radius) {
  return launch::sphere_mass(e.scene().dem.value().materials[0].density, radius);
}
Vec3d at(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}
Vec3d at(const std::vector<float>& values, std::size_t i) {
  return Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]}.as<double>();
}
// Centres of the two spheres of scene `flight` at the start.
constexpr Vec3d start_of_flight[] = {{1, 1, 1}, {-1, 1, 2}};

void free_flight(Examination& e) {
  const auto session = e.open();
  const Vec3d g = e.scene().gravity;
  Vec3d begin, given;
  LoadSet loads;
  for (int i = 0; i < 40; ++i) {
    loads = rest_windows(*session, e.scene(), 1);
    if (i == 0) begin = loads.account.momentum_begin;
    given += loads.account.gravity_impulse;
  }
  const double t = session->time();
  Vec3d start;
  double mass = 0;
  for (const scene::ParticleGroup& group : e.scene().dem->particles) {
    const double m = mass_of_radius(e, group.radius_min);
    mass += m;
    start += m * group.velocity;
  }
  const Vec3d impulse = (t * mass) * g;
  e.compare("momentum at the start", begin, start, 1e-6 * norm(start), "kg m/s");
  e.compare("impulse of gravity in the account", given, impulse, 1e-6 * norm(impulse), "N s");
  e.compare("momentum got", loads.account.momentum_end - begin, impulse, 1e-5 * norm(impulse), "N s");
  const ParticlesFrame frame = session->particles();
  e.compare("number of spheres", static_cast<double>(frame.id.size()), 2, 0, "");
  for (std::size_t i = 0; i < std::min<std::size_t>(2, frame.id.size()); ++i) {
    const scene::ParticleGroup& group = e.scene().dem->particles[i];
    e.compare("position of " + group.name, at(frame.position, i),
              start_of_flight[i] + t * group.velocity + (0.5 * t * t) * g, 1e-2 * 0.5 * t * t * norm(g), "m");
    e.compare("velocity of " + group.name, at(frame.velocity, i), group.velocity + t * g, 1e-3 * t * norm(g),
              "m/s");
    e.compare("radius of " + group.name, static_cast<double>(frame.radius[i]), group.radius_min,
              1e-6 * group.radius_min, "m");
  }
}

void account_chain(Examination& e) {
  const auto session = e.open();
  LoadSet last = rest_windows(*session, e.scene(), 1);
  double jump = 0, scale = 0;
  for (int i = 0; i < 40; ++i) {
    const LoadSet next = rest_windows(*session, e.scene(), 1);
    jump = std::max(jump, norm(next.account.momentum_begin - last.account.momentum_end));
    scale = std::max(scale, norm(next.account.momentum_end));
    last = next;
  }
  e.compare("jump of the momentum between two windows", jump, 0, 1e-9 * scale, "kg m/s");
}

void micro_steps(Examination& e) {
  const auto session = e.open();
  for (const double length : {H, 0.7 * H, 1.3 * H}) {
    const LoadSet loads = session->advance(paths_at_rest(e.scene()), length);
    const protocol::ParticleAccount& a = loads.account;
    e.compare("micro steps times their length", static_cast<double>(a.micro_steps) * a.micro_step, length,
              1e-9 * length, "s");
    if (const auto step = e.subject().role() == protocol::Role::dem ? e.scene().dem.value().micro_step
                                                                    : e.scene().sph.value().micro_step)
      e.expect(a.micro_step <= *step * (1 + 1e-9), "the micro steps are longer than micro_step of the scene");
  }
}

// What a run says of some windows and of the frame after them.
struct Watched {
  launch::ParticleWatch watch;
  ParticlesFrame frame;
};
Watched watched(Examination& e) {
  const auto session = e.open();
  launch::SceneFile file;
  file.scene = e.scene();
  file.files = e.judged().configuration.files;
  Watched of{launch::ParticleWatch(file), {}};
  launch::Exchange window;
  for (int i = 0; i < 40; ++i) {
    window.load = rest_windows(*session, e.scene(), 1);
    of.watch.add(window);
  }
  of.frame = session->particles();
  of.watch.check(of.frame, of.watch.take_before());
  return of;
}

void compare_with_account(Examination& e, const Watched& of, std::size_t figure, double tolerance) {
  const launch::FrameDifference found = of.watch.differences()[figure];
  const std::string what = launch::ParticleWatch::figures[figure];
  e.compare("share of the " + what + " of the frame that is not in the account", found.share, 0, tolerance,
            "");
}

void kinetic_energy_of_account(Examination& e) {
  const Watched of = watched(e);
  double energy = 0, of_spin = 0;
  for (std::size_t i = 0; i < of.frame.id.size(); ++i) {
    const auto radius = static_cast<double>(of.frame.radius[i]);
    energy += norm2(at(of.frame.velocity, i));
    of_spin += 0.4 * radius * radius * norm2(at(of.frame.spin, i));
  }
  const bool friction = e.scene().dem->pairs.at(0).friction > 0;
  e.expect(!friction || of_spin > 1e-3 * energy, "spheres with friction do not roll");
  compare_with_account(e, of, 1, 1e-4);
}

void observe_particles(Examination& e) {
  const Watched of = watched(e);
  for (std::size_t kind = 0; kind < launch::ParticleWatch::kinds.size(); ++kind)
    e.compare(std::string("spheres of the wrong ") + launch::ParticleWatch::kinds[kind],
              static_cast<double>(of.watch.false_spheres()[kind].spheres), 0, 0, "");
  compare_with_account(e, of, 0, 1e-5);
}

void snapshot(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 40);
  const ParticlesFrame then = session->particles();
  session->remote().snapshot(then.time);
  rest_windows(*session, e.scene(), 1);
  ParticlesFrame kept;
  session->remote().observe_particles(then.time, kept);
  e.expect(kept.id == then.id && kept.position == then.position && kept.velocity == then.velocity &&
               kept.spin == then.spin && kept.radius == then.radius && kept.liquid == then.liquid,
           "the frame of the snapshot is not the one of its time");
  e.expect(session->particles().position != then.position, "the next frame is that of the snapshot");
}

void lost_particle(Examination& e) {
  const auto session = e.open();
  const Vec3d leaving = mass_of_radius(e, 0.02) * e.scene().dem->particles[0].velocity;
  Vec3d lost;
  LoadSet loads;
  for (int i = 0; i < 30; ++i) {
    loads = rest_windows(*session, e.scene(), 1);
    lost += loads.account.lost_momentum;
  }
  e.compare("spheres lost", static_cast<double>(loads.account.lost_particles), 1, 0, "");
  e.compare("momentum that left", lost, leaving, 1e-4 * norm(leaving), "kg m/s");
  const ParticlesFrame frame = session->particles();
  e.expect(frame.id.size() == 1, "the frame still has the sphere that left, or none");
  if (frame.id.size() == 1) e.compare("id of the sphere that stays", frame.id[0], 1, 0, "");
}

void periodic(Examination& e) {
  const auto session = e.open();
  const ParticlesFrame start = session->particles();
  const LoadSet loads = rest_windows(*session, e.scene(), 40);
  const ParticlesFrame frame = session->particles();
  e.compare("spheres lost", static_cast<double>(loads.account.lost_particles), 0, 0, "");
  e.expect(frame.id == start.id && frame.id.size() == 1,
           "the sphere has another id beyond the periodic face");
  if (frame.id.size() != 1 || start.id.size() != 1) return;
  // It enters again through the opposite face.
  const Vec3d expected =
      at(start.position, 0) + session->time() * e.scene().dem->particles[0].velocity - Vec3d{1, 0, 0};
  e.compare("position beyond the periodic face", at(frame.position, 0), expected, 1e-6, "m");
}

void particle_checkpoint(Examination& e) {
  const StateFolder folder;
  const auto session = e.open(folder.path());
  rest_windows(*session, e.scene(), 20);
  const protocol::Checkpoint file = session->checkpoint((folder.path() / "state").string());
  std::vector<LoadSet> first;
  for (int i = 0; i < 5; ++i) first.push_back(rest_windows(*session, e.scene(), 1));
  const auto resumed = e.open(folder.path());
  resumed->resume(file);
  bool same = true;
  for (const LoadSet& loads : first) same = same && same_bits(rest_windows(*resumed, e.scene(), 1), loads);
  e.expect(same, "a run that goes on from the file has other bits");
}

}  // namespace

void add_particle_checks(std::vector<Check>& table) {
  using namespace protocol;
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* scene,
                       bool any, void (*run)(Examination&), const char* of_liquid = nullptr) {
    table.push_back({name, meaning, needs, nullptr, scene, any, run, false, of_liquid});
  };
  add("free_flight", "in flight, momentum changes by the impulse of gravity, and positions by v t + g t2/2",
      0, "flight", false, free_flight);
  add("account_chain", "each window begins with the momentum with which the last one ended", 0, "bed", true,
      account_chain, "basin");
  add("micro_steps", "a whole number of micro steps, none longer than the scene's, fills each window", 0,
      "bed", true, micro_steps, "basin");
  add("kinetic_energy", "the account has the energy of translation and rotation of all spheres", 0, "bed",
      false, kinetic_energy_of_account);
  add("observe_particles",
      "the frame has all spheres, with their radii, inside the domain, with the momentum of the account", 0,
      "bed", true, observe_particles);
  add("snapshot", "a frame that was kept is sent after the next window as it was", can_snapshot, "bed", false,
      snapshot, "basin");
  add("lost_particle",
      "a sphere that leaves the domain is counted and taken out, and its momentum is recorded; the others "
      "keep their ids",
      0, "way_out", false, lost_particle);
  add("periodic", "a sphere beyond a periodic face is inside the domain again, with its id", 0, "round_trip",
      false, periodic);
  add("particle_checkpoint", "a run that goes on from a file has the same bits", can_checkpoint, "bed", true,
      particle_checkpoint, "basin");
}

}  // namespace tandem::conform

#include "tests/doubles/oscillator_bed.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>

namespace tandem::test {
namespace {

// Position and velocity of the bed, and the integrals of F, (t - H/2) F and F v.
using State = std::array<double, 5>;

State plus(State a, double h, const State& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += h * b[i];
  return a;
}

// The cubic with these positions and velocities at its ends.
struct Path {
  double x0, v0, x1, v1, H;
  double position(double t) const {
    const double s = t / H, r = 1 - s;
    return x0 * (1 + 2 * s) * r * r + H * v0 * s * r * r + x1 * s * s * (3 - 2 * s) - H * v1 * s * s * r;
  }
  double velocity(double t) const {
    const double s = t / H, r = 1 - s;
    return (x1 - x0) * 6 * s * r / H + v0 * r * (1 - 3 * s) + v1 * s * (3 * s - 2);
  }
};

}  // namespace

protocol::Configured OscillatorBed::configure(const protocol::Configuration&) {
  return {
      {},
      R"({"backend": "cpu", "device": "double", "precision": "double", "variant": "oscillator", "spheres": 1})"};
}

const protocol::LoadSet& OscillatorBed::advance(const protocol::MotionSet& motion) {
  const protocol::BodyMotion& body = motion.bodies.at(0);
  const double H = motion.window.length(), k = p_.contact_stiffness, d = p_.contact_damping;
  const Path path{body.begin_pose.p_WB.x, body.begin_twist.v_WB.x, body.end_pose.p_WB.x,
                  body.end_twist.v_WB.x, H};
  const bool wall = p_.mass == 0;
  const auto force = [&](double t, const State& s) {
    return k * (s[0] - path.position(t)) + d * (s[1] - path.velocity(t));
  };
  const auto rate = [&](double t, const State& s) {
    const double F = force(t, s);
    const double a = wall ? 0 : (-F - p_.stiffness * s[0] - p_.damping * s[1]) / p_.mass;
    return State{wall ? 0 : s[1], a, F, (t - H / 2) * F, F * path.velocity(t)};
  };
  const double fastest = wall ? 0 : std::sqrt((k + p_.stiffness) / p_.mass) + (d + p_.damping) / p_.mass;
  const int steps = std::max(20, static_cast<int>(std::ceil(20 * fastest * H)));
  const double h = H / steps;
  State s{y, w, 0, 0, 0};
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const State k1 = rate(t, s), k2 = rate(t + h / 2, plus(s, h / 2, k1)),
                k3 = rate(t + h / 2, plus(s, h / 2, k2)), k4 = rate(t + h, plus(s, h, k3));
    for (std::size_t j = 0; j < s.size(); ++j) s[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
  }
  const double momentum_before = p_.mass * w;
  y = s[0];
  w = s[1];
  now_ = motion.window.end;
  ++advances_;

  protocol::BodyLoad load;
  load.mean.force.x = s[2] / H;
  load.first_moment.force.x = s[3] / H;
  load.end.force.x = force(H, s);
  load.work = s[4];
  // Momentum that the contact takes from the body and that is not in the bed goes to the ground.
  protocol::BodyLoad of_ground;
  of_ground.body = ground.value;
  of_ground.mean.force.x = -load.mean.force.x - (p_.mass * w - momentum_before) / H;
  loads_.window = motion.window;
  loads_.bodies = {load, of_ground};
  loads_.account.micro_steps = static_cast<std::uint64_t>(steps);
  loads_.account.micro_step = h;
  loads_.account.momentum_begin.x = momentum_before;
  loads_.account.momentum_end.x = p_.mass * w;
  loads_.account.kinetic_energy = p_.mass * w * w / 2;
  return loads_;
}

const protocol::TangentSet& OscillatorBed::linearise() {
  tangents_.time = now_;
  if (p_.responds) {
    tangents_.responses.clear();
    const double relaxation = p_.mass / p_.contact_damping;
    constexpr int points = 240;
    for (int k = 1; k <= points; ++k) {
      protocol::BodyResponse& point = tangents_.responses.emplace_back();
      point.time = 12 * relaxation * k / points;
      point.impulse[0] = -p_.mass * std::expm1(-point.time / relaxation);
    }
    return tangents_;
  }
  tangents_.bodies.resize(1);
  tangents_.bodies[0].stiffness[0] = p_.contact_stiffness;
  tangents_.bodies[0].damping[0] = p_.contact_damping;
  return tangents_;
}

const protocol::ParticlesFrame& OscillatorBed::observe() {
  frame_.time = now_;
  frame_.id = {0};
  frame_.position = {y, 0, 0};
  frame_.velocity = {static_cast<float>(w), 0, 0};
  frame_.spin = {0, 0, 0};
  frame_.radius = {0.1f};
  return frame_;
}

void OscillatorBed::restore() {
  y = saved_.y;
  w = saved_.w;
  now_ = saved_.now;
}

protocol::Report OscillatorBed::report() {
  char text[80];
  std::snprintf(text, sizeof text, R"({"dem_state_hash": "%016llx%016llx"})",
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(y)),
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(w)));
  return {text};
}

}  // namespace tandem::test

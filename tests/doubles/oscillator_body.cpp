#include "tests/doubles/oscillator_body.hpp"

#include <bit>
#include <cmath>
#include <cstdio>

#include "tests/support/straight_path.hpp"

namespace tandem::test {

protocol::Configured OscillatorBody::configure(const protocol::Configuration&) {
  path({}, 0);
  return {motion_.bodies, R"({"constraint_violation": 0})"};
}

// The path over a window with this constant acceleration.
const protocol::MotionSet& OscillatorBody::path(const Window& window, double a) {
  motion_.window = window;
  motion_.bodies = {straight_path(x, v, a, window.length())};
  return motion_;
}

const protocol::MotionSet& OscillatorBody::predict(const Window& window) {
  return path(window, 0);
}

const protocol::MotionSet& OscillatorBody::extrapolate(const Window& window) {
  return path(window, acceleration(x, v, force));
}

const protocol::MotionSet& OscillatorBody::advance(const protocol::LoadSet& loads) {
  const double H = loads.window.length();
  double mean = 0, moment = 0;
  for (const protocol::BodyLoad& part : loads.bodies) {
    if (part.body != 0) continue;
    mean += part.mean.force.x;
    moment += part.first_moment.force.x;
  }
  const double slope = 12 * moment / (H * H);
  const auto load = [&](double t) { return mean + slope * (t - H / 2); };

  path(loads.window, 0);
  protocol::BodyMotion& body = motion_.bodies[0];
  body.begin_a.x = acceleration(x, v, load(0));
  const double omega = std::sqrt(p_.stiffness / p_.mass) + p_.damping / p_.mass;
  const int steps = std::max(4, static_cast<int>(std::ceil(20 * omega * H)));
  const double h = H / steps;
  double work = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const double a1 = acceleration(x, v, load(t)), v2 = v + h / 2 * a1;
    const double a2 = acceleration(x + h / 2 * v, v2, load(t + h / 2)), v3 = v + h / 2 * a2;
    const double a3 = acceleration(x + h / 2 * v2, v3, load(t + h / 2)), v4 = v + h * a3;
    const double a4 = acceleration(x + h * v3, v4, load(t + h));
    work += h / 6 * (load(t) * v + 2 * load(t + h / 2) * (v2 + v3) + load(t + h) * v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  force = load(H);
  body.end_pose.p_WB.x = x;
  body.end_twist.v_WB.x = v;
  body.end_a.x = acceleration(x, v, force);
  body.applied_impulse.force.x = mean * H;
  body.applied_work = work;
  now_ = loads.window.end;
  ++advances_;
  return motion_;
}

const protocol::BodiesFrame& OscillatorBody::observe() {
  frame_.time = now_;
  frame_.bodies = {{0, 0, {{x, 0, 0}, {}}, {{v, 0, 0}, {}}}};
  frame_.joints = {{0, 0, x, v, {}}};
  frame_.energy = (p_.mass * v * v + p_.stiffness * x * x) / 2;
  return frame_;
}

void OscillatorBody::restore() {
  x = saved_.x;
  v = saved_.v;
  force = saved_.force;
  now_ = saved_.now;
}

protocol::Report OscillatorBody::report() {
  char text[120];
  std::snprintf(text, sizeof text, R"({"mbd_state_hash": "%016llx%016llx", "final_x": %.17g})",
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(x)),
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(v)), x);
  return {text};
}

}  // namespace tandem::test

// @NAME@: a solver of a liquid for tandem, in C++. The liquid is one mass, which the walls of one body hold
// by a spring and a dashpot in place of pressure: it weighs, it is accelerated with its vessel, and it does
// not flow. docs/participant.md of tandem says what each function must do.
#include <algorithm>
#include <cmath>
#include <tandem/participant.hpp>

namespace {

namespace kit = tandem::participant;

struct Vec {
  double x = 0, y = 0, z = 0;
};
Vec vec(const double* v) {
  return {v[0], v[1], v[2]};
}
Vec operator+(Vec a, Vec b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(Vec a, Vec b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator*(double s, Vec a) {
  return {s * a.x, s * a.y, s * a.z};
}
double dot(Vec a, Vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
void add(double* to, double factor, Vec v) {
  to[0] += factor * v.x, to[1] += factor * v.y, to[2] += factor * v.z;
}
// From the frame of a body into the world, or for `sign` = -1 back.
Vec rotate(const double* q, double sign, Vec v) {
  const Vec u = sign * vec(q + 1), a = cross(u, v);
  return v + 2 * (q[0] * a + cross(u, a));
}

class Lump : public kit::LiquidSolver {
 public:
  std::uint64_t capabilities() const override {
    return TANDEM_CAN_ROLLBACK | TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN | TANDEM_CAN_OBSERVE_LIQUID;
  }
  std::vector<std::string> features() const override {
    return {"wall:*", "liquid.free_slip", "liquid.no_slip"};
  }

  void configure(const tandem_configuration& scene, kit::Facts& facts) override {
    scene_ = &scene;
    const tandem_liquid& liquid = scene.liquids[0];
    gravity_ = vec(scene.gravity);
    g_ = std::sqrt(dot(gravity_, gravity_));
    fill(liquid);
    now_.x = start_, now_.v = vec(liquid.velocity);
    held_ = scene.wall_count > 0;
    if (!held_) return;
    vessel_ = scene.walls[0].body;
    for (const tandem_wall& wall : kit::walls(scene))
      if (wall.body != vessel_)
        throw kit::Error(kit::Code::scene, "two bodies have walls, and this liquid is held by one",
                         "sph.walls", "give all walls the same \"body\", or leave it out for the ground");
    if (vessel_ != TANDEM_GROUND) vessel_start_ = {scene.bodies[vessel_].pose, scene.bodies[vessel_].twist};
    // A column of depth and area d and d^2 has the stiffness rho c^2 d, and with the mass rho d^3 the
    // frequency c / d.
    const double d = std::cbrt(mass_ / liquid.density);
    const double c = liquid.sound_speed > 0 ? liquid.sound_speed : 10 * std::sqrt(g_ * d);
    if (!(c > 0))
      throw kit::Error(kit::Code::scene, "no speed of sound follows from the gravity, which is zero",
                       "sph.liquids", "give \"sound_speed\"");
    omega_ = c / d;
    // Held so that a hydrostatic liquid is at rest at the start.
    const Vec at_rest = start_ - (liquid.hydrostatic ? 1 / (omega_ * omega_) : 0) * gravity_;
    anchor_ = rotate(vessel_start_.pose.quaternion, -1, at_rest - vec(vessel_start_.pose.position));
    for (std::size_t i = 0; i < pressure_.size(); ++i) {
      if (g_ > 0 && liquid.hydrostatic)
        pressure_[i] =
            static_cast<float>(liquid.density * (dot(gravity_, vec(&particles_[3 * i])) + g_ * top_));
      density_[i] += pressure_[i] / static_cast<float>(c * c);
    }
    facts.text("method", "one mass on a spring, velocity Verlet");
    facts.number("sound_speed_m_per_s", c);
  }

  // Verlet: half a kick, drift, force, half a kick. The load is the trapezoidal sum of the same forces, so
  // that the impulses of liquid and vessel are opposite but for round-off.
  void advance(const tandem_motion_set& motion, tandem_load_set& loads) override {
    tandem_particle_account& account = loads.account;
    const double length = kit::length(motion.window);
    double longest = scene_->micro_step > 0 ? scene_->micro_step : length;
    if (held_) longest = std::min(longest, 0.05 / omega_);
    const double steps = std::ceil(length / longest * (1 - 1e-12)), dt = length / steps;
    add(account.momentum_begin, mass_, now_.v);
    add(account.gravity_impulse, mass_ * length, gravity_);
    for (int step = 0; step <= static_cast<int>(steps); ++step) {
      const double weight = (step == 0 || step == steps ? 0.5 : 1) * dt;  // of the trapezoidal sum
      Vec force;                                                          // on the liquid
      for (tandem_body_load& load : kit::loads(loads)) {
        if (!held_ || load.body != vessel_) continue;
        kit::State at = vessel_start_;  // the ground
        for (const tandem_body_motion& path : kit::bodies(motion))
          if (path.body == vessel_) at = kit::pose_at(path, motion.window, step * dt);
        force = force_of(at);
        const Vec arm = now_.x - vec(at.pose.position), torque = cross(arm, force);
        load.end = {};
        add(load.end.force, -1, force), add(load.end.torque, -1, torque);
        const double share = -weight / length, moment = share * (step * dt - 0.5 * length);
        add(load.mean.force, share, force), add(load.mean.torque, share, torque);
        add(load.first_moment.force, moment, force), add(load.first_moment.torque, moment, torque);
        load.work -=
            weight * (dot(force, vec(at.twist.velocity)) + dot(torque, vec(at.twist.angular_velocity)));
      }
      now_.v = now_.v + weight * ((1 / mass_) * force + gravity_);
      if (step < static_cast<int>(steps)) now_.x = now_.x + dt * now_.v;
    }
    expect_inside_domain();
    add(account.momentum_end, mass_, now_.v);
    account.kinetic_energy = 0.5 * mass_ * dot(now_.v, now_.v);
    account.micro_steps = static_cast<std::uint64_t>(steps), account.micro_step = dt;
  }

  void observe(tandem_particles_frame& frame) override {
    const std::size_t n = pressure_.size();
    position_.clear(), velocity_.clear();
    const Vec moved = now_.x - start_;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec p = vec(&particles_[3 * i]) + moved;
      position_.insert(position_.end(), {p.x, p.y, p.z});
      for (const double v : {now_.v.x, now_.v.y, now_.v.z}) velocity_.push_back(static_cast<float>(v));
    }
    frame.count = n, frame.id = id_.data(), frame.position = position_.data();
    frame.velocity = velocity_.data(), frame.pressure = pressure_.data(), frame.density = density_.data();
  }

  void save() override { saved_ = now_; }
  void restore() override { now_ = saved_; }

 private:
  struct Memory {  // what save() keeps
    Vec x, v;      // of the centre of mass
  };

  // Particles in the boxes, one in each cube of a spacing, for the pictures; mass and centre of the liquid.
  void fill(const tandem_liquid& liquid) {
    const double s = scene_->spacing;
    lower_ = vec(liquid.boxes), upper_ = vec(liquid.boxes + 3);
    for (std::size_t b = 0; b < liquid.box_count; ++b) {
      const Vec min = vec(liquid.boxes + 6 * b), max = vec(liquid.boxes + 6 * b + 3);
      const Vec edges = max - min;
      lower_ = {std::min(lower_.x, min.x), std::min(lower_.y, min.y), std::min(lower_.z, min.z)};
      upper_ = {std::max(upper_.x, max.x), std::max(upper_.y, max.y), std::max(upper_.z, max.z)};
      const double mass = liquid.density * edges.x * edges.y * edges.z;
      start_ = start_ + mass * (min + 0.5 * edges), mass_ += mass;
      for (double z = 0.5; z * s < edges.z; ++z)
        for (double y = 0.5; y * s < edges.y; ++y)
          for (double x = 0.5; x * s < edges.x; ++x)
            for (const double p : {min.x + x * s, min.y + y * s, min.z + z * s}) particles_.push_back(p);
      if (g_ > 0)  // the highest corner
        for (int corner = 0; corner < 8; ++corner) {
          const Vec p{corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z};
          const double height = -dot(gravity_, p) / g_;
          top_ = b + corner == 0 ? height : std::max(top_, height);
        }
    }
    if (mass_ == 0)
      throw kit::Error(kit::Code::scene, "nothing is filled", "sph.liquids", "give a box in \"fill\"");
    start_ = (1 / mass_) * start_;
    // Of the centres of the particles.
    lower_ = lower_ + Vec{0.5 * s, 0.5 * s, 0.5 * s}, upper_ = upper_ - Vec{0.5 * s, 0.5 * s, 0.5 * s};
    const std::size_t n = particles_.size() / 3;
    for (std::uint32_t i = 0; i < n; ++i) id_.push_back(i);
    pressure_.assign(n, 0), density_.assign(n, static_cast<float>(liquid.density));
  }

  // Of the vessel on the liquid. What this model cannot show ends the run.
  Vec force_of(const kit::State& at) const {
    const double *q = at.pose.quaternion, *q0 = vessel_start_.pose.quaternion;
    if (std::abs(q[0] * q0[0] + q[1] * q0[1] + q[2] * q0[2] + q[3] * q0[3]) < std::cos(0.05))
      throw kit::Error(kit::Code::numerics, "turns by more than 0.1 rad, in which this liquid cannot flow",
                       "the body with the walls", "take another solver, or keep it from turning");
    const Vec arm = rotate(q, 1, anchor_), anchor = vec(at.pose.position) + arm;
    const Vec anchor_v = vec(at.twist.velocity) + cross(vec(at.twist.angular_velocity), arm);
    const Vec force = -mass_ * (omega_ * omega_ * (now_.x - anchor) + omega_ * (now_.v - anchor_v));
    if (dot(force, gravity_) > 1e-6 * mass_ * g_ * g_)
      throw kit::Error(kit::Code::numerics, "would leave its vessel, which this solver cannot compute",
                       "the liquid",
                       "take another solver, or keep the vessel from falling faster than the liquid");
    return force;
  }

  void expect_inside_domain() const {
    const Vec moved = now_.x - start_, low = lower_ + moved - vec(scene_->domain_min),
              high = vec(scene_->domain_max) - upper_ - moved;
    if (std::min({low.x, low.y, low.z, high.x, high.y, high.z}) < 0)
      throw kit::Error(kit::Code::numerics, "leaves the domain", "sph.domain", "make the domain larger");
  }

  const tandem_configuration* scene_ = nullptr;
  bool held_ = false;                     // by walls
  std::uint32_t vessel_ = TANDEM_GROUND;  // the body with the walls
  kit::State vessel_start_{{{0, 0, 0}, {1, 0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}};
  Vec gravity_;
  double g_ = 0, top_ = 0;       // [m/s2]; height of the surface against gravity [m]
  double mass_ = 0, omega_ = 0;  // [kg]; of the spring [1/s]
  Vec start_, anchor_;           // centre at the start; where the spring is fixed, in the frame of the vessel
  Vec lower_, upper_;            // of the particles at the start
  Memory now_, saved_;
  std::vector<double> particles_, position_;  // at the start; now
  std::vector<float> velocity_, pressure_, density_;
  std::vector<std::uint32_t> id_;
};

}  // namespace

int main(int argc, char** argv) {
  Lump solver;
  return kit::run(argc, argv, "@NAME@ 0.1", solver);
}

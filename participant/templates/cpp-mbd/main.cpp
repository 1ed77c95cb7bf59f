// @NAME@: a multibody solver for tandem, in C++. Free rigid bodies under gravity and the load of the
// particles.
//
// Over a window of length H with the mean load F, T: velocity and angular momentum change by exactly F H + m
// g H and T H, and the position by H times the mean of the velocities at both ends, which is exact for a
// constant force. The orientation follows from the implicit midpoint rule: the body turns by H w, where w is
// the angular velocity that belongs to the mean angular momentum at the orientation half-way.
// docs/participant.md of tandem says what each function must do.
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
void put(Vec v, double* to) {
  to[0] = v.x, to[1] = v.y, to[2] = v.z;
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

struct Quat {
  double w = 1;
  Vec u;
  Vec rotate(Vec v) const {  // from the frame of the body into the world
    const Vec a = cross(u, v);
    return v + 2 * (w * a + cross(u, a));
  }
  Vec rotate_back(Vec v) const { return Quat{w, -1 * u}.rotate(v); }
  // Turned further by a rotation vector in world axes; of unit length again.
  Quat turned(Vec phi) const {
    const double angle = std::sqrt(dot(phi, phi));
    const double c = std::cos(0.5 * angle);
    const Vec s = (angle > 0 ? std::sin(0.5 * angle) / angle : 0.5) * phi;
    const Quat made{c * w - dot(s, u), c * u + w * s + cross(s, u)};
    const double norm = std::sqrt(made.w * made.w + dot(made.u, made.u));
    return {made.w / norm, (1 / norm) * made.u};
  }
};

struct Matrix {
  Vec rows[3];
  Vec operator*(Vec v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
};

struct Body {
  Vec x;
  Quat q;
  Vec v, L;  // velocity, angular momentum about the centre of mass, world axes
};

class FreeBodies : public kit::MotionSolver {
 public:
  std::uint64_t capabilities() const override { return TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK; }
  std::vector<std::string> features() const override { return {}; }  // a joint or a force is refused

  void configure(const tandem_configuration& scene, tandem_motion_set& initial, kit::Facts& facts) override {
    gravity_ = vec(scene.gravity);
    for (const tandem_body& body : kit::bodies(scene)) {
      const Matrix I{{vec(body.inertia), vec(body.inertia + 3), vec(body.inertia + 6)}};
      const Vec c = cross(I.rows[1], I.rows[2]);  // cofactors of a symmetric matrix
      const double share = 1 / dot(I.rows[0], c);
      inverse_.push_back(
          {{share * c, share * cross(I.rows[2], I.rows[0]), share * cross(I.rows[0], I.rows[1])}});
      mass_.push_back(body.mass);
      names_.push_back(body.name);
      const double* q = body.pose.quaternion;
      const Quat turned{q[0], vec(q + 1)};
      const Vec L = turned.rotate(I * turned.rotate_back(vec(body.twist.angular_velocity)));
      now_.push_back({vec(body.pose.position), turned, vec(body.twist.velocity), L});
    }
    for (tandem_body_motion& m : kit::bodies(initial)) {  // pose and twist are those of the scene already
      const Vec turning = angular_acceleration(m.body, now_[m.body], {});
      put(gravity_, m.begin_acceleration), put(gravity_, m.end_acceleration);
      put(turning, m.begin_angular_acceleration), put(turning, m.end_angular_acceleration);
    }
    facts.text("method", "free bodies, implicit midpoint rule");
  }

  void advance(const tandem_load_set& loads, tandem_motion_set& motion) override {
    const double H = kit::length(motion.window);
    for (std::size_t b = 0; b < now_.size(); ++b) {
      tandem_wrench load{};
      for (const tandem_body_load& given : kit::loads(loads))
        if (given.body == b) load = given.mean;
      const Vec F = vec(load.force), T = vec(load.torque);
      const Body old = now_[b];
      const Vec a = (1 / mass_[b]) * F + gravity_;
      const Vec moved = H * (old.v + 0.5 * H * a);
      const Vec w = mean_angular_velocity(b, old, old.L + 0.5 * H * T, H);
      now_[b] = {old.x + moved, old.q.turned(H * w), old.v + H * a, old.L + H * T};
      for (tandem_body_motion& m : kit::bodies(motion)) {
        if (m.body != b) continue;
        write(b, old, m.begin_pose, m.begin_twist);
        write(b, now_[b], m.end_pose, m.end_twist);
        put(a, m.begin_acceleration), put(a, m.end_acceleration);
        put(angular_acceleration(b, old, T), m.begin_angular_acceleration);
        put(angular_acceleration(b, now_[b], T), m.end_angular_acceleration);
        put(H * F, m.applied_impulse.force), put(H * T, m.applied_impulse.torque);
        m.applied_work = dot(F, moved) + H * dot(T, w);
      }
    }
  }

  void predict(const tandem_window& window, tandem_motion_set& motion) override {
    const double H = kit::length(window);
    for (tandem_body_motion& m : kit::bodies(motion)) {
      const Body& body = now_[m.body];
      Body end = body;
      write(m.body, body, m.begin_pose, m.begin_twist);
      end.x = body.x + H * body.v;
      end.q = body.q.turned(H * vec(m.begin_twist.angular_velocity));
      write(m.body, end, m.end_pose, m.end_twist);
      m.end_twist = m.begin_twist;
    }
  }

  void observe(tandem_bodies_frame& frame) override {
    for (tandem_body_state& state : kit::bodies(frame)) {
      const Body& body = now_[state.body];
      write(state.body, body, state.pose, state.twist);
      frame.energy += mass_[state.body] * (0.5 * dot(body.v, body.v) - dot(gravity_, body.x)) +
                      0.5 * dot(vec(state.twist.angular_velocity), body.L);
    }
  }

  void save() override { saved_ = now_; }
  void restore() override { now_ = saved_; }

 private:
  Vec angular_velocity(std::size_t b, const Quat& q, Vec L) const {
    return q.rotate(inverse_[b] * q.rotate_back(L));
  }
  // Under the torque T: I w' = T - w x L.
  Vec angular_acceleration(std::size_t b, const Body& body, Vec T) const {
    return angular_velocity(b, body.q, T - cross(angular_velocity(b, body.q, body.L), body.L));
  }
  Vec mean_angular_velocity(std::size_t b, const Body& body, Vec L, double H) const {
    Vec w = angular_velocity(b, body.q, L);
    for (int i = 0; i < 100; ++i) {  // each pass reduces the error by a factor of H |w|
      const Vec next = angular_velocity(b, body.q.turned(0.5 * H * w), L);
      const Vec change = H * (next - w);
      w = next;
      if (std::sqrt(dot(change, change)) <= 1e-14) return w;
    }
    throw kit::Error(kit::Code::numerics, "the rotation of a body over a window has not been found",
                     names_[b], "take shorter windows");
  }
  void write(std::size_t b, const Body& body, tandem_pose& pose, tandem_twist& twist) const {
    put(body.x, pose.position);
    pose.quaternion[0] = body.q.w, put(body.q.u, pose.quaternion + 1);
    put(body.v, twist.velocity), put(angular_velocity(b, body.q, body.L), twist.angular_velocity);
  }

  Vec gravity_;
  std::vector<double> mass_;
  std::vector<Matrix> inverse_;  // of the inertia, axes of the body
  std::vector<std::string> names_;
  std::vector<Body> now_, saved_;
};

}  // namespace

int main(int argc, char** argv) {
  FreeBodies solver;
  return kit::run(argc, argv, "@NAME@ 0.1", solver);
}

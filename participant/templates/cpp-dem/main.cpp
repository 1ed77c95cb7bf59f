// @NAME@: a particle solver for tandem, in C++. Spheres with linear springs and dashpots, without friction
// and therefore without rotation, against each other, planes and triangles. Velocity Verlet;
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

struct Sphere {
  std::uint32_t id, material;
  double radius, mass;
  Vec x, v;
};

struct Touch {        // where a sphere touches a wall, in the frame of the wall's body
  Vec point, normal;  // unit normal towards the sphere
  double overlap;
};

// The point of a triangle next to p [Ericson, Real-Time Collision Detection, 2005, section 5.1.5].
Vec closest_point(const double* triangle, Vec p) {
  const Vec a = vec(triangle), b = vec(triangle + 3), c = vec(triangle + 6);
  const Vec ab = b - a, ac = c - a;
  const double d1 = dot(ab, p - a), d2 = dot(ac, p - a), d3 = dot(ab, p - b), d4 = dot(ac, p - b);
  const double d5 = dot(ab, p - c), d6 = dot(ac, p - c);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  if (d6 >= 0 && d5 <= d6) return c;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + ((d4 - d3) / (d4 - d3 + d5 - d6)) * (c - b);
  return a + (1 / (va + vb + vc)) * (vb * ab + vc * ac);
}

class Spheres : public kit::LoadSolver {
 public:
  std::uint64_t capabilities() const override {
    return TANDEM_CAN_ROLLBACK | TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN;
  }
  std::vector<std::string> features() const override {
    return {"contact:hooke", "wall:plane", "wall:triangles"};
  }

  void configure(const tandem_configuration& scene, kit::Facts& facts) override {
    scene_ = &scene;
    if (!(scene.micro_step > 0))
      throw kit::Error(kit::Code::scene, "no step of the particles is given", "dem.micro_step",
                       "give a number: this solver chooses none itself");
    const std::size_t n = scene.material_count;
    law_.assign(n * n, {-1, 0});
    const double pi = std::acos(-1.0);
    for (const tandem_pair& pair : kit::pairs(scene)) {
      if (pair.friction != 0)
        throw kit::Error(kit::Code::scene, "a pair has friction, which this solver does not know",
                         "dem.pairs", "write \"friction\": 0");
      const double l = pair.restitution > 0 ? std::log(pair.restitution) : 0;
      const double damping = pair.restitution > 0 ? -2 * l / std::sqrt(l * l + pi * pi) : 2;
      law_[pair.a * n + pair.b] = law_[pair.b * n + pair.a] = {pair.spring_stiffness, damping};
    }
    for (std::uint32_t i = 0; i < scene.sphere_count; ++i) {
      const double r = scene.sphere_radius[i];
      const std::uint32_t material = scene.sphere_material[i];
      now_.spheres.push_back({i, material, r, 4.0 / 3 * pi * r * r * r * scene.materials[material].density,
                              vec(scene.sphere_position + 3 * i), vec(scene.sphere_velocity + 3 * i)});
    }
    facts.text("method", "velocity Verlet, pairs by sweeping along x");
  }

  // Verlet: half a kick, drift, forces, half a kick. The load of a body is the trapezoidal sum of the same
  // forces, so that the impulses of spheres and bodies are opposite but for round-off.
  void advance(const tandem_motion_set& motion, tandem_load_set& loads) override {
    tandem_particle_account& account = loads.account;
    const double length = kit::length(motion.window);
    const int steps = static_cast<int>(std::ceil(length / scene_->micro_step * (1 - 1e-12)));
    const double dt = length / steps;
    const Vec gravity = vec(scene_->gravity);
    for (const Sphere& s : now_.spheres) add(account.momentum_begin, s.mass, s.v);
    remove_lost(account.lost_momentum);
    for (const Sphere& s : now_.spheres) add(account.gravity_impulse, s.mass * length, gravity);
    for (int step = 0; step <= steps; ++step) {
      const double weight = (step == 0 || step == steps ? 0.5 : 1) * dt;  // of the trapezoidal sum
      force_.assign(now_.spheres.size(), Vec{});
      pair_forces();
      for (tandem_body_load& load : kit::loads(loads)) {
        kit::State body{{{0, 0, 0}, {1, 0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}};  // the ground
        for (const tandem_body_motion& path : kit::bodies(motion))
          if (path.body == load.body) body = kit::pose_at(path, motion.window, step * dt);
        load.end = wall_forces(load.body, body);
        const Vec F = vec(load.end.force), T = vec(load.end.torque);
        const double share = weight / length, arm = share * (step * dt - 0.5 * length);
        add(load.mean.force, share, F), add(load.mean.torque, share, T);
        add(load.first_moment.force, arm, F), add(load.first_moment.torque, arm, T);
        load.work += weight * (dot(F, vec(body.twist.velocity)) + dot(T, vec(body.twist.angular_velocity)));
      }
      for (std::size_t i = 0; i < force_.size(); ++i) {
        Sphere& s = now_.spheres[i];
        s.v = s.v + weight * ((1 / s.mass) * force_[i] + gravity);
        if (step < steps) s.x = s.x + dt * s.v;
      }
    }
    for (const Sphere& s : now_.spheres) {
      add(account.momentum_end, s.mass, s.v);
      account.kinetic_energy += 0.5 * s.mass * dot(s.v, s.v);
    }
    account.micro_steps = static_cast<std::uint64_t>(steps), account.micro_step = dt;
    account.largest_overlap_ratio = now_.largest_overlap;
    account.lost_particles = now_.lost, account.contacts = contacts_;
  }

  void observe(tandem_particles_frame& frame) override {
    const std::size_t n = now_.spheres.size();
    id_.clear(), position_.clear(), velocity_.clear(), radius_.clear();
    spin_.assign(3 * n, 0);
    for (const Sphere& s : now_.spheres) {
      id_.push_back(s.id), radius_.push_back(static_cast<float>(s.radius));
      position_.insert(position_.end(), {s.x.x, s.x.y, s.x.z});
      for (const double v : {s.v.x, s.v.y, s.v.z}) velocity_.push_back(static_cast<float>(v));
    }
    frame.count = n, frame.id = id_.data(), frame.position = position_.data();
    frame.velocity = velocity_.data(), frame.spin = spin_.data(), frame.radius = radius_.data();
  }

  void save() override { saved_ = now_; }
  void restore() override { now_ = saved_; }

 private:
  struct Law {
    double stiffness, damping;  // k; c / sqrt(m* k); without a pair of materials k < 0
  };
  struct Memory {  // what save() keeps
    std::vector<Sphere> spheres;
    std::uint64_t lost = 0;
    double largest_overlap = 0;
  };

  // Normal force at an overlap > 0; `speed` is that of separation.
  double normal_force(std::uint32_t a, std::uint32_t b, double mass, double radius, double overlap,
                      double speed) {
    const Law& law = law_[a * scene_->material_count + b];
    if (law.stiffness < 0)
      throw kit::Error(kit::Code::scene, "two materials without a pair are in contact", "dem.pairs",
                       "add the pair");
    now_.largest_overlap = std::max(now_.largest_overlap, overlap / radius);
    return law.stiffness * overlap - law.damping * std::sqrt(mass * law.stiffness) * speed;
  }

  // Sorted by x, a sphere has its partners close behind it.
  void pair_forces() {
    const std::vector<Sphere>& s = now_.spheres;
    double largest = 0;
    contacts_ = 0;
    order_.resize(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) order_[i] = i, largest = std::max(largest, s[i].radius);
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return s[a].x.x < s[b].x.x || (s[a].x.x == s[b].x.x && a < b);
    });
    for (std::size_t p = 0; p < order_.size(); ++p)
      for (std::size_t q = p + 1; q < order_.size(); ++q) {
        const Sphere &i = s[order_[p]], &j = s[order_[q]];
        if (j.x.x - i.x.x > i.radius + largest) break;
        const Vec d = i.x - j.x;
        const double distance = std::sqrt(dot(d, d)), overlap = i.radius + j.radius - distance;
        if (overlap <= 0 || distance == 0) continue;
        const Vec normal = (1 / distance) * d;
        const Vec f = normal_force(i.material, j.material, i.mass * j.mass / (i.mass + j.mass),
                                   std::min(i.radius, j.radius), overlap, dot(i.v - j.v, normal)) *
                      normal;
        force_[order_[p]] = force_[order_[p]] + f;
        force_[order_[q]] = force_[order_[q]] - f;
        ++contacts_;
      }
  }

  // Where a sphere at p touches a wall. The deepest places come first; further points in the tangent plane of
  // one of them belong to the same face.
  void find_touches(const tandem_wall& wall, Vec p, double radius) {
    touches_.clear();
    if (wall.shape == TANDEM_WALL_PLANE) {
      const Vec normal = vec(wall.normal);
      const double height = dot(p - vec(wall.point), normal);
      if (height < radius) touches_.push_back({p - height * normal, normal, radius - height});
      return;
    }
    for (;;) {
      Touch deepest{{}, {}, 0};
      for (std::size_t t = 0; t < wall.triangle_count; ++t) {
        const Vec point = closest_point(wall.triangles + 9 * t, p), d = p - point;
        const double distance = std::sqrt(dot(d, d));
        if (radius - distance <= deepest.overlap || distance == 0) continue;
        const bool same_face = std::any_of(touches_.begin(), touches_.end(), [&](const Touch& known) {
          return std::abs(dot(point - known.point, known.normal)) < 1e-6 * radius;
        });
        if (!same_face) deepest = {point, (1 / distance) * d, radius - distance};
      }
      if (deepest.overlap == 0) return;
      touches_.push_back(deepest);
    }
  }

  // Load of the spheres on one body; adds the opposite to the forces of the spheres.
  tandem_wrench wall_forces(std::uint32_t body, const kit::State& at) {
    tandem_wrench load{};
    const double* q = at.pose.quaternion;
    for (const tandem_wall& wall : kit::walls(*scene_)) {
      if (wall.body != body) continue;
      for (std::size_t i = 0; i < now_.spheres.size(); ++i) {
        const Sphere& s = now_.spheres[i];
        find_touches(wall, rotate(q, -1, s.x - vec(at.pose.position)), s.radius);
        for (const Touch& touch : touches_) {
          const Vec arm = rotate(q, 1, touch.point), normal = rotate(q, 1, touch.normal);
          const Vec u = vec(at.twist.velocity) + cross(vec(at.twist.angular_velocity), arm);
          const double f =
              normal_force(s.material, wall.material, s.mass, s.radius, touch.overlap, dot(s.v - u, normal));
          force_[i] = force_[i] + f * normal;
          add(load.force, -f, normal), add(load.torque, -f, cross(arm, normal));
        }
      }
    }
    return load;
  }

  void remove_lost(double* momentum) {
    const Vec lower = vec(scene_->domain_min), upper = vec(scene_->domain_max);
    std::vector<Sphere> kept;
    for (const Sphere& s : now_.spheres) {
      const bool inside = s.x.x >= lower.x && s.x.y >= lower.y && s.x.z >= lower.z && s.x.x <= upper.x &&
                          s.x.y <= upper.y && s.x.z <= upper.z;
      if (inside)
        kept.push_back(s);
      else
        add(momentum, s.mass, s.v);
    }
    now_.lost += now_.spheres.size() - kept.size();
    now_.spheres = kept;
  }

  const tandem_configuration* scene_ = nullptr;
  std::vector<Law> law_;  // of two materials (materials x materials)
  Memory now_, saved_;
  std::uint64_t contacts_ = 0;
  std::vector<Vec> force_;
  std::vector<std::size_t> order_;
  std::vector<Touch> touches_;
  std::vector<std::uint32_t> id_;
  std::vector<double> position_;
  std::vector<float> velocity_, spin_, radius_;
};

}  // namespace

int main(int argc, char** argv) {
  Spheres solver;
  return kit::run(argc, argv, "@NAME@ 0.1", solver);
}

// Two solvers in closed form, one on each side of the interface, and a session between them over in-process
// channels: a point mass that moves along x, and a spring-damper to a wall at x = 0 on the particles' side.
#pragma once

#include <memory>
#include <thread>

#include "common/log.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "tests/support/straight_path.hpp"

namespace tandem::launch::test {

// Moves exactly under a constant force.
class PointMass : public protocol::MotionSolver {
 public:
  explicit PointMass(double mass_kg) : mass(mass_kg) {}
  double mass;          // [kg]
  double x = 0, v = 0;  // [m] [m/s]

  protocol::Configured configure(const protocol::Configuration&) override {
    path(Window{}, 0);
    return {motion_.bodies, R"({"constraint_violation": 0})"};
  }
  const protocol::MotionSet& predict(const Window& window) override {
    path(window, 0);
    return motion_;
  }
  const protocol::MotionSet& advance(const protocol::LoadSet& loads) override {
    double force = 0;
    for (const protocol::BodyLoad& load : loads.bodies)
      if (load.body == 0) force += load.mean.force.x;
    path(loads.window, force);
    protocol::BodyMotion& body = motion_.bodies[0];
    body.applied_impulse.force.x = force * loads.window.length();
    body.applied_work = force * (body.end_pose.p_WB.x - body.begin_pose.p_WB.x);
    x = body.end_pose.p_WB.x;
    v = body.end_twist.v_WB.x;
    now_ = loads.window.end;
    return motion_;
  }
  const protocol::BodiesFrame& observe() override {
    frame_.time = now_;
    frame_.bodies = {{0, 0, {{x, 0, 0}, {}}, {{v, 0, 0}, {}}}};
    frame_.energy = mass * v * v / 2;
    return frame_;
  }
  void save() override {}
  void restore() override {}
  protocol::Report report() override { return {R"({"mbd_state_hash": "1"})"}; }

 private:
  void path(const Window& window, double force) {
    motion_.window = window;
    motion_.bodies = {tandem::test::straight_path(x, v, force / mass, window.length())};
  }

  protocol::MotionSet motion_;
  protocol::BodiesFrame frame_;
  Nanoseconds now_;
};

// F = -k x - d v on the prescribed path, which it follows exactly: constant acceleration between the ends.
class WallContact : public protocol::LoadSolver {
 public:
  // The load reported as the mean: commercial couplings use the force at the window's end instead.
  enum class Returns { window_mean, end_force };

  double k = 1, d = 0;  // [N/m] [N s/m]
  Returns returns = Returns::window_mean;

  protocol::Configured configure(const protocol::Configuration&) override {
    return {{}, R"({"backend": "cpu", "spheres": 1})"};
  }
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override {
    const protocol::BodyMotion& body = motion.bodies.at(0);
    const double H = motion.window.length();
    const double x0 = body.begin_pose.p_WB.x, x1 = body.end_pose.p_WB.x;
    const double v0 = body.begin_twist.v_WB.x, v1 = body.end_twist.v_WB.x;
    const double mean_x = (x0 + x1) / 2 + H * (v0 - v1) / 12;

    protocol::BodyLoad load;
    load.end.force.x = -k * x1 - d * v1;
    load.mean.force.x = returns == Returns::window_mean ? -k * mean_x - d * (x1 - x0) / H : load.end.force.x;
    load.work = -k * (x1 * x1 - x0 * x0) / 2 - d * H * (v0 * v0 + v0 * v1 + v1 * v1) / 3;
    loads_.window = motion.window;
    loads_.bodies = {load};
    loads_.account.micro_steps = 1;
    loads_.account.micro_step = H;
    now_ = motion.window.end;
    // A massless contact: the load on the ground is opposite to that on the body.
    protocol::BodyLoad ground_load;
    ground_load.body = ground.value;
    ground_load.mean.force.x = -load.mean.force.x;
    loads_.bodies.push_back(ground_load);
    return loads_;
  }
  const protocol::ParticlesFrame& observe() override {
    frame_.time = now_;
    return frame_;
  }
  void save() override {}
  void restore() override {}
  protocol::Report report() override { return {R"({"dem_state_hash": "2"})"}; }

 private:
  protocol::LoadSet loads_;
  protocol::ParticlesFrame frame_;
  Nanoseconds now_;
};

using ExplicitStep = void (*)(const Solvers&, const scene::Coupling&, const Window&, Exchange&);

// Both solvers served in threads. The solvers may be read and set between windows, when both servers wait.
class Session {
 public:
  Session(PointMass& mass, WallContact& wall) {
    log::setup("test", "warn");
    auto [to_mbd, mbd_end] = protocol::create_inproc("mbd_server");
    auto [to_dem, dem_end] = protocol::create_inproc("dem_server");
    mbd_thread_ = std::thread(
        [&mass, end = std::shared_ptr(std::move(mbd_end))] { protocol::serve(*end, mass, "mbd_server"); });
    dem_thread_ = std::thread(
        [&wall, end = std::shared_ptr(std::move(dem_end))] { protocol::serve(*end, wall, "dem_server"); });
    const protocol::RunIdentity identity{42, 0};
    mbd_ = std::make_unique<protocol::Remote>(std::move(to_mbd), protocol::Role::mbd, identity);
    dem_ = std::make_unique<protocol::Remote>(std::move(to_dem), protocol::Role::dem, identity);
    for (protocol::Remote* remote : {mbd_.get(), dem_.get()}) {
      remote->set_patience(std::chrono::seconds(10));
      remote->register_peer(0, std::chrono::seconds(10));
      remote->configure({"{}", "fake.json", {}, {}, "cpu", 1});
    }
  }
  ~Session() {
    mbd_->finish();
    dem_->finish();
    mbd_thread_.join();
    dem_thread_.join();
  }

  // One window of length H [s] of the scheme; `exchange` lives as long as the session.
  void advance(ExplicitStep step, double H) {
    const Nanoseconds begin = window_.end;
    window_ = {windows_++, begin, begin + to_nanoseconds(H)};
    exchange.held = false;
    step({mbd_.get(), {dem_.get()}}, scene::Coupling{}, window_, exchange);
  }

  Exchange exchange;

 private:
  Window window_;
  std::uint64_t windows_ = 0;
  std::unique_ptr<protocol::Remote> mbd_, dem_;
  std::thread mbd_thread_, dem_thread_;
};

}  // namespace tandem::launch::test

// Solvers that follow the protocol and whose results are known in advance: a body that falls along a
// parabola, and particles that push it up by a force that depends on its height.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "protocol/participant/solver.hpp"

namespace tandem::protocol::test {

inline constexpr std::uint32_t toy_body = 3;

inline Window window(std::uint64_t index, std::int64_t length_ns = 1'000'000) {
  const auto begin = static_cast<std::int64_t>(index) * length_ns;
  return {index, {begin}, {begin + length_ns}};
}

class ToyMotion : public MotionSolver {
 public:
  Configured configure(const Configuration& configuration) override {
    if (configuration.scene_text == "bad scene")
      throw Error(ErrorCode::scene, "no bodies", "toy.json", "add one");
    Configured configured;
    configured.boundary.push_back(path({0, {0}, {1}}, 0));
    configured.boundary[0].end_pose = configured.boundary[0].begin_pose;
    configured.facts = R"({"toy": true})";
    return configured;
  }
  const MotionSet& predict(const Window& w) override {
    if (at_work) at_work();
    return answer(w, force_);
  }
  const MotionSet& advance(const LoadSet& loads) override {
    force_ = 0;
    for (const BodyLoad& load : loads.bodies) force_ += load.mean.force.z;
    answer(loads.window, force_);
    height_ = out_.bodies[0].end_pose.p_WB.z;
    now_ = loads.window.end;
    return out_;
  }
  const MotionSet& extrapolate(const Window& w) override { return predict(w); }
  void control(const ControlSet& set) override { inputs = set.values; }
  const TangentSet& linearise() override {
    tangents_.time = now_;
    return tangents_;
  }
  void checkpoint(const Checkpoint& file) override { written = file; }
  void resume(const Checkpoint& file) override { height_ = 0.25, now_ = file.time; }
  std::uint64_t capabilities() const override {
    return MotionSolver::capabilities() | can_extrapolate | can_control | can_checkpoint | can_linearise;
  }
  const BodiesFrame& observe() override {
    frame_.time = now_;
    frame_.bodies = {{toy_body, 0, {{0, 0, height_}, {}}, {}}};
    frame_.joints = {{0, 0, height_, 0, {}}};
    frame_.energy = height_;
    return frame_;
  }
  void save() override { saved_ = {height_, force_, now_}; }
  void restore() override { height_ = saved_.height, force_ = saved_.force, now_ = saved_.now; }
  Report report() override { return {R"({"windows": 1})"}; }

  std::function<void()> at_work;  // called in predict
  std::vector<double> inputs;     // last inputs
  Checkpoint written;             // last request
  // Defect of the next answer.
  enum class Spoil { nothing, nan, quaternion, unknown_body, wrong_window } spoil = Spoil::nothing;

 private:
  struct Saved {
    double height = 0, force = 0;
    Nanoseconds now;
  };
  BodyMotion path(const Window& w, double force) const {
    BodyMotion motion;
    motion.body = toy_body;
    motion.begin_pose.p_WB = {0, 0, height_};
    motion.end_pose.p_WB = {0, 0, height_ + w.length() * (force - 9.81)};
    motion.begin_a = motion.end_a = {0, 0, force - 9.81};
    return motion;
  }
  const MotionSet& answer(const Window& w, double force) {
    out_.window = w;
    out_.bodies.assign(1, path(w, force));
    switch (spoil) {
      case Spoil::nothing:
        break;
      case Spoil::nan:
        out_.bodies[0].end_twist.v_WB.y = std::nan("");
        break;
      case Spoil::quaternion:
        out_.bodies[0].end_pose.q_WB.w = 1.001;
        break;
      case Spoil::unknown_body:
        out_.bodies[0].body = 7;
        break;
      case Spoil::wrong_window:
        ++out_.window.index;
        break;
    }
    return out_;
  }
  double height_ = 1, force_ = 0;
  Nanoseconds now_;
  Saved saved_;
  MotionSet out_;
  TangentSet tangents_;
  BodiesFrame frame_;
};

class ToyLoad : public LoadSolver {
 public:
  Configured configure(const Configuration&) override { return {{}, R"({"backend": "toy"})"}; }
  const LoadSet& advance(const MotionSet& motion) override {
    out_.window = motion.window;
    out_.account.micro_steps = 10;
    out_.account.micro_step = motion.window.length() / 10;
    out_.bodies.clear();
    for (const BodyMotion& body : motion.bodies) {
      BodyLoad load;
      load.body = body.body;
      load.mean.force = load.end.force = {0, 0, std::sin(body.end_pose.p_WB.z) + 9.81};
      out_.bodies.push_back(load);
    }
    out_.bodies.push_back({ground.value, 0, {{0, 0, -1}, {}}, {}, {}, 0});
    now_ = motion.window.end;
    return out_;
  }
  const TangentSet& linearise() override {
    tangents_.time = now_;
    return tangents_;
  }
  void checkpoint(const Checkpoint&) override {}
  void resume(const Checkpoint& file) override { now_ = file.time; }
  std::uint64_t capabilities() const override {
    return LoadSolver::capabilities() | can_linearise | can_checkpoint | can_snapshot;
  }
  void snapshot() override { snapshot_ = observe(); }
  const ParticlesFrame& read_snapshot() override { return snapshot_; }
  const ParticlesFrame& observe() override {
    frame_.time = now_;
    frame_.id = {0, 2};
    frame_.position = {0, 0, 0, 1, 1, 1};
    frame_.velocity.assign(6, 0.5f);
    frame_.spin.assign(6, 0);
    frame_.radius = {0.1f, 0.1f};
    return frame_;
  }
  void save() override { saved_ = now_; }
  void restore() override { now_ = saved_; }
  Report report() override { return {R"({"state_hash": "0"})"}; }

 private:
  Nanoseconds now_, saved_;
  LoadSet out_;
  TangentSet tangents_;
  ParticlesFrame frame_, snapshot_;
};

}  // namespace tandem::protocol::test

// What a window costs besides the solvers' own work: messages, checks, balances and scheme. Both participants
// answer at once; the argument is the number of boundary bodies. bench_coordinator --benchmark_repetitions=9
// --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include "protocol/last_frames.hpp"
#include "tests/doubles/coupled_run.hpp"

namespace tandem {
namespace {

using protocol::WaitPolicy;
using scene::Scheme;

class IdleBodies final : public protocol::MotionSolver {
 public:
  explicit IdleBodies(std::size_t bodies) : motion_{{}, std::vector<protocol::BodyMotion>(bodies)} {
    for (std::size_t b = 0; b < bodies; ++b) motion_.bodies[b].body = static_cast<std::uint32_t>(b);
  }
  protocol::Configured configure(const protocol::Configuration&) override { return {motion_.bodies, "{}"}; }
  const protocol::MotionSet& predict(const Window& window) override { return over(window); }
  const protocol::MotionSet& advance(const protocol::LoadSet& loads) override { return over(loads.window); }
  const protocol::BodiesFrame& observe() override { return frame_; }
  void save() override {}
  void restore() override {}
  protocol::Report report() override { return {"{}"}; }

 private:
  const protocol::MotionSet& over(const Window& window) {
    motion_.window = window;
    return motion_;
  }
  protocol::MotionSet motion_;
  protocol::BodiesFrame frame_;
};

class IdleParticles final : public protocol::LoadSolver {
 public:
  // `tangents`: it knows the stiffness of its contacts, which the coordinator then requests in each window.
  IdleParticles(std::size_t bodies, bool tangents) : with_tangents_(tangents) {
    loads_.bodies.resize(bodies);
    tangents_.bodies.resize(bodies);
    for (std::size_t b = 0; b < bodies; ++b)
      loads_.bodies[b].body = tangents_.bodies[b].body = static_cast<std::uint32_t>(b);
    loads_.account.micro_steps = 1;
  }
  protocol::Configured configure(const protocol::Configuration&) override { return {{}, "{}"}; }
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override {
    loads_.window = motion.window;
    loads_.account.micro_step = motion.window.length();
    tangents_.time = motion.window.end;
    return loads_;
  }
  const protocol::TangentSet& linearise() override { return tangents_; }
  const protocol::ParticlesFrame& observe() override { return frame_; }
  void save() override {}
  void restore() override {}
  protocol::Report report() override { return {"{}"}; }
  std::uint64_t capabilities() const override {
    return LoadSolver::capabilities() | (with_tangents_ ? std::uint64_t{protocol::can_linearise} : 0);
  }

 private:
  bool with_tangents_;
  protocol::LoadSet loads_;
  protocol::TangentSet tangents_;
  protocol::ParticlesFrame frame_;
};

void window(benchmark::State& state, Scheme scheme, test::Channel channel, WaitPolicy wait, bool tangents) {
  const auto bodies = static_cast<std::size_t>(state.range(0));
  scene::Scene scene;
  scene.coupling.scheme = scheme;
  scene.coupling.window = 1e-3;
  scene.mbd.emplace();
  for (std::size_t b = 0; b < bodies; ++b)
    scene.mbd->bodies.push_back({"body" + std::to_string(b), 1, {1, 1, 1}, {}, {}});
  scene.dem.emplace();
  IdleBodies mbd(bodies);
  IdleParticles dem(bodies, tangents);
  test::CoupledRun run(mbd, dem, scene, "{}", channel, wait);
  for (auto _ : state) run.advance(1e-3);
}

// What a run pays for each message so that a failed one leaves its last windows.
void keep_message(benchmark::State& state) {
  protocol::LastFrames frames;
  const protocol::Bytes payload(static_cast<std::size_t>(state.range(0)) - sizeof(protocol::FrameHeader));
  protocol::FrameHeader header;
  header.kind = protocol::Kind::motion;
  std::uint64_t messages = 0;
  for (auto _ : state) {
    header.window = messages++ / 10;
    frames.record(protocol::Direction::to_participant, protocol::Role::mbd,
                  std::as_bytes(std::span(&header, 1)), payload);
  }
}
BENCHMARK(keep_message)->Arg(512);

void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(1)->Arg(20)->UseRealTime();
}

constexpr auto inproc = test::Channel::inproc, shm = test::Channel::shm;
BENCHMARK_CAPTURE(window, dem_first_shm_spin, Scheme::dem_first, shm, WaitPolicy::spin, false)->Apply(sizes);
BENCHMARK_CAPTURE(window, dem_first_shm_adaptive, Scheme::dem_first, shm, WaitPolicy::adaptive, false)
    ->Apply(sizes);
BENCHMARK_CAPTURE(window, dem_first_shm_block, Scheme::dem_first, shm, WaitPolicy::block, false)
    ->Apply(sizes);
BENCHMARK_CAPTURE(window, dem_first_inproc_spin, Scheme::dem_first, inproc, WaitPolicy::spin, false)
    ->Apply(sizes);
BENCHMARK_CAPTURE(window, dem_first_tangents_shm_spin, Scheme::dem_first, shm, WaitPolicy::spin, true)
    ->Apply(sizes);
BENCHMARK_CAPTURE(window, mbd_first_shm_spin, Scheme::mbd_first, shm, WaitPolicy::spin, false)->Apply(sizes);
BENCHMARK_CAPTURE(window, parallel_shm_spin, Scheme::parallel, shm, WaitPolicy::spin, false)->Apply(sizes);

}  // namespace
}  // namespace tandem

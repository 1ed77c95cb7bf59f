#include "tests/doubles/coupled_run.hpp"

#include "common/log.hpp"
#include "coordinator/start/needs.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/shm/shm_channel.hpp"

namespace tandem::test {
namespace {

using namespace std::chrono_literals;

struct Ends {
  std::unique_ptr<protocol::Channel> coordinator;
  std::thread server;
};

template <class Solver>
Ends serve_in_thread(Solver& solver, const std::string& program, Channel channel, protocol::WaitPolicy wait) {
  if (channel == Channel::inproc) {
    auto [ours, theirs] = protocol::create_inproc(program, wait);
    return {std::move(ours), std::thread([&solver, program, end = std::shared_ptr(std::move(theirs))] {
              protocol::serve(*end, solver, program);
            })};
  }
  auto endpoint = std::make_shared<protocol::Endpoint>(protocol::create_shm(program, {.wait = wait}));
  auto ours = std::move(endpoint->channel);
  return {std::move(ours), std::thread([&solver, program, endpoint, wait] {
            const auto end =
                protocol::attach_shm(endpoint->server_arguments.at(1), protocol::Clock::now() + 10s, wait);
            protocol::serve(*end, solver, program);
          })};
}

}  // namespace

CoupledRun::CoupledRun(protocol::MotionSolver& mbd, protocol::LoadSolver& dem, const scene::Scene& scene,
                       const std::string& text, Channel channel, protocol::WaitPolicy wait)
    : scene_(scene) {
  log::setup("test", "error");
  Ends of_mbd = serve_in_thread(mbd, "mbd_server", channel, wait),
       of_dem = serve_in_thread(dem, "dem_server", channel, wait);
  mbd_thread_ = std::move(of_mbd.server);
  dem_thread_ = std::move(of_dem.server);
  const protocol::RunIdentity identity{42, 0};
  mbd_ = std::make_unique<protocol::Remote>(std::move(of_mbd.coordinator), protocol::Role::mbd, identity);
  dem_ = std::make_unique<protocol::Remote>(std::move(of_dem.coordinator), dem.role(), identity);
  try {
    for (protocol::Remote* remote : {mbd_.get(), dem_.get()}) {
      remote->set_patience(30s);
      remote->register_peer(launch::needed_of(remote->role(), scene_), 10s);
      remote->configure({text, "test.json", {}, {}, "cpu", 1});
    }
  } catch (const Error&) {
    // Closing the channels ends the servers.
    mbd_.reset();
    dem_.reset();
    mbd_thread_.join();
    dem_thread_.join();
    throw;
  }
  coupler_ = std::make_unique<launch::Coupler>(scene_, launch::Solvers{mbd_.get(), {dem_.get()}});
}

CoupledRun::~CoupledRun() {
  try {
    mbd_->finish();
    dem_->finish();
  } catch (const Error&) {
    // A run that failed leaves the sessions in any state; closing the channels ends the servers.
  }
  mbd_.reset();
  dem_.reset();
  mbd_thread_.join();
  dem_thread_.join();
}

void CoupledRun::advance(double length) {
  coupler_->advance(coupler_->now() + to_nanoseconds(length));
}

void CoupledRun::observe() {
  coupler_->observe(mbd_->observe_bodies(coupler_->now()));
}

void CoupledRun::run(double end_time) {
  const Nanoseconds end = to_nanoseconds(end_time);
  while (coupler_->now() < end) coupler_->advance(end);
}

}  // namespace tandem::test

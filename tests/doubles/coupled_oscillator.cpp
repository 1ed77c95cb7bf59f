#include "tests/doubles/coupled_oscillator.hpp"

#include <Eigen/Eigenvalues>

#include "common/log.hpp"
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
Ends serve_in_thread(Solver& solver, const std::string& program, Channel channel) {
  if (channel == Channel::inproc) {
    auto [ours, theirs] = protocol::create_inproc(program);
    return {std::move(ours), std::thread([&solver, program, end = std::shared_ptr(std::move(theirs))] {
              protocol::serve(*end, solver, program);
            })};
  }
  auto endpoint = std::make_shared<protocol::Endpoint>(protocol::create_shm(program));
  auto ours = std::move(endpoint->channel);
  return {std::move(ours), std::thread([&solver, program, endpoint] {
            const auto end =
                protocol::attach_shm(endpoint->server_arguments.at(1), protocol::Clock::now() + 10s);
            protocol::serve(*end, solver, program);
          })};
}

}  // namespace

scene::Scene oscillator_scene(const OscillatorBodyParameters& body, const scene::Coupling& coupling) {
  scene::Scene scene;
  scene.name = "oscillator";
  scene.coupling = coupling;
  scene.mbd.emplace();
  scene.mbd->bodies.push_back({"mass", body.mass, {body.mass, body.mass, body.mass}, {}, {}});
  scene::Joint slide;
  slide.name = "slide";
  slide.type = scene::JointType::prismatic;
  slide.child = BodyId{0};
  slide.axis = {1, 0, 0};
  scene.mbd->joints.push_back(slide);
  scene.dem.emplace();
  return scene;
}

CoupledOscillator::CoupledOscillator(const OscillatorBodyParameters& body_parameters,
                                     const OscillatorBedParameters& bed_parameters,
                                     const scene::Coupling& coupling, Channel channel)
    : body(body_parameters),
      bed(bed_parameters),
      wall_(bed_parameters.mass == 0),
      scene_(oscillator_scene(body_parameters, coupling)) {
  log::setup("test", "error");
  Ends of_body = serve_in_thread(body, "mbd_server", channel),
       of_bed = serve_in_thread(bed, "dem_server", channel);
  body_thread_ = std::move(of_body.server);
  bed_thread_ = std::move(of_bed.server);
  const protocol::RunIdentity identity{42, 0};
  to_body_ =
      std::make_unique<protocol::Remote>(std::move(of_body.coordinator), protocol::Role::mbd, identity);
  to_bed_ = std::make_unique<protocol::Remote>(std::move(of_bed.coordinator), protocol::Role::dem, identity);
  for (protocol::Remote* remote : {to_body_.get(), to_bed_.get()}) {
    remote->set_patience(10s);
    remote->register_peer(0, 10s);
    remote->configure({"{}", "oscillator.json", {}, {}, "cpu", 1});
  }
  coupler_ = std::make_unique<launch::Coupler>(scene_, launch::Solvers{to_body_.get(), to_bed_.get()});
}

CoupledOscillator::~CoupledOscillator() {
  try {
    to_body_->finish();
    to_bed_->finish();
  } catch (const Error&) {
    // A run that failed leaves the sessions in any state; closing the channels ends the servers.
  }
  to_body_.reset();
  to_bed_.reset();
  body_thread_.join();
  bed_thread_.join();
}

void CoupledOscillator::advance(double length) {
  coupler_->advance(coupler_->now() + to_nanoseconds(length));
}

double CoupledOscillator::growth(double length) {
  Eigen::Matrix<double, 6, 6> map;
  for (int column = 0; column < 6; ++column) {
    const auto unit = [column](int i) { return column == i ? 1.0 : 0.0; };
    body.x = unit(0), body.v = unit(1), body.force = unit(2);
    if (!wall_) bed.y = unit(3), bed.w = unit(4);
    protocol::BodyLoad held;
    held.mean.force.x = held.end.force.x = unit(5);
    coupler_->exchange().load.bodies = {held};
    coupler_->exchange().load.window = {0, {0}, to_nanoseconds(length)};
    advance(length);
    const protocol::BodyLoad& load = exchange().load.bodies[0];
    map.col(column) << body.x, body.v, body.force, bed.y, bed.w,
        scene_.coupling.load == scene::LoadShape::end ? load.end.force.x : load.mean.force.x;
  }
  return map.eigenvalues().cwiseAbs().maxCoeff();
}

void CoupledOscillator::run(double end_time) {
  const Nanoseconds end = to_nanoseconds(end_time);
  while (coupler_->now() < end) coupler_->advance(end);
}

}  // namespace tandem::test

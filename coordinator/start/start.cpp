#include "coordinator/start/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "common/log.hpp"
#include "coordinator/start/start_state.hpp"
#include "protocol/start_files.hpp"
#include "sph_server/coupling/liquid_start.hpp"

namespace tandem::launch {

using namespace std::chrono_literals;
using protocol::Role;

namespace {

// Does the machine start in the equilibrium under the weight of a liquid?
bool rests_with_liquid(const scene::Scene& scene) {
  const auto moves = [](const scene::Wall& wall) { return wall.body != ground; };
  return scene.mbd && scene.mbd->start == scene::Start::equilibrium && scene.sph &&
         std::ranges::any_of(scene.sph->walls, moves);
}

// The search for the equilibrium is that of the multibody solver, which knows no liquid.
protocol::NamedText start_loads_of(const SceneFile& file) {
  std::map<std::uint32_t, Wrench> loads;
  for (const auto& [body, load] : sph::rest_loads_of(file.scene, file.meshes, sph::places_in(file.files))) {
    loads[body.value] = load;
    log::info("the liquid at rest loads '{}' with ({:.6g}, {:.6g}, {:.6g}) N", file.scene.body_name(body),
              load.force.x, load.force.y, load.force.z);
  }
  return protocol::text_of_start_loads(loads);
}

}  // namespace

StartOfSolvers configure(const Solvers& solvers, const SceneFile& file, const RunOptions& options,
                         const std::vector<Need>& besides,
                         const std::function<void(Role, const protocol::Hello&)>& take_hello,
                         const std::function<void(Role, const std::string&)>& take_facts) {
  // All are registered first: which schemes are possible depends on all of them.
  std::vector<Offer> offers;
  const auto enrol = [&](protocol::Remote* solver, Role role) {
    if (!solver) return;
    const protocol::Hello hello = solver->register_peer(0, options.patience);
    log::info("{} registered: {} on {}", solver->peer(), hello.program, hello.host);
    offers.push_back({role, hello.program, hello.capabilities});
    take_hello(role, hello);
  };
  enrol(solvers.mbd, Role::mbd);
  for (protocol::Remote* solver : solvers.loads) enrol(solver, solver->role());
  expect_capabilities(file.scene, besides, offers);

  const protocol::Configuration configuration{file.text,  file.origin,     file.meshes,
                                              file.files, options.backend, options.threads};
  StartOfSolvers start;
  const bool rests = rests_with_liquid(file.scene);
  if (solvers.mbd) {
    protocol::Configuration of_bodies = configuration;
    if (rests) of_bodies.files.push_back(start_loads_of(file));
    const protocol::Configured configured = solvers.mbd->configure(of_bodies);
    take_facts(Role::mbd, configured.facts);
    StartOfBodies(file.scene).expect(configured.boundary);
    start.boundary = configured.boundary;
  }
  for (protocol::Remote* solver : solvers.loads) {
    protocol::Configuration of_loads = configuration;
    if (rests && solver->role() == Role::sph)
      of_loads.files.push_back(protocol::text_of_start_poses(start.boundary));
    const protocol::Configured configured = solver->configure(of_loads);
    take_facts(solver->role(), configured.facts);
    start.sensors.insert(start.sensors.end(), configured.sensors.begin(), configured.sensors.end());
  }
  return start;
}

Error explained(const Error& error, const std::string& phase, Participants* participants) {
  if (dynamic_cast<const UnmetNeed*>(&error)) return error;  // its sentence is about scene and solvers
  const bool of_the_peer = error.code() == ErrorCode::peer_lost || error.code() == ErrorCode::timeout;
  if (!of_the_peer)
    return phase == at_start
               ? error
               : Error(error.code(), error.problem() + " " + phase, error.where(), error.hint());
  // The channel may detect the end earlier than the kernel reports it.
  const auto death = participants ? participants->death(300ms) : std::nullopt;
  if (!death) return error;  // the protocol's error names peer, window and the awaited message
  return Error(ErrorCode::peer_lost, fmt::format("{} {}", death->sentence, phase), {},
               death->last_words.empty() ? "first seen: " + error.problem()
                                         : "its last line in run.log: " + death->last_words);
}

}  // namespace tandem::launch

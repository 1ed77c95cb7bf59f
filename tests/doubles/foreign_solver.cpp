// A solver that tandem does not know, for tests of what the coordinator relies on: it computes as our own
// ones do, and reports no facts. Its first words say what it is and how it behaves:
//   foreign_solver mbd|dem [lack=BITS] [exit=STATUS] [say=TEXT] [die=STATUS] [tell] ARGUMENTS OF THE
//   COORDINATOR
// lack: capability bits that it has not; exit: leaves before it registers; die: leaves in its third window;
// say: writes this line to stderr first; tell: reports its solver_options as a fact.
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "dem_server/coupling/make_solver.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "protocol/participant/main.hpp"

namespace {

using namespace tandem;
using namespace tandem::protocol;
using nlohmann::ordered_json;

struct Behaviour {
  std::string role, say;
  std::uint64_t lack = 0;
  int exit = -1, die = -1;
  bool tell = false;
};
Behaviour behaviour;
int windows = 0;

void count_window() {
  if (++windows == 3 && behaviour.die >= 0) std::_Exit(behaviour.die);
}

// The configuration without solver_options, which our solvers refuse.
Configuration for_ours(const Configuration& given, ordered_json& options) {
  Configuration ours = given;
  ordered_json scene = ordered_json::parse(given.scene_text);
  ordered_json& part = scene[behaviour.role];
  options = part.value("solver_options", ordered_json::object());
  part.erase("solver_options");
  ours.scene_text = scene.dump();
  return ours;
}

std::string facts(const ordered_json& options) {
  return behaviour.tell ? ordered_json{{"foreign_options", options}}.dump() : "{}";
}

class ForeignBodies final : public MotionSolver {
 public:
  std::uint64_t capabilities() const override { return solver_->capabilities() & ~behaviour.lack; }
  Configured configure(const Configuration& configuration) override {
    Configured configured = solver_->configure(for_ours(configuration, options_));
    configured.facts = facts(options_);
    return configured;
  }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  Report report() override { return {facts(options_)}; }
  const MotionSet& predict(const Window& window) override { return solver_->predict(window); }
  const MotionSet& extrapolate(const Window& window) override { return solver_->extrapolate(window); }
  const TangentSet& linearise() override { return solver_->linearise(); }
  const BodiesFrame& observe() override { return solver_->observe(); }
  const MotionSet& advance(const LoadSet& loads) override {
    count_window();
    return solver_->advance(loads);
  }

 private:
  std::unique_ptr<MotionSolver> solver_ = mbd::make_solver();
  ordered_json options_;
};

class ForeignParticles final : public LoadSolver {
 public:
  std::uint64_t capabilities() const override { return solver_->capabilities() & ~behaviour.lack; }
  Configured configure(const Configuration& configuration) override {
    Configured configured = solver_->configure(for_ours(configuration, options_));
    configured.facts = facts(options_);
    return configured;
  }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  Report report() override { return {facts(options_)}; }
  const ParticlesFrame& observe() override { return solver_->observe(); }
  const TangentSet& linearise() override { return solver_->linearise(); }
  const LoadSet& advance(const MotionSet& motion) override {
    count_window();
    return solver_->advance(motion);
  }

 private:
  std::unique_ptr<LoadSolver> solver_ = dem::make_solver();
  ordered_json options_;
};

// Takes the words of the behaviour out of the command line.
std::vector<char*> read_behaviour(int argc, char** argv) {
  std::vector<char*> rest{argv[0]};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i], value = word.substr(word.find('=') + 1);
    if (word == "mbd" || word == "dem")
      behaviour.role = word;
    else if (word == "tell")
      behaviour.tell = true;
    else if (word.starts_with("lack="))
      behaviour.lack = std::stoull(value);
    else if (word.starts_with("exit="))
      behaviour.exit = std::stoi(value);
    else if (word.starts_with("die="))
      behaviour.die = std::stoi(value);
    else if (word.starts_with("say="))
      behaviour.say = value;
    else
      rest.push_back(argv[i]);
  }
  return rest;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<char*> rest = read_behaviour(argc, argv);
  if (!behaviour.say.empty()) std::fprintf(stderr, "%s\n", behaviour.say.c_str());
  if (behaviour.exit >= 0) return behaviour.exit;
  const int count = static_cast<int>(rest.size());
  if (behaviour.role == "mbd")
    return participant_main(
        count, rest.data(), own_program("foreign_bodies"),
        std::function<std::unique_ptr<MotionSolver>()>([] { return std::make_unique<ForeignBodies>(); }));
  return participant_main(
      count, rest.data(), own_program("foreign_particles"),
      std::function<std::unique_ptr<LoadSolver>()>([] { return std::make_unique<ForeignParticles>(); }));
}

#include "protocol/participant/main.hpp"
#include "participant/library/adapter.hpp"

namespace {

using namespace tandem;

// Name for the log and the usage text: "my_solver 1.2" is `my_solver`.
std::string first_word(const std::string& program) {
  return program.substr(0, program.find(' '));
}

int load_main(int argc, char** argv, const std::string& program, const tandem_load_solver& solver, void* self,
              protocol::Role role) {
  return protocol::participant_main(argc, argv, {first_word(program), program},
                                    std::function<std::unique_ptr<protocol::LoadSolver>()>([&] {
                                      return participant::make_load_solver(solver, self, program, role);
                                    }));
}

}  // namespace

int tandem_motion_main(int argc, char** argv, const char* program, const tandem_motion_solver* solver,
                       void* self) {
  const std::string release = program;
  return protocol::participant_main(argc, argv, {first_word(release), release},
                                    std::function<std::unique_ptr<protocol::MotionSolver>()>([&] {
                                      return participant::make_motion_solver(*solver, self, release);
                                    }));
}

int tandem_load_main(int argc, char** argv, const char* program, const tandem_load_solver* solver,
                     void* self) {
  return load_main(argc, argv, program, *solver, self, protocol::Role::dem);
}

int tandem_liquid_main(int argc, char** argv, const char* program, const tandem_load_solver* solver,
                       void* self) {
  return load_main(argc, argv, program, *solver, self, protocol::Role::sph);
}

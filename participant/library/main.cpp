#include "protocol/participant/main.hpp"
#include "participant/library/adapter.hpp"

namespace {

using namespace tandem;

// Name for the log and the usage text: "my_solver 1.2" is `my_solver`.
std::string first_word(const std::string& program) {
  return program.substr(0, program.find(' '));
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
  const std::string release = program;
  return protocol::participant_main(argc, argv, {first_word(release), release},
                                    std::function<std::unique_ptr<protocol::LoadSolver>()>([&] {
                                      return participant::make_load_solver(*solver, self, release);
                                    }));
}

#include "protocol/participant/main.hpp"
#include "mbd_server/coupling/make_solver.hpp"

int main(int argc, char** argv) {
  return tandem::protocol::participant_main(
      argc, argv, tandem::protocol::own_program("mbd_server"),
      std::function<std::unique_ptr<tandem::protocol::MotionSolver>()>(tandem::mbd::make_solver));
}

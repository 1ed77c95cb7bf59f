// The main() of a participant: command line, logging, attach, serve, exit status.
//   mbd_server --shm NAME | --stream - | --dds RUN --interface IF [--peer HOST]
//              [--state-folder DIR] [--log-level L]
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "protocol/participant/solver.hpp"

namespace tandem::protocol {

struct Program {
  std::string name;     // for messages and the log: "mbd_server"
  std::string release;  // name and version: "mbd_server 0.1.0"
};
// One of the servers of this build.
Program own_program(const std::string& name);

int participant_main(int argc, char** argv, const Program& program,
                     const std::function<std::unique_ptr<MotionSolver>()>& make);
int participant_main(int argc, char** argv, const Program& program,
                     const std::function<std::unique_ptr<LoadSolver>()>& make);

}  // namespace tandem::protocol

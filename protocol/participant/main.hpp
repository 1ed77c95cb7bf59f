// The main() of both servers: command line, logging, attach, serve, exit status.
//   mbd_server --shm NAME | --dds RUN --interface IF [--peer HOST]  [--state-folder DIR] [--log-level L]
#pragma once

#include <functional>
#include <memory>

#include "protocol/participant/solver.hpp"

namespace tandem::protocol {

int participant_main(int argc, char** argv, const std::string& program,
                     const std::function<std::unique_ptr<MotionSolver>()>& make);
int participant_main(int argc, char** argv, const std::string& program,
                     const std::function<std::unique_ptr<LoadSolver>()>& make);

}  // namespace tandem::protocol

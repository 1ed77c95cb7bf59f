// What a coordinator needs to start one server and exchange messages with it.
//   1. create an endpoint (create_shm);
//   2. start the server's program with `server_arguments` appended and the `inherited` descriptors kept open:
//      they are close-on-exec here, so clear FD_CLOEXEC in the child (posix_spawn: adddup2(fd, fd));
//   3. call inherited.clear() in the coordinator, or a server that dies before it attaches is not detected.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol {

struct Endpoint {
  std::unique_ptr<Channel> channel;
  std::vector<std::string> server_arguments;
  std::vector<Fd> inherited;
};

}  // namespace tandem::protocol

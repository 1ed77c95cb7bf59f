#include "launch/coordinator/options.hpp"

namespace tandem::launch {

const char* name(Transport transport) {
  switch (transport) {
    case Transport::shm:
      return "shm";
    case Transport::inproc:
      return "inproc";
    case Transport::dds:
      return "dds";
  }
  return "unknown";
}

}  // namespace tandem::launch

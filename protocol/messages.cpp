#include "protocol/messages.hpp"

namespace tandem::protocol {

const char* name(Kind kind) {
  switch (kind) {
#define MESSAGE(name, code, sender, meaning) \
  case Kind::name:                           \
    return #name;
#include "protocol/messages.def"
#undef MESSAGE
  }
  return "unknown message";
}

const char* name(Role role) {
  switch (role) {
    case Role::mbd:
      return "mbd_server";
    case Role::dem:
      return "dem_server";
    case Role::sph:
      return "sph_server";
  }
  return "unknown role";
}

const char* word_of(Role role) {
  switch (role) {
    case Role::mbd:
      return "mbd";
    case Role::dem:
      return "dem";
    case Role::sph:
      return "sph";
  }
  return "unknown role";
}

}  // namespace tandem::protocol

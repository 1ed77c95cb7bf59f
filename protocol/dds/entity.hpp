// Owner of a Cyclone DDS handle, and the check of the return values of its functions.
#pragma once

#include <dds/dds.h>

#include <string>
#include <utility>

#include "common/error.hpp"

namespace tandem::protocol::dds {

// Passes a handle or a count through; a negative return becomes Error{resource}. `doing` completes "cannot
// ...".
inline dds_return_t checked(dds_return_t code, const char* doing) {
  if (code < 0) {
    throw Error(ErrorCode::resource, std::string("Cyclone DDS cannot ") + doing + ": " + dds_strretcode(code),
                "dds");
  }
  return code;
}

class Entity {
 public:
  Entity() = default;
  Entity(dds_entity_t handle, const char* doing) : handle_(checked(handle, doing)) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  // Returns when no listener of the entity is running any more.
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

}  // namespace tandem::protocol::dds

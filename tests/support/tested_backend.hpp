// Tests of particles are independent of the back end: each program that contains them defines the back end.
#pragma once

#include "particles/base/backend.hpp"

namespace tandem::test {

particles::Backend tested_backend();
inline const char* tested_backend_name() {
  return tested_backend() == particles::Backend::cuda ? "cuda" : "cpu";
}

}  // namespace tandem::test

// Tests of what particles do know no back end: each program that contains them defines for which one it is.
#pragma once

#include "dem_server/base/backend.hpp"

namespace tandem::test {

dem::Backend tested_backend();
inline const char* tested_backend_name() {
  return tested_backend() == dem::Backend::cuda ? "cuda" : "cpu";
}

}  // namespace tandem::test

#include "tests/support/tested_backend.hpp"

tandem::dem::Backend tandem::test::tested_backend() {
  return dem::Backend::cuda;
}

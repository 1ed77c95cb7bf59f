#include "tests/support/tested_backend.hpp"

tandem::particles::Backend tandem::test::tested_backend() {
  return particles::Backend::cpu;
}

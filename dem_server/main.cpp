#include "dem_server/coupling/make_solver.hpp"
#include "protocol/participant/main.hpp"

int main(int argc, char** argv) {
  return tandem::protocol::participant_main(argc, argv, "dem_server", tandem::dem::make_solver);
}

#include "protocol/participant/main.hpp"
#include "dem_server/coupling/make_solver.hpp"

int main(int argc, char** argv) {
  return tandem::protocol::participant_main(argc, argv, tandem::protocol::own_program("dem_server"),
                                            tandem::dem::make_solver);
}

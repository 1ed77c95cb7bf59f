#include "protocol/participant/main.hpp"
#include "sph_server/coupling/make_solver.hpp"

int main(int argc, char** argv) {
  return tandem::protocol::participant_main(argc, argv, tandem::protocol::own_program("sph_server"),
                                            tandem::sph::make_solver);
}

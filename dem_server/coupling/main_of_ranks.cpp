// dem_server_mpi: dem_server on several ranks, which mpirun starts. Rank 0 meets the coordinator.
#include "common/error.hpp"
#include "common/log.hpp"
#include "common/state_file.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "dem_server/coupling/ranked_solver.hpp"
#include "particles/base/mpi_ranks.hpp"
#include "protocol/participant/main.hpp"

int main(int argc, char** argv) {
  using namespace tandem;
  particles::MpiRanks ranks(argc, argv);
  try {
    dem::expect_same_program(ranks, file_digest("/proc/self/exe"));
  } catch (const Error& error) {
    log::setup("dem_server", "error");
    if (ranks.rank() == 0) log::error("{}", error.what());
    return exit_status(error.code());
  }
  if (ranks.rank() > 0) {
    log::setup("dem_server", "error");  // rank 0 says the rest
    dem::follow(ranks, *dem::make_solver_of_rank(ranks));
    return 0;
  }
  // Made at once, so that it lets the others leave whatever this one finds in its command line.
  std::unique_ptr<protocol::LoadSolver> solver =
      std::make_unique<dem::LeadingSolver>(ranks, dem::make_solver_of_rank(ranks));
  return protocol::participant_main(
      argc, argv, protocol::own_program("dem_server"),
      [&]() -> std::unique_ptr<protocol::LoadSolver> { return std::move(solver); });
}

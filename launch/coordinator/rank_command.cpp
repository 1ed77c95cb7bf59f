#include "launch/coordinator/rank_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "common/error.hpp"
#include "launch/build_info.hpp"

namespace tandem::launch {
namespace {

constexpr const char* program_of_ranks = "dem_server_mpi";

[[noreturn]] void refuse(const std::string& problem, const std::string& remedy) {
  throw Error(ErrorCode::usage, problem, "--ranks", remedy);
}

void expect_program() {
  const std::filesystem::path program = program_folder() / program_of_ranks;
  if (!has_mpi)
    refuse("this build of tandem has no MPI, which several ranks need",
           "run launch/install and launch/build, which find Debian's OpenMPI, or leave --ranks out");
  if (access(program.c_str(), X_OK) != 0)
    refuse(fmt::format("{} is not there", program.string()),
           "build it, or install all programs of tandem into one folder");
  if (access(mpirun, X_OK) != 0)
    refuse(fmt::format("{}, which starts the ranks, is not there", mpirun),
           "install openmpi-bin, or leave --ranks out");
}

}  // namespace

void expect_ranks(const RunOptions& options) {
  if (options.ranks == 1) return;
  if (options.ranks < 1 || options.ranks > most_ranks)
    refuse(fmt::format("{} is no number of ranks", options.ranks),
           fmt::format("give 1 to {}; 1 is one process with threads", most_ranks));
  if (options.transport != Transport::shm || options.attach)
    refuse("several ranks are started from here and reached over shared memory so far",
           "leave --transport and --attach out");
  if (options.backend == "cuda")
    refuse("several ranks run on the cores of this host, not on GPUs yet",
           "give --backend cpu, or no --ranks");
  expect_program();
}

void expect_ranks(const RunOptions& options, const scene::Scene& scene, const ForeignServers& foreign) {
  if (options.ranks == 1) return;
  if (!scene.dem)
    refuse("the scene has no spheres, and only dem_server runs on several ranks", "leave --ranks out");
  if (foreign.of(protocol::Role::dem))
    refuse("several ranks are those of dem_server, and another program computes the spheres of this run",
           "leave one of the two out");
}

Command start_of_ranks(unsigned ranks, const std::vector<std::string>& arguments) {
  Command command;
  command.name = fmt::format("dem_server on {} ranks", ranks);
  command.program = mpirun;
  // The ranks wait for each other in each micro step: where they share cores, a waiting one must yield.
  // Their threads use all cores that the run may use, not one each.
  command.arguments = {"-n", std::to_string(ranks), "--oversubscribe", "--bind-to", "none"};
  const auto set = [&](const char* parameter, const char* value) {
    command.arguments.insert(command.arguments.end(), {"--mca", parameter, value});
  };
  set("mpi_yield_when_idle", "1");
  // One host: no network. Copies between processes need a right that containers lack.
  set("btl", "self,vader");
  set("btl_vader_single_copy_mechanism", "none");
  set("odls_base_sigkill_timeout", "0");  // where one rank has died, the others end at once
  if (geteuid() == 0) command.arguments.push_back("--allow-run-as-root");
  command.arguments.push_back((program_folder() / program_of_ranks).string());
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.foreign = true;  // its children end with it
  return command;
}

}  // namespace tandem::launch

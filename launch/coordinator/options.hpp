// What the user asked for on the command line of `tandem run`.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace tandem::launch {

// Values that replace those of the scene file, for this run only.
struct Overrides {
  std::optional<double> end_time;  // [s]
  std::optional<std::string> scheme;
  std::optional<double> window;  // [s]
};

enum class Transport { shm, inproc, dds };
const char* name(Transport transport);

// How the error that the step of the multibody part leaves is measured.
enum class Estimate {
  standard,    // by the solver itself, with longer steps
  richardson,  // by a second run with steps half as long
};
Estimate parse_estimate(const std::string& word);  // Error{usage} with the nearest word

struct RunOptions;
// Who may take part in a run over dds: "secret", "certificates" or both, or "none": everybody.
const char* dds_security(const RunOptions& options);

struct RunOptions {
  std::filesystem::path scene, folder;
  Overrides overrides;
  std::string backend = "auto";  // "auto", "cpu", "cuda"
  unsigned threads = 0;          // of the particle solver; 0: it chooses
  Transport transport = Transport::shm;
  bool attach = false;   // servers are started by hand
  std::string run_name;  // that attached servers are started with; empty: chosen here
  std::string dds_interface = "lo", dds_peer;
  std::string
      secret_file;  // of transport dds; empty: the environment's, or one made here for servers started here
  std::string certificates;                        // folder, of transport dds; empty: none
  bool insecure = false;                           // neither
  std::chrono::milliseconds patience{60'000};      // bound of one wait for a server
  std::optional<std::chrono::milliseconds> lease;  // silence that is a loss; empty: as the transport has it
  std::string controller;                          // command that gives the control inputs; empty: none
  double checkpoint_every = 0;                     // simulated time between restart files [s]; 0: none
  std::filesystem::path restart;                   // run or checkpoint to go on from; empty: from the start
  std::filesystem::path record;                    // of all frames; empty: none
  Estimate estimate = Estimate::standard;
  bool strict = false;  // a suspect run has exit status 1
  bool picture = true, report = true, quiet = false;
};

}  // namespace tandem::launch

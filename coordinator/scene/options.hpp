// The command line of `tandem run`.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// Values that replace those of the scene file, for this run only.
struct Overrides {
  std::map<std::string, double> set;  // values of the scene's parameters, in their units
  std::optional<double> end_time;     // [s]
  std::optional<std::string> scheme;
  std::optional<double> window;  // [s]
  bool equilibrium = false;      // start of the machine
};

enum class Transport { shm, inproc, dds, stream };
const char* name(Transport transport);

// How the discretisation error of the multibody part is measured.
enum class Estimate {
  standard,    // by the solver itself, with longer steps
  richardson,  // by a second run with steps half as long
};
Estimate parse_estimate(const std::string& word);  // Error{usage} with the nearest word

inline constexpr int most_ranks = 1024;

struct RunOptions;
// Participants that a run over dds admits: those with "secret", "certificates" or both; "none": everybody.
const char* dds_security(const RunOptions& options);

struct RunOptions {
  std::filesystem::path scene, folder;
  Overrides overrides;
  std::string backend = "auto";    // "auto", "cpu", "cuda"
  unsigned threads = 0;            // of the particle solver; 0: the solver chooses
  int ranks = 1;                   // processes that share the spheres
  std::vector<std::string> hosts;  // of the ranks, this one first; empty: this one
  Transport transport = Transport::shm;
  bool attach = false;   // servers are started by the user
  std::string run_name;  // run name for attached servers; empty: generated
  std::string dds_interface = "lo", dds_peer;
  std::string secret_file;   // of transport dds; empty: from the environment, or generated for servers that
                             // this process starts
  std::string certificates;  // folder, of transport dds; empty: none
  bool insecure = false;     // neither secret nor certificates
  std::chrono::milliseconds patience{60'000};  // limit of one wait for a server
  // Silence after which a peer is lost; empty: default of the transport.
  std::optional<std::chrono::milliseconds> lease;
  // Commands of servers that replace ours; absent: those of the scene, or ours.
  std::optional<std::string> mbd_server, dem_server, sph_server;
  bool allow_scene_servers = false;  // whether commands of the scene are started
  std::string controller;            // command of the control program; empty: none
  double checkpoint_every = 0;       // simulated time between restart files [s]; 0: none
  std::filesystem::path restart;     // run or checkpoint to continue from; empty: from the start
  std::filesystem::path record;      // file for the recording of all frames; empty: none
  Estimate estimate = Estimate::standard;
  bool strict = false;  // a suspect run has exit status 1
  bool picture = true, report = true, quiet = false;
};

}  // namespace tandem::launch

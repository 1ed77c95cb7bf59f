// `tandem conform`: judges a participant.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "launch/conform/session.hpp"
#include "launch/conform/subject.hpp"

namespace tandem::conform {

struct ConformOptions {
  std::string command;  // of the participant; the name of a server of tandem is that of this build
  protocol::Role role{};
  Transport transport = Transport::shm;
  std::filesystem::path scene;        // of the user; empty: the built-in scenes
  std::map<std::string, double> set;  // of the parameters of that scene, by name
  std::filesystem::path out;          // folder of the report; empty: none
  std::vector<std::string> checks;    // names; empty: all
  Limits limits;
};

// Prints each result, and writes the report. Returns the exit status: 0 where the participant passes, 1
// where it does not.
int conform(const ConformOptions& options);
// The checks of a role, with their meaning.
std::string list_of_checks(protocol::Role role);

}  // namespace tandem::conform

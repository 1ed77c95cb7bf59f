// What is fuzzed: a part of tandem that takes bytes from outside, with whole inputs to begin with.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/mutator.hpp"
#include "tests/fuzz/random.hpp"

namespace tandem::fuzz {

// Something that must not happen: what was accepted is wrong, or what had to be refused was accepted.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

// Throws Finding where `holds` is false.
inline void expect(bool holds, const char* sentence) {
  if (!holds) throw Finding(sentence);
}

class Target {
 public:
  virtual ~Target() = default;
  // Takes the input, or throws tandem::Error: it is refused. Every other end is a finding.
  virtual void run(std::span<const std::byte> input) = 0;
};

enum class Fate {
  open,     // may be accepted or refused
  refused,  // must be refused, unless it is an entry of the corpus
};

struct TargetKind {
  std::string_view name;
  bool text = false;
  // A library that is not ours loses memory; processes are replaced before it is much.
  bool leaks = false;
  // Whole inputs, all of which are accepted. `folder` is empty and may be written to.
  std::vector<Bytes> (*corpus)(const std::filesystem::path& folder) = nullptr;
  // `folder` belongs to this one alone.
  std::unique_ptr<Target> (*make)(const std::filesystem::path& folder) = nullptr;
  // Last touch on a damaged input, such as a new digest, so that what lies behind it is reached.
  Fate (*finish)(Random& random, Bytes& input) = nullptr;
};

// All targets, in targets/list.cpp.
std::span<const TargetKind> all_targets();

}  // namespace tandem::fuzz

// A fuzzed part of tandem that reads bytes from outside, with the valid inputs that damaged ones are made
// from.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/fuzz/mutator.hpp"
#include "tests/fuzz/random.hpp"

namespace tandem::fuzz {

// A defect: an accepted input has a wrong result, or an input was accepted that must be refused.
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
  // Accepts the input, or refuses it by throwing tandem::Error. Any other outcome is a finding.
  virtual void run(std::span<const std::byte> input) = 0;
};

enum class Fate {
  open,     // may be accepted or refused
  refused,  // must be refused, unless it is an entry of the corpus
};

struct TargetKind {
  std::string_view name;
  bool text = false;
  // A third-party library leaks memory: processes are replaced before they have leaked much.
  bool leaks = false;
  // Valid inputs, which must all be accepted. `folder` is empty and may be written to.
  std::vector<Bytes> (*corpus)(const std::filesystem::path& folder) = nullptr;
  // No other target uses `folder`.
  std::unique_ptr<Target> (*make)(const std::filesystem::path& folder) = nullptr;
  // Last change to a damaged input, such as a new digest, without which a target would refuse it at once.
  Fate (*finish)(Random& random, Bytes& input) = nullptr;
};

// TargetKind::make of a target.
template <class T>
std::unique_ptr<Target> make_target(const std::filesystem::path& folder) {
  if constexpr (std::is_constructible_v<T, const std::filesystem::path&>)
    return std::make_unique<T>(folder);
  else
    return std::make_unique<T>();
}

// All targets, in targets/list.cpp.
std::span<const TargetKind> all_targets();

}  // namespace tandem::fuzz

// Bodies of a STEP file: parts alone, merged, or fused to a neighbour, with mass.
#pragma once

#include <string>
#include <vector>

#include "launch/import/contact_faces.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

struct StepBody {
  std::string name;
  std::vector<std::size_t> parts;  // the heaviest first: the body has its axes
  bool is_ground = false;
  MassProperties mass;  // in the axes of the body, about the origin of its heaviest part [kg, m]
  Pose pose;            // of the centre of mass in the world
};

struct StepDensity {
  double value = 0;    // [kg/m3]
  std::string source;  // "steel", "--density"
};

struct StepBodies {
  std::vector<StepBody> bodies;
  std::vector<std::size_t> body_of;    // (parts); no_body where the part has no solid
  std::vector<StepDensity> densities;  // (parts)
};
inline constexpr std::size_t no_body = static_cast<std::size_t>(-1);

// Throws Error{usage} for a pattern that no part has, and for parts without a density.
StepBodies bodies_of(const StepFile& step, const std::vector<FittingFaces>& fits,
                     const ImportOptions& options, std::vector<std::string>& notes);

// "PATTERN=VALUE", or "VALUE" for all parts.
struct PatternValue {
  std::string pattern, value;
};
PatternValue pattern_value(const std::string& text);

// Does the pattern, with * and ?, match the part, one of its assemblies, or its path "assembly/part"?
bool matches(const std::string& pattern, const StepPart& part);

// The value of the last of the options that matches the part; empty: none.
std::string value_for(const StepPart& part, const std::vector<std::string>& options);

}  // namespace tandem::launch

// Output and checks of a run.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/keys.hpp"

namespace tandem::scene {

struct Camera : CameraKeys {};

// What frames have of the spheres besides position, velocity, spin and radius: a column for each.
enum class SphereField { group, material, contact_count, mean_stress };
inline constexpr std::array<std::string_view, 4> sphere_field_names{"group", "material", "contact_count",
                                                                    "mean_stress"};

struct Output : OutputKeys {
  std::optional<Camera> camera;  // of the picture of the last frame; absent: chosen from the domain
  // Columns of the CSV files that the report draws, with * for any characters; empty: the report chooses.
  std::vector<std::string> plots = {};
  std::vector<SphereField> fields = {};       // of the spheres in frames, each once
  std::vector<std::string> wall_fields = {};  // walls whose triangles have fields in frames
  std::vector<BodyId> contacts = {};          // bodies whose contacts with spheres are in frames

  bool has(SphereField field) const { return std::ranges::find(fields, field) != fields.end(); }
  // Whether frames have fields that only the particle solver knows.
  bool needs_contacts() const { return has(SphereField::contact_count) || has(SphereField::mean_stress); }
  // Whether contacts are evaluated for frames.
  bool evaluates_contacts() const { return needs_contacts() || !contacts.empty(); }
};

// A pass/fail figure of the run. `of` names a time signal "<column>" of bodies.csv, joints.csv or
// elements.csv, for instance "box.contact_force.z" or "hinge.q", or a number of summary.json as
// "summary.lost_particles". `reduce` computes one number from the part from..to of the signal.
struct Check : CheckKeys {
  std::string name, of;
  // Last, mean, rms, mean_abs, min, max, range, period (mean distance of upward crossings of the mean).
  std::string reduce = "last";
  double expected = 0;      // with expected_of: filled in by the evaluation
  std::string expected_of;  // another signal or number, reduced in the same way; empty: `expected` is given
  double times = 1;         // factor of that one
  std::string why;          // the formula or the source of `expected`
};

}  // namespace tandem::scene

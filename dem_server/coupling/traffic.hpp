// Spheres that come in through inlets and go out through outlets, between two windows.
#pragma once

#include <algorithm>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/io/inlets.hpp"
#include "protocol/facts.hpp"

namespace tandem::dem {

class Traffic {
 public:
  Traffic() = default;
  // The spheres of the inlets have the last ids, from `first_waiting` on, in the order of the inlets.
  Traffic(const scene::Scene& scene, std::vector<Inlet> inlets, std::uint32_t first_waiting);

  bool any() const { return !inlets_.empty() || !outlets_.empty(); }
  // Whether the number of spheres depends on the scene's end_time.
  bool follows_end() const {
    return std::ranges::any_of(inlets_, [](const Inlet& inlet) { return !inlet.fill.count; });
  }

  // Counts of one inlet or outlet so far.
  struct Counts {
    std::uint64_t passed = 0;   // spheres that came in or went out
    std::uint64_t crowded = 0;  // windows before which an inlet had no room for a sphere that was due
  };
  // The counts before the first window: those of each inlet, then those of each outlet.
  std::vector<Counts> no_counts() const { return std::vector<Counts>(inlets_.size() + outlets_.size()); }

  // Whether no inlet has brought in more spheres than it has.
  bool is_possible(const std::vector<Counts>& counts) const;

  // To be called before the window that begins at `now`, with the poses of the bodies at that time. Outlets
  // remove spheres first. Then each sphere that is due comes in at a random free position of its inlet. If
  // none of the positions that are tried is free, this sphere and all later ones of the inlet wait for the
  // next window. Positions depend on the seed, the sphere and `now` only. Inlets and outlets move with the
  // domain, by `shift` [m]. Returns new warnings.
  std::vector<std::string> pass(Engine& engine, Nanoseconds now, std::span<const BodyPose> poses, Vec3d shift,
                                std::vector<Counts>& counts);

  // Adds the counts to what is reported: to `facts`, which have warnings, and to `others`, upon which nobody
  // acts.
  void report(const std::vector<Counts>& counts, protocol::DemFacts& facts,
              nlohmann::ordered_json& others) const;

 private:
  // The warning about an inlet that did not bring in all its spheres in time; empty where there is none.
  std::string complaint(std::size_t inlet, const Counts& counts) const;

  // Returns false when there is no room.
  bool insert(Engine& engine, const Inlet& inlet, std::uint32_t first, Nanoseconds now,
              std::span<const BodyPose> poses, Vec3d shift, Counts& so_far);

  Periods periods_;
  std::vector<Inlet> inlets_;
  std::vector<std::uint32_t> first_;  // id of each inlet's first sphere
  std::vector<scene::Outlet> outlets_;
  std::vector<bool> warned_;               // of each inlet: that it had no room
  double last_begin_ = -1, end_time_ = 0;  // of the last window, and of the scene [s]
};

}  // namespace tandem::dem

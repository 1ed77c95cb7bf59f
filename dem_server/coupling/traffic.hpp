// Spheres that come in through inlets and go out through outlets, at the borders of windows.
#pragma once

#include <algorithm>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/geometry/periods.hpp"
#include "dem_server/io/inlets.hpp"

namespace tandem::dem {

class Traffic {
 public:
  Traffic() = default;
  // The spheres of the inlets are the last ones, in order of the inlets, from id `first_waiting` on.
  Traffic(const scene::Scene& scene, std::vector<Inlet> inlets, std::uint32_t first_waiting);

  bool any() const { return !inlets_.empty() || !outlets_.empty(); }
  // Does how many spheres there are depend on the scene's end?
  bool follows_end() const {
    return std::ranges::any_of(inlets_, [](const Inlet& inlet) { return !inlet.fill.count; });
  }

  // What an inlet or outlet has done so far.
  struct Seen {
    std::uint64_t passed = 0;   // spheres that came in or went out
    std::uint64_t crowded = 0;  // borders at which an inlet had no room for a sphere that was due
  };
  // Of each inlet, then of each outlet, before the first window.
  std::vector<Seen> nothing_seen() const { return std::vector<Seen>(inlets_.size() + outlets_.size()); }

  // Whether no inlet has brought in more spheres than it has.
  bool is_possible(const std::vector<Seen>& seen) const;

  // At the border before the window that begins at `now`, the bodies being in these poses: outlets first. A
  // sphere that is due comes in at a random place of its inlet that is free; where none of some places is, it
  // waits for the next border, and those after it with it. positions follow from the seed, the sphere and
  // `now`. Returns what to warn of, if anything is new. Inlets and outlets move with the domain, by `shift`
  // [m].
  std::vector<std::string> pass(Engine& engine, Nanoseconds now, std::span<const BodyPose> poses, Vec3d shift,
                                std::vector<Seen>& seen);

  // For the summary.
  void report(const std::vector<Seen>& seen, nlohmann::json& facts) const;

 private:
  // A sentence on an inlet that did not do what was asked of it, or none.
  std::string complaint(std::size_t inlet, const Seen& seen) const;

  struct Outlet {
    std::string name;
    Region region;
  };
  // Returns false when there is no room.
  bool insert(Engine& engine, const Inlet& inlet, std::uint32_t first, Nanoseconds now,
              std::span<const BodyPose> poses, Vec3d shift, Seen& so_far);

  Periods periods_;
  std::vector<Inlet> inlets_;
  std::vector<std::uint32_t> first_;  // id of each inlet's first sphere
  std::vector<Outlet> outlets_;
  std::vector<bool> told_;             // of each inlet: that it had no room
  double last_border_ = -1, end_ = 0;  // of the windows begun, and of the scene [s]
};

}  // namespace tandem::dem

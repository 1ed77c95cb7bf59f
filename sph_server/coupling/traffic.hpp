// Particles of the liquid that come in through inlets and go out through outlets.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "common/scene/model.hpp"
#include "protocol/facts.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/io/inlets.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

class Traffic {
 public:
  // What one inlet or outlet has passed since the start. Numbers only, without gaps.
  struct Counts {
    std::uint64_t layers = 0;  // of an inlet
    std::uint64_t particles = 0;
  };
  // What an exchange of particles brought, less what it took away.
  struct Brought {
    Vec3d momentum;             // [kg m/s]
    double came = 0, went = 0;  // energy, kinetic and of compression [J]
  };

  Traffic() = default;
  // `setup`: its last walls are the pistons of the inlets.
  Traffic(const scene::Sph& sph, std::vector<Inlet> inlets, const LiquidSetup& setup);

  bool any() const { return !inlets_.empty() || !outlets_.empty(); }
  std::vector<Counts> no_counts() const { return std::vector<Counts>(inlets_.size() + outlets_.size()); }
  bool is_possible(const std::vector<Counts>& counts) const;

  // Puts the pistons, the last of `poses`, where they are at that time [s].
  void place_pistons(double time, const std::vector<Counts>& counts,
                     std::span<particles::BodyPose> poses) const;
  // When the next layer of an inlet is due [s]; infinite where none is.
  double next(const std::vector<Counts>& counts) const;
  // Takes the particles in outlets out. `id`: of the particles.
  // shift: of the domain since the start [m].
  Brought drain(LiquidEngine& engine, Vec3d shift, std::vector<std::uint32_t>& id,
                std::vector<Counts>& counts) const;
  // Brings in the layers that are due by `due` [s], at the time [s]. `first`: id of the first particle that
  // comes in through an inlet.
  Brought feed(LiquidEngine& engine, double time, double due, std::uint32_t first,
               std::vector<std::uint32_t>& id, std::vector<Counts>& counts);

  // Particles that come in until the end of the run [s].
  std::size_t to_come(double end_time) const;
  std::uint64_t came_in(const std::vector<Counts>& counts) const;  // particles
  // What is reported: of `facts` the counts, and `others`.
  void report(const std::vector<Counts>& counts, protocol::SphFacts& facts,
              nlohmann::ordered_json& others) const;

 private:
  std::vector<Inlet> inlets_;
  std::vector<scene::Outlet> outlets_;
  Liquid liquid_;
  particles::Periods periods_;
  Walls walls_;  // without the pistons
};

}  // namespace tandem::sph

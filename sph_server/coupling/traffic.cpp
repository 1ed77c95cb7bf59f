#include "sph_server/coupling/traffic.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "particles/serving/sensors.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/neighbours/neighbour.hpp"

namespace tandem::sph {
Traffic::Traffic(const scene::Sph& sph, std::vector<Inlet> inlets, const LiquidSetup& setup)
    : inlets_(std::move(inlets)), outlets_(sph.outlets), liquid_(setup.liquid), periods_(setup.periods) {
  if (inlets_.empty()) return;
  const std::vector<TriangleMesh> walls(setup.walls.begin(),
                                        setup.walls.end() - static_cast<std::ptrdiff_t>(inlets_.size()));
  walls_ = Walls(walls, liquid_.support());
}

bool Traffic::is_possible(const std::vector<Counts>& counts) const {
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (k < inlets_.size() ? counts[k].particles != counts[k].layers * inlets_[k].site.size()
                           : counts[k].layers != 0)
      return false;
  return came_in(counts) < Neighbour::most;
}

std::uint64_t Traffic::came_in(const std::vector<Counts>& counts) const {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < inlets_.size(); ++k) sum += counts[k].particles;
  return sum;
}

void Traffic::place_pistons(double time, const std::vector<Counts>& counts,
                            std::span<particles::BodyPose> poses) const {
  for (std::size_t k = 0; k < inlets_.size(); ++k)
    poses[poses.size() - inlets_.size() + k] = inlets_[k].pose(time, counts[k].layers);
}

double Traffic::next(const std::vector<Counts>& counts) const {
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < inlets_.size(); ++k)
    if (const double due = inlets_[k].due(counts[k].layers); due <= inlets_[k].end())
      next = std::min(next, due);
  return next;
}

Traffic::Brought Traffic::drain(LiquidEngine& engine, Vec3d shift, std::vector<std::uint32_t>& id,
                                std::vector<Counts>& counts) const {
  Brought brought;
  if (outlets_.empty()) return brought;
  std::vector<particles::OutletRegion> regions;
  for (const scene::Outlet& outlet : outlets_) regions.push_back(particles::region_of(outlet, shift));
  const std::vector<TakenParticle> taken = engine.take_out(regions);
  if (taken.empty()) return brought;
  std::size_t kept = 0;
  auto next = taken.begin();
  for (std::uint32_t i = 0; i < id.size(); ++i) {
    if (next == taken.end() || next->number != i) {
      id[kept++] = id[i];
      continue;
    }
    const auto outlet = std::ranges::find_if(
        regions, [&](const particles::OutletRegion& r) { return r.contains(next->position); });
    ++counts[inlets_.size() + static_cast<std::size_t>(outlet - regions.begin())].particles;
    brought.momentum -= liquid_.mass() * next->velocity;
    brought.went += energy_of(liquid_, next->velocity, next->compression);
    ++next;
  }
  id.resize(kept);
  return brought;
}

Traffic::Brought Traffic::feed(LiquidEngine& engine, double time, double due, std::uint32_t first,
                               std::vector<std::uint32_t>& id, std::vector<Counts>& counts) {
  Brought brought;
  const LiquidState state = engine.state();
  std::vector<particles::BodyPose> poses = engine.poses();
  for (std::uint32_t w = 0; w < walls_.bodies(); ++w) walls_.set_pose(w, poses[w]);
  const Probe probe(state, liquid_, periods_, walls_);
  const double stiffness = liquid_.density * liquid_.sound_speed * liquid_.sound_speed;
  LiquidState arriving;
  for (std::size_t k = 0; k < inlets_.size(); ++k) {
    const Inlet& inlet = inlets_[k];
    if (!(inlet.due(counts[k].layers) <= std::min(due, inlet.end()))) continue;
    const std::uint64_t came = came_in(counts);
    if (first + came + inlet.site.size() >= Neighbour::most)
      throw Error(ErrorCode::scene,
                  "more than " + std::to_string(Neighbour::most - 1) + " particles of the liquid",
                  "sph.inlets", "give the inlet '" + inlet.of.name + "' an end, or a larger sph.spacing");
    const particles::BodyPose piston = inlet.pose(time, ++counts[k].layers);
    for (std::size_t i = 0; i < inlet.site.size(); ++i) {
      const Vec3d x = piston.p + piston.R * (inlet.site[i] + Vec3d{0, 0, 0.5 * inlet.thickness}),
                  v = piston.R * Vec3d{0, 0, inlet.of.speed()};
      const double compression = compression_at(std::max(0.0, probe.pressure_at(x) / stiffness));
      arriving.position.push_back(x);
      arriving.velocity.push_back(v);
      arriving.compression.push_back(compression);
      id.push_back(first + static_cast<std::uint32_t>(came + i));
      brought.momentum += liquid_.mass() * v;
      brought.came += energy_of(liquid_, v, compression);
    }
    counts[k].particles += inlet.site.size();
  }
  place_pistons(time, counts, poses);
  if (arriving.size() > 0) engine.exchange({}, arriving, poses);
  return brought;
}

std::size_t Traffic::to_come(double end_time) const {
  std::size_t sum = 0;
  for (const Inlet& inlet : inlets_)
    sum += static_cast<std::size_t>(inlet.layers_until(end_time)) * inlet.site.size();
  return sum;
}

void Traffic::report(const std::vector<Counts>& counts, protocol::SphFacts& facts,
                     nlohmann::ordered_json& others) const {
  if (!any()) return;
  std::uint64_t out = 0;
  others["inlets"] = others["outlets"] = nlohmann::ordered_json::object();
  const auto of = [&](const Counts& s) -> nlohmann::ordered_json {
    return {{"particles", s.particles}, {"mass_kg", static_cast<double>(s.particles) * liquid_.mass()}};
  };
  for (std::size_t k = 0; k < inlets_.size(); ++k) others["inlets"][inlets_[k].of.name] = of(counts[k]);
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const Counts& s = counts[inlets_.size() + k];
    out += s.particles;
    others["outlets"][outlets_[k].name] = of(s);
  }
  facts.came_in = came_in(counts);
  facts.went_out = out;
}

}  // namespace tandem::sph

#include "sph_server/coupling/traffic.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/neighbours/neighbour.hpp"

namespace tandem::sph {
namespace {

OutletRegion region_of(const scene::Outlet& outlet, Vec3d shift) {
  if (const auto* beyond = std::get_if<scene::HalfSpace>(&outlet.region))
    return {true, beyond->point + shift, beyond->normal};
  const auto& box = std::get<scene::Box>(outlet.region);
  return {false, box.min + shift, box.max + shift};
}

}  // namespace

Traffic::Traffic(const scene::Sph& sph, std::vector<Inlet> inlets, const LiquidSetup& setup)
    : inlets_(std::move(inlets)), outlets_(sph.outlets), liquid_(setup.liquid), periods_(setup.periods) {
  if (inlets_.empty()) return;
  const std::vector<TriangleMesh> walls(setup.walls.begin(),
                                        setup.walls.end() - static_cast<std::ptrdiff_t>(inlets_.size()));
  walls_ = Walls(walls, liquid_.support());
}

bool Traffic::is_possible(const std::vector<Seen>& seen) const {
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (k < inlets_.size() ? seen[k].particles != seen[k].layers * inlets_[k].site.size()
                           : seen[k].layers != 0)
      return false;
  return came_in(seen) < Neighbour::most;
}

std::uint64_t Traffic::came_in(const std::vector<Seen>& seen) const {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < inlets_.size(); ++k) sum += seen[k].particles;
  return sum;
}

void Traffic::place_pistons(double time, const std::vector<Seen>& seen,
                            std::span<particles::BodyPose> poses) const {
  for (std::size_t k = 0; k < inlets_.size(); ++k)
    poses[poses.size() - inlets_.size() + k] = inlets_[k].pose(time, seen[k].layers);
}

double Traffic::next(const std::vector<Seen>& seen) const {
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < inlets_.size(); ++k)
    if (const double due = inlets_[k].due(seen[k].layers); due <= inlets_[k].end())
      next = std::min(next, due);
  return next;
}

Traffic::Brought Traffic::drain(LiquidEngine& engine, Vec3d shift, std::vector<std::uint32_t>& id,
                                std::vector<Seen>& seen) const {
  Brought brought;
  if (outlets_.empty()) return brought;
  std::vector<OutletRegion> regions;
  for (const scene::Outlet& outlet : outlets_) regions.push_back(region_of(outlet, shift));
  const std::vector<TakenParticle> taken = engine.take_out(regions);
  if (taken.empty()) return brought;
  std::size_t kept = 0;
  auto next = taken.begin();
  for (std::uint32_t i = 0; i < id.size(); ++i) {
    if (next == taken.end() || next->number != i) {
      id[kept++] = id[i];
      continue;
    }
    const auto outlet =
        std::ranges::find_if(regions, [&](const OutletRegion& r) { return r.contains(next->position); });
    ++seen[inlets_.size() + static_cast<std::size_t>(outlet - regions.begin())].particles;
    brought.momentum -= liquid_.mass() * next->velocity;
    brought.went += energy_of(liquid_, next->velocity, next->compression);
    ++next;
  }
  id.resize(kept);
  return brought;
}

Traffic::Brought Traffic::feed(LiquidEngine& engine, double time, double due, std::uint32_t first,
                               std::vector<std::uint32_t>& id, std::vector<Seen>& seen) {
  Brought brought;
  const LiquidState state = engine.state();
  std::vector<particles::BodyPose> poses = engine.poses();
  for (std::uint32_t w = 0; w < walls_.bodies(); ++w) walls_.set_pose(w, poses[w]);
  const Probe probe(state, liquid_, periods_, walls_);
  const double stiffness = liquid_.density * liquid_.sound_speed * liquid_.sound_speed;
  LiquidState arriving;
  for (std::size_t k = 0; k < inlets_.size(); ++k) {
    const Inlet& inlet = inlets_[k];
    if (!(inlet.due(seen[k].layers) <= std::min(due, inlet.end()))) continue;
    const std::uint64_t came = came_in(seen);
    if (first + came + inlet.site.size() >= Neighbour::most)
      throw Error(ErrorCode::scene,
                  "more than " + std::to_string(Neighbour::most - 1) + " particles of the liquid",
                  "sph.inlets", "give the inlet '" + inlet.of.name + "' an end, or a larger sph.spacing");
    const particles::BodyPose piston = inlet.pose(time, ++seen[k].layers);
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
    seen[k].particles += inlet.site.size();
  }
  place_pistons(time, seen, poses);
  if (arriving.size() > 0) engine.exchange({}, arriving, poses);
  return brought;
}

std::size_t Traffic::to_come(double end_time) const {
  std::size_t sum = 0;
  for (const Inlet& inlet : inlets_)
    sum += static_cast<std::size_t>(inlet.layers_until(end_time)) * inlet.site.size();
  return sum;
}

void Traffic::report(const std::vector<Seen>& seen, protocol::SphFacts& facts,
                     nlohmann::ordered_json& others) const {
  if (!any()) return;
  std::uint64_t out = 0;
  others["inlets"] = others["outlets"] = nlohmann::ordered_json::object();
  const auto of = [&](const Seen& s) -> nlohmann::ordered_json {
    return {{"particles", s.particles}, {"mass_kg", static_cast<double>(s.particles) * liquid_.mass()}};
  };
  for (std::size_t k = 0; k < inlets_.size(); ++k) others["inlets"][inlets_[k].of.name] = of(seen[k]);
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const Seen& s = seen[inlets_.size() + k];
    out += s.particles;
    others["outlets"][outlets_[k].name] = of(s);
  }
  facts.came_in = came_in(seen);
  facts.went_out = out;
}

}  // namespace tandem::sph

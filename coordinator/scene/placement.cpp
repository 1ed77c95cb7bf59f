#include "coordinator/scene/placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/scene/fault.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/particle_file.hpp"
#include "common/scene/sizes.hpp"
#include "coordinator/scene/check_bed.hpp"
#include "coordinator/scene/run_frame.hpp"
#include "coordinator/scene/scene_spheres.hpp"
#include "coordinator/scene/settle.hpp"
#include "coordinator/scene/settle_cache.hpp"
#include "particles/io/place.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

bool is_placed(const scene::ParticleGroup& group) {
  return std::holds_alternative<scene::PackingFill>(group.fill) ||
         std::holds_alternative<scene::RunFill>(group.fill);
}

std::string region_text(const scene::PackingFill& fill) {
  if (const auto* inside = std::get_if<scene::InsideWall>(&fill.region)) return "inside " + inside->wall;
  if (const auto* above = std::get_if<scene::AboveWall>(&fill.region)) return "above " + above->wall;
  if (const auto* between = std::get_if<scene::BetweenWalls>(&fill.region))
    return fmt::format("between {}", fmt::join(between->walls, ", "));
  return std::holds_alternative<scene::Box>(fill.region) ? "in a box" : "in a cylinder";
}

void expect_in_domain(const scene::ParticleFile& spheres, const scene::Dem& dem, const std::string& where,
                      const std::string& remedy) {
  for (std::size_t i = 0; i < spheres.positions.size(); ++i)
    for (int a = 0; a < 3; ++a)
      if (spheres.positions[i][a] < dem.domain.min[a] || spheres.positions[i][a] > dem.domain.max[a])
        throw Error(
            ErrorCode::scene,
            fmt::format("sphere {} at {} m is outside the domain", i, scene::rounded(spheres.positions[i])),
            where, remedy);
}

// Replaces fills by particle files, one group after the other.
class Placing {
 public:
  Placing(const std::filesystem::path& folder, SceneFile& file)
      : folder_(folder), file_(file), given_(file.scene), json_(Json::parse(file.text)), known_(given_) {
    known_.dem->settle.reset();
    // Inlets stand for the groups that are still to be placed.
    for (scene::ParticleGroup& group : known_.dem->particles)
      if (is_placed(group)) group.fill = scene::InletFill{};
  }

  void take_frames_of_runs() {
    for (std::size_t i = 0; i < groups().size(); ++i)
      if (const auto* fill = std::get_if<scene::RunFill>(&groups()[i].fill)) {
        file_.inputs.push_back(scene::resolve_file(fill->folder, folder_));
        const RunFrame frame = read_run_frame(file_.inputs.back(), fill->time, place_of(i));
        file_.inputs.insert(file_.inputs.end(), frame.read.begin(), frame.read.end());
        expect_in_domain(frame.spheres, *given_.dem, place_of(i), "enlarge dem.domain");
        insert(i, frame.spheres, fmt::format("run {}, t = {:.6g} s", fill->folder, frame.time), {});
      }
  }

  void pack() {
    for (std::size_t i = 0; i < groups().size(); ++i) {
      const auto* fill = std::get_if<scene::PackingFill>(&groups()[i].fill);
      if (fill == nullptr) continue;
      const std::vector<particles::NamedParticles> read = particles_in(file_);
      try {
        particles::Placement placement =
            particles::place(given_, i, file_.meshes, particles::make_fixed(known_, read),
                             particles::make_fill(known_, read), 0);
        const scene::ParticleFile spheres{std::move(placement.position), std::move(placement.radius), {}, {}};
        expect_in_domain(spheres, *given_.dem, place_of(i),
                         "enlarge dem.domain, or give a level or mass that leaves the spheres in it");
        insert(i, spheres, "packing " + region_text(*fill), placement.void_fraction);
      } catch (const Error& error) {
        if (!error.where().starts_with("dem.")) throw;
        throw Error(error.code(), error.problem(), file_.origin + ": " + error.where(), error.hint());
      }
    }
  }

  void settle(const SettleOn& on) {
    const scene::Settle& wanted = *given_.dem->settle;
    write_text();
    const SettleCache cache;
    const SettleKey key = key_of(file_, wanted);
    std::optional<CachedBed> bed = cache.find(key, file_.log);
    if (bed) {
      const std::string problem = problem_of(*bed, given_, particles::make_fill(known_, particles_in(file_)));
      if (!problem.empty()) {
        file_.log.push_back("a settled bed in the cache is not used, and is made anew: " + problem);
        bed.reset();
      }
    }
    const bool from_cache = bed.has_value();
    if (!bed) {
      pack();
      write_text();
      bed = CachedBed{launch::settle(file_, wanted, on), file_.placed};
      cache.keep(key, *bed, file_.log);
    }
    file_.placed = bed->placed;
    for (std::size_t g = 0; g < bed->settled.groups.size(); ++g)
      take(bed->settled.groups[g], bed->settled.spheres[g]);
    json_["dem"].erase("start_overlap");  // has been done before the bed settled
    file_.settled = SettledBed{bed->settled.time, bed->settled.kinetic_energy, from_cache};
    file_.log.push_back(fmt::format("the bed settled in {:.4g} s to a mean kinetic energy of {:.4g} J{}",
                                    bed->settled.time, bed->settled.kinetic_energy,
                                    from_cache ? ", taken from the cache" : ""));
  }

  void finish() {
    json_["dem"].erase("settle");
    write_text();
    file_.scene = scene::parse(file_.text, file_.origin);
  }

 private:
  const std::vector<scene::ParticleGroup>& groups() const { return given_.dem->particles; }
  std::string place_of(std::size_t i) const {
    return file_.origin + ": " + scene::element("dem.particles", i) + ".fill";
  }
  void write_text() { file_.text = json_.dump(2); }

  void insert(std::size_t i, const scene::ParticleFile& spheres, const std::string& from,
              std::optional<double> void_fraction) {
    const scene::ParticleGroup& group = groups()[i];
    PlacedGroup placed;
    placed.from = from;
    placed.void_fraction = void_fraction;
    placed.group = group.name;
    placed.spheres = spheres.positions.size();
    placed.smallest = *std::ranges::min_element(spheres.radii);
    placed.largest = *std::ranges::max_element(spheres.radii);
    placed.mass = given_.dem->materials[group.material.value].density * scene::volume_of(spheres.radii);
    file_.placed.push_back(std::move(placed));
    replace(i, spheres);
  }

  // A settled bed has the spheres of all groups that move, also of lattices and files.
  void take(const std::string& group, const scene::ParticleFile& spheres) {
    const auto index = static_cast<std::size_t>(
        std::ranges::find(groups(), group, &scene::ParticleGroup::name) - groups().begin());
    const bool listed = std::ranges::find(file_.placed, group, &PlacedGroup::group) != file_.placed.end();
    if (listed)
      replace(index, spheres);
    else
      insert(index, spheres,
             std::holds_alternative<scene::LatticeFill>(groups()[index].fill) ? "lattice" : "file", {});
  }

  void replace(std::size_t i, const scene::ParticleFile& spheres) {
    const std::string& name = groups()[i].name;
    std::erase_if(file_.files, [&](const protocol::NamedText& text) { return text.name == name; });
    file_.files.push_back({name, scene::particle_file_text(spheres)});
    auto& entry = json_["dem"]["particles"][i];
    entry["fill"] = {{"type", "file"}, {"file", name}};
    for (const char* key : {"radius", "sizes"}) entry.erase(key);
    if (!spheres.velocities.empty()) entry.erase("velocity");
    scene::ParticleGroup& group = known_.dem->particles[i];
    group.fill = scene::FileFill{name};
    group.radius_min = group.radius_max = 0;
  }

  const std::filesystem::path& folder_;
  SceneFile& file_;
  const scene::Scene given_;
  Json json_;
  scene::Scene known_;  // without the groups that are still to be placed
};

}  // namespace

void place_fills(const std::filesystem::path& folder, SceneFile& file, const SettleOn& on) {
  if (!file.scene.dem) return;
  const bool settles = file.scene.dem->settle.has_value();
  if (!settles && std::ranges::none_of(file.scene.dem->particles, is_placed)) return;
  Placing placing(folder, file);
  placing.take_frames_of_runs();
  if (settles && on.settles)
    placing.settle(on);
  else
    placing.pack();
  placing.finish();
}

}  // namespace tandem::launch

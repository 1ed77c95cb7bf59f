#include "launch/coordinator/placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/scene/fault.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/particle_file.hpp"
#include "common/scene/sizes.hpp"
#include "dem_server/io/place.hpp"
#include "launch/coordinator/run_frame.hpp"

namespace tandem::launch {
namespace {

bool is_placed(const scene::ParticleGroup& group) {
  return std::holds_alternative<scene::PackingFill>(group.fill) ||
         std::holds_alternative<scene::RunFill>(group.fill);
}

std::string region_text(const scene::PackingFill& fill) {
  if (const auto* inside = std::get_if<scene::InsideWall>(&fill.region)) return "inside " + inside->wall;
  if (const auto* above = std::get_if<scene::AboveWall>(&fill.region)) return "above " + above->wall;
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

}  // namespace

void place_fills(const std::filesystem::path& folder, SceneFile& file) {
  if (!file.scene.dem || std::ranges::none_of(file.scene.dem->particles, is_placed)) return;
  const scene::Scene given = file.scene;
  const auto place_of = [&](std::size_t i) {
    return file.origin + ": " + scene::element("dem.particles", i) + ".fill";
  };
  auto json = nlohmann::ordered_json::parse(file.text);
  // The scene without the groups that are still to be placed: inlets stand for them.
  scene::Scene known = given;
  for (scene::ParticleGroup& group : known.dem->particles)
    if (is_placed(group)) group.fill = scene::InletFill{};
  const auto insert = [&](std::size_t i, const scene::ParticleFile& spheres, const std::string& from,
                          std::optional<double> void_fraction) {
    const scene::ParticleGroup& group = given.dem->particles[i];
    PlacedGroup placed;
    placed.from = from;
    placed.void_fraction = void_fraction;
    placed.group = group.name;
    placed.spheres = spheres.positions.size();
    placed.smallest = *std::ranges::min_element(spheres.radii);
    placed.largest = *std::ranges::max_element(spheres.radii);
    placed.mass = given.dem->materials[group.material.value].density * scene::volume_of(spheres.radii);
    file.placed.push_back(std::move(placed));
    file.files.push_back({group.name, scene::particle_file_text(spheres)});
    auto& entry = json["dem"]["particles"][i];
    entry["fill"] = {{"type", "file"}, {"file", group.name}};
    entry.erase("radius");
    entry.erase("sizes");
    known.dem->particles[i].fill = scene::FileFill{group.name};
    known.dem->particles[i].radius_min = known.dem->particles[i].radius_max = 0;
  };
  for (std::size_t i = 0; i < given.dem->particles.size(); ++i)
    if (const auto* fill = std::get_if<scene::RunFill>(&given.dem->particles[i].fill)) {
      const RunFrame frame =
          read_run_frame(scene::resolve_file(fill->folder, folder), fill->time, place_of(i));
      expect_in_domain(frame.spheres, *given.dem, place_of(i), "enlarge dem.domain");
      insert(i, frame.spheres, fmt::format("run {}, t = {:.6g} s", fill->folder, frame.time), {});
    }
  for (std::size_t i = 0; i < given.dem->particles.size(); ++i) {
    const auto* fill = std::get_if<scene::PackingFill>(&given.dem->particles[i].fill);
    if (fill == nullptr) continue;
    std::vector<dem::NamedParticles> read;
    for (const protocol::NamedText& text : file.files)
      read.push_back({text.name, scene::read_particle_file(text.text, text.name)});
    try {
      dem::Placement placement =
          dem::place(given, i, file.meshes, dem::make_fixed(known, read), dem::make_fill(known, read), 0);
      const scene::ParticleFile spheres{std::move(placement.position), std::move(placement.radius), {}, {}};
      expect_in_domain(spheres, *given.dem, place_of(i),
                       "enlarge dem.domain, or give a level or mass that leaves the spheres in it");
      insert(i, spheres, "packing " + region_text(*fill), placement.void_fraction);
    } catch (const Error& error) {
      if (!error.where().starts_with("dem.")) throw;
      throw Error(error.code(), error.problem(), file.origin + ": " + error.where(), error.hint());
    }
  }
  file.text = json.dump(2);
  file.scene = scene::parse(file.text, file.origin);
}

}  // namespace tandem::launch

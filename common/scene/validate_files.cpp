#include "common/input_file.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/particle_file.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/scene/validate_parts.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

void require_file(const std::filesystem::path& file, std::uint64_t largest, const std::string& what,
                  const std::string& origin, const std::string& path) {
  try {
    expect_input(file, {.largest = largest, .hint = "relative names start at the folder of the scene"});
  } catch (const Error& error) {
    fail(origin, path, "the file of " + what + " " + error.problem() + ": " + error.where(), error.hint());
  }
}

void validate_particles(const Dem& dem, std::size_t index, const std::filesystem::path& file,
                        const std::string& origin) {
  const ParticleGroup& group = dem.particles[index];
  const std::string path = element("dem.particles", index);
  const ParticleFile particles =
      read_particle_file(read_input(file, {.largest = largest_particle_file}), file.string());
  const bool given = group.radius_min > 0;
  if (given && !particles.radii.empty())
    fail(origin, path + ".radius", "the radius is given here and in " + file.string(), "keep one of them");
  if (!given && particles.radii.empty())
    fail(origin, path, "neither the group nor " + file.string() + " gives a radius", "add radius [m]");
  if (norm(group.velocity) > 0 && !particles.velocities.empty())
    fail(origin, path + ".velocity", "the velocity is given here and in " + file.string(),
         "keep one of them");
  if (group.fixed && !(particles.velocities.empty() && particles.spins.empty()))
    fail(origin, path + ".fixed",
         "the spheres of a fixed group never move, and " + file.string() + " gives velocities",
         "leave out its columns vx,vy,vz and wx,wy,wz, or fixed");
  if (group.fixed) return;  // walls may be anywhere

  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3d p = particles.positions[i];
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] < dem.domain.min[axis] || p[axis] > dem.domain.max[axis])
        fail(file.string(), "sphere " + std::to_string(i + 1),
             "the position " + text(p) + " is outside the domain", "enlarge dem.domain of " + origin);
  }
}

}  // namespace

std::filesystem::path resolve_file(const std::string& file, const std::filesystem::path& folder) {
  return folder / file;  // an absolute `file` replaces the folder
}

void validate_files(const Scene& scene, const std::string& origin, const std::filesystem::path& folder) {
  const auto require_mesh = [&](const Shape& shape) {
    if (const std::string& file = file_of(shape.geometry); !file.empty())
      require_file(resolve_file(file, folder), largest_mesh,
                   (shape.use == ShapeUse::wall ? "wall '" : "shape '") + shape.name + "'", origin,
                   shape.path + ".shape.file");
  };
  for (const Shape& shape : scene.shapes) require_mesh(shape);
  if (scene.contact)
    for (const Shape& shape : scene.contact->ground) require_mesh(shape);
  if (!scene.dem) return;
  const Dem& dem = *scene.dem;
  for (std::size_t i = 0; i < dem.particles.size(); ++i)
    if (const auto* fill = std::get_if<FileFill>(&dem.particles[i].fill)) {
      const std::filesystem::path file = resolve_file(fill->file, folder);
      require_file(file, largest_particle_file, "group '" + dem.particles[i].name + "'", origin,
                   element("dem.particles", i) + ".fill.file");
      validate_particles(dem, i, file, origin);
    }
}

}  // namespace tandem::scene

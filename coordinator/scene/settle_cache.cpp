#include "coordinator/scene/settle_cache.hpp"

#include <fmt/format.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

std::uint64_t number_in(const StateReader& file, const std::string& name) {
  std::uint64_t number = 0;
  file.read(name, number);
  return number;
}
double value_in(const StateReader& file, const std::string& name) {
  double value = 0;
  file.read(name, value);
  return value;
}

std::string part(std::size_t group, const std::string& name) {
  return fmt::format("group_{}/{}", group, name);
}

void write(StateWriter& file, const CachedBed& bed) {
  file.write("time", bed.settled.time);
  file.write("kinetic_energy", bed.settled.kinetic_energy);
  file.write("groups", std::uint64_t{bed.settled.groups.size()});
  for (std::size_t g = 0; g < bed.settled.groups.size(); ++g) {
    const scene::ParticleFile& spheres = bed.settled.spheres[g];
    file.write(part(g, "name"), bed.settled.groups[g]);
    file.write(part(g, "position"), numbers(spheres.positions));
    file.write(part(g, "velocity"), numbers(spheres.velocities));
    file.write(part(g, "spin"), numbers(spheres.spins));
    file.write(part(g, "radius"), std::span(spheres.radii));
  }
  file.write("placed", std::uint64_t{bed.placed.size()});
  for (std::size_t g = 0; g < bed.placed.size(); ++g) {
    const PlacedGroup& placed = bed.placed[g];
    file.write(part(g, "placed"), placed.group);
    file.write(part(g, "from"), placed.from);
    file.write(part(g, "spheres"), placed.spheres);
    const double values[] = {placed.smallest, placed.largest, placed.mass, placed.void_fraction.value_or(-1)};
    file.write(part(g, "values"), std::span(values));
  }
}

CachedBed bed_in(const StateReader& file) {
  CachedBed bed;
  bed.settled.time = value_in(file, "time");
  bed.settled.kinetic_energy = value_in(file, "kinetic_energy");
  for (std::size_t g = 0, groups = number_in(file, "groups"); g < groups; ++g) {
    bed.settled.groups.push_back(file.text(part(g, "name")));
    scene::ParticleFile& spheres = bed.settled.spheres.emplace_back();
    spheres.positions = rows_in(file, part(g, "position"));
    spheres.velocities = rows_in(file, part(g, "velocity"));
    spheres.spins = rows_in(file, part(g, "spin"));
    spheres.radii.resize(file.size(part(g, "radius")));
    file.read(part(g, "radius"), std::span(spheres.radii));
    const std::size_t number = spheres.radii.size();
    if (number == 0 || spheres.positions.size() != number || spheres.velocities.size() != number ||
        spheres.spins.size() != number)
      throw Error(ErrorCode::resource, "is damaged: its lists differ in length", file.path().string());
  }
  for (std::size_t g = 0, groups = number_in(file, "placed"); g < groups; ++g) {
    PlacedGroup& placed = bed.placed.emplace_back();
    placed.group = file.text(part(g, "placed"));
    placed.from = file.text(part(g, "from"));
    placed.spheres = number_in(file, part(g, "spheres"));
    double values[4];
    file.read(part(g, "values"), std::span(values));
    placed.smallest = values[0], placed.largest = values[1], placed.mass = values[2];
    if (values[3] >= 0) placed.void_fraction = values[3];
  }
  return bed;
}

std::uint64_t size_of(const SettleKey& key, const CachedBed& bed) {
  std::uint64_t bytes = 65536 + key.text.size();
  for (const scene::ParticleFile& spheres : bed.settled.spheres) bytes += 80 * spheres.radii.size();
  return bytes;
}

StartCache::Entry entry_of(const SettleKey& key) {
  return {"settled bed", "settled_", key.text};
}

template <class T>
std::string digest_of(const T& values) {
  return digest_text(std::as_bytes(std::span(values)));
}

}  // namespace

std::string SettleKey::name() const {
  return entry_of(*this).name();
}

SettleKey key_of(const SceneFile& file, const scene::Settle& settle) {
  SettleKey key;
  key.text = fmt::format("program {:016x}\nkinetic_energy {} at_most {}\n", file_digest("/proc/self/exe"),
                         settle.kinetic_energy, settle.at_most);
  for (const protocol::NamedMesh& mesh : file.meshes)
    key.text += fmt::format("mesh {} {} {}\n", mesh.name, digest_of(mesh.mesh.vertices),
                            digest_of(mesh.mesh.triangles));
  for (const protocol::NamedText& text : file.files)
    key.text += fmt::format("file {} {}\n", text.name, digest_of(text.text));
  key.text += settling_scene(file.text);
  return key;
}

std::optional<CachedBed> SettleCache::find(const SettleKey& key, std::vector<std::string>& log) const {
  CachedBed bed;
  if (!files_.find(
          entry_of(key), [&](const StateReader& file) { bed = bed_in(file); }, log))
    return {};
  return bed;
}

void SettleCache::keep(const SettleKey& key, const CachedBed& bed, std::vector<std::string>& log) const {
  files_.keep(
      entry_of(key), size_of(key, bed), [&](StateWriter& file) { write(file, bed); }, log);
}

}  // namespace tandem::launch

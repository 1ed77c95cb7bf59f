// Tables of numbers: particle files, and the rows of a run that a study reads back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/particle_file.hpp"
#include "launch/study/signal_file.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace csv_part {

constexpr unsigned particles = 0, rows = 1, kinds = 2;

std::string written(const scene::ParticleFile& file) {
  std::string text = "x,y,z";
  if (!file.radii.empty()) text += ",radius";
  if (!file.velocities.empty()) text += ",vx,vy,vz";
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    text += fmt::format("\n{},{},{}", file.positions[i].x, file.positions[i].y, file.positions[i].z);
    if (!file.radii.empty()) text += fmt::format(",{}", file.radii[i]);
    if (!file.velocities.empty())
      text += fmt::format(",{},{},{}", file.velocities[i].x, file.velocities[i].y, file.velocities[i].z);
  }
  return text;
}

bool all_finite(const std::vector<Vec3d>& vectors) {
  return std::ranges::all_of(vectors, [](Vec3d v) { return is_finite(v); });
}

class CsvTarget : public Target {
 public:
  explicit CsvTarget(const std::filesystem::path& folder) : folder_(folder) {}

  void run(std::span<const std::byte> input) override {
    if (chosen(input, kinds) == particles)
      read_particles(std::string(text_of(input)));
    else
      read_rows(input);
  }

 private:
  static void read_particles(const std::string& text) {
    const scene::ParticleFile file = scene::read_particle_file(text, "stones.csv");
    const std::size_t n = file.positions.size();
    expect(n > 0 && all_finite(file.positions) && all_finite(file.velocities),
           "positions or velocities are not finite");
    expect(file.radii.empty() || file.radii.size() == n, "there are not as many radii as spheres");
    expect(file.velocities.empty() || file.velocities.size() == n,
           "there are not as many velocities as spheres");
    expect(std::ranges::all_of(file.radii, [](double r) { return r > 0 && std::isfinite(r); }),
           "a radius is none");
    const scene::ParticleFile again = scene::read_particle_file(written(file), "again");
    expect(
        again.positions == file.positions && again.radii == file.radii && again.velocities == file.velocities,
        "particles that are written and read again are others");
  }
  void read_rows(std::span<const std::byte> input) const {
    put(folder_ / "bodies.csv", input);
    const launch::SignalSet set = launch::read_signals(folder_, {"arm.x", "arm.vx"});
    for (const auto& [name, values] : set.column)
      expect(values.size() == set.time.size(), "a signal has not one value for each time");
  }

  std::filesystem::path folder_;
};

std::vector<Bytes> tables(const std::filesystem::path&) {
  std::vector<Bytes> corpus;
  for (const char* text : {"x,y,z\n0.1,0.2,0.3\n", "x,y,z,radius\r\n0.1,0.2,0.3,0.01\r\n-1e-3,2,3.5,0.02\r\n",
                           "\xEF\xBB\xBFx, y, z, vx, vy, vz\n1,2,3,4,5,6\n\n7,8,9,10,11,12",
                           "vz,vy,vx,radius,z,y,x\n1,2,3,0.25,5,6,7\n1,2,3,0.5,5,6,8\n"})
    corpus.push_back(choice(particles, bytes_of(text)));
  corpus.push_back(
      choice(rows, bytes_of("time,arm.x,arm.y,arm.vx\n0,1,2,3\n0.1,1.5,2.5,3.5\n0.2,-1e-9,2,3\n")));
  return corpus;
}

}  // namespace csv_part

TargetKind csv_target() {
  using namespace csv_part;
  return {.name = "csv", .text = true, .corpus = tables, .make = make_target<CsvTarget>};
}

}  // namespace tandem::fuzz

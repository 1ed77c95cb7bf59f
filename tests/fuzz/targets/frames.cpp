// The HDF5 files of a run, from which its picture is drawn. They have no digest, so that they may contain
// anything.
#include "coordinator/report/frame.hpp"

#include <algorithm>
#include <cmath>

#include "coordinator/results/results.hpp"
#include "coordinator/results/series/hdf5.hpp"
#include "tests/fuzz/arrays.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace frames_part {

namespace fs = std::filesystem;

constexpr const char* files[] = {"frames/particles_000001.h5", "frames/bodies_000001.h5",
                                 "frames/surfaces.h5"};

void write(const fs::path& path, const std::vector<Array>& arrays) {
  launch::Hdf5File file = launch::Hdf5File::create(path);
  for (const auto& [name, number, values] : arrays) {
    const auto as = [&]<class T>(T first) {
      std::vector<T> copy(values.size() / sizeof first);
      const auto whole = std::span(values).first(copy.size() * sizeof first);
      std::ranges::copy(whole, std::as_writable_bytes(std::span(copy)).begin());
      file.write("/" + name, std::span<const T>(copy));
    };
    if (number == Number::float64)
      as(double{});
    else if (number == Number::float32)
      as(float{});
    else if (number == Number::int32)
      as(std::int32_t{});
    else
      as(std::uint32_t{});
  }
  file.set_attribute("/", "time", 0.0);
  file.commit();
}

// A box on the ground, a wheel that moves, five spheres, two frames.
void write_run(const fs::path& folder) {
  scene::Scene scene;
  scene.mbd.emplace();
  scene.mbd->bodies = {
      {.name = "wheel", .mass = 2, .inertia = {1, 1, 1, 0, 0, 0}, .pose = {{0, 0, 1}, {}}, .twist = {}}};
  scene.dem.emplace();
  scene.dem->domain = {{-1, -1, 0}, {1, 1, 2}};
  scene.dem->walls = {{.name = "rim",
                       .body = {0},
                       .material = {},
                       .pose = {},
                       .shape = scene::CylinderShape{0.5, 0.2, 6, {}},
                       .surface_velocity = {}},
                      {.name = "bin",
                       .body = ground,
                       .material = {},
                       .pose = {},
                       .shape = scene::BoxShape{{1, 1, 1}, {"+z"}},
                       .surface_velocity = {}}};
  launch::Results results(folder, scene, {});
  for (const std::int64_t time : {0, 1'000'000}) {
    protocol::BodiesFrame bodies;
    bodies.time = {time};
    bodies.bodies = {{0, 0, {{0, 0, 1}, {}}, {}}};
    protocol::ParticlesFrame particles;
    particles.time = {time};
    for (std::uint32_t id = 0; id < 5; ++id) {
      particles.id.push_back(id);
      particles.position.insert(particles.position.end(), {.1 * id, 0, 1});
      particles.velocity.insert(particles.velocity.end(), {1, 2, 3});
      particles.spin.insert(particles.spin.end(), {0, 0, 1});
      particles.radius.push_back(.05f);
    }
    results.write_frame({time}, &bodies, &particles);
  }
  results.finish();
}

class FramesTarget : public Target {
 public:
  explicit FramesTarget(const fs::path& folder) : folder_(folder) {
    write_run(folder_);
    for (const char* file : files) whole_.push_back(get(folder_ / file));
  }

  void run(std::span<const std::byte> input) override {
    const unsigned which = chosen(input, std::size(files));
    write(folder_ / files[which], unpacked(input));
    try {
      check(launch::read_last_frame(folder_));
    } catch (...) {
      put(folder_ / files[which], whole_[which]);
      throw;
    }
    put(folder_ / files[which], whole_[which]);
  }

 private:
  // The contents of a picture.
  static void check(const launch::Frame& frame) {
    const std::size_t spheres = frame.radius.size();
    for (const double number : frame.position) expect(std::isfinite(number), "a position is no number");
    expect(frame.position.size() == 3 * spheres && frame.value.size() == spheres,
           "spheres lack a position or a speed");
    for (const launch::Surface& surface : frame.surfaces)
      for (const auto& triangle : surface.mesh.triangles)
        for (const std::uint32_t corner : triangle)
          expect(corner < surface.mesh.vertices.size(), "a triangle has a corner that is not there");
  }

  fs::path folder_;
  std::vector<Bytes> whole_;
};

std::vector<Bytes> run_files(const fs::path& folder) {
  write_run(folder);
  std::vector<Bytes> corpus;
  for (unsigned i = 0; i < std::size(files); ++i)
    corpus.push_back(choice(i, packed(arrays_of(folder / files[i]))));
  return corpus;
}

}  // namespace frames_part

TargetKind frames_target() {
  using namespace frames_part;
  return {.name = "frames", .corpus = run_files, .make = make_target<FramesTarget>};
}

}  // namespace tandem::fuzz

#include "coordinator/report/liquid_surface.hpp"

#include <algorithm>

#include "common/log.hpp"
#include "coordinator/report/data_folder.hpp"
#include "coordinator/report/tool.hpp"
#include "coordinator/results/series/hdf5.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// A file that goes with the scope.
struct Draft {
  explicit Draft(fs::path name) : path(std::move(name)) {}
  ~Draft() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  fs::path path;
};

std::vector<Vec3d> vectors(const std::vector<double>& numbers) {
  std::vector<Vec3d> result;
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
    result.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return result;
}

}  // namespace

Frame with_liquid_surface(Frame frame, const fs::path& folder) {
  if (frame.liquid == 0) return frame;
  const std::size_t first = frame.radius.size() - frame.liquid;
  const Draft particles(folder / "liquid_particles.h5"), surface(folder / "liquid_surface.h5");
  {
    Hdf5File file = Hdf5File::create(particles.path);
    file.write("/position", std::span(frame.position).subspan(3 * first), 3);
    file.write("/value", std::span(frame.value).subspan(first));
    const double spacing = 2 * *std::ranges::max_element(std::span(frame.radius).subspan(first));
    file.write("/spacing", std::span(&spacing, 1));
    file.commit();
  }
  // Debian's Python, for which the package list installs scikit-image.
  if (!run_tool({.program = "/usr/bin/python3",
                 .package = "python3 python3-skimage",
                 .arguments = {(data_folder() / "liquid_surface.py").string(),
                               particles.path.filename().string(), surface.path.filename().string()},
                 .folder = folder,
                 .log = fs::absolute(folder / "liquid_surface.log"),
                 .patience = std::chrono::seconds(300)})) {
    log::warn("the liquid is drawn as spheres; its surface needs the Debian package python3-skimage");
    return frame;
  }
  const Hdf5File file = Hdf5File::open(surface.path);
  LiquidSurface& found = frame.liquid_surface.emplace();
  found.mesh.vertices = vectors(file.read_doubles("/vertices"));
  found.normals = vectors(file.read_doubles("/normals"));
  found.value = file.read_doubles("/value");
  const std::vector<std::uint32_t> corners = file.read_indices("/triangles"),
                                   drops = file.read_indices("/drops");
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    found.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  std::size_t kept = first;
  for (const std::uint32_t drop : drops) {  // ascending
    const std::size_t i = first + drop;
    std::copy_n(frame.position.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                frame.position.begin() + static_cast<std::ptrdiff_t>(3 * kept));
    frame.radius[kept] = frame.radius[i];
    frame.value[kept] = frame.value[i];
    ++kept;
  }
  frame.position.resize(3 * kept);
  frame.radius.resize(kept);
  frame.value.resize(kept);
  frame.liquid = drops.size();
  return frame;
}

}  // namespace tandem::launch

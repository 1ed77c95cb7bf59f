#include "coordinator/scene/run_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/results/series/hdf5.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/run_folder/run_state.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> frames_in(const fs::path& folder) {
  std::vector<fs::path> frames;
  std::error_code failure;
  for (fs::directory_iterator at(folder / "frames", failure), end; !failure && at != end;
       at.increment(failure)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with("particles_") && name.ends_with(".h5")) frames.push_back(at->path());
  }
  // Numbers grow by a digit after 999999 frames.
  std::ranges::sort(frames, [](const fs::path& a, const fs::path& b) {
    const std::string x = a.string(), y = b.string();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  return frames;
}

// Times closer than this are one [s]: those of frames are whole nanoseconds.
constexpr double same_time = 0.5e-9;

std::vector<Vec3d> rows_of(const std::vector<double>& values) {
  std::vector<Vec3d> rows;
  for (std::size_t k = 0; k + 2 < values.size(); k += 3)
    rows.push_back({values[k], values[k + 1], values[k + 2]});
  return rows;
}

}  // namespace

RunFrame read_run_frame(const fs::path& folder, std::optional<double> time, const std::string& where) {
  const auto refuse = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorCode::scene, problem, where, hint);
  };
  const std::vector<fs::path> frames = frames_in(folder);
  if (frames.empty())
    refuse("the folder " + printable(folder.string()) + " has no frames of particles",
           "give the folder of a run, relative to that of the scene");
  // The last frame of a run is that of its end: without a time nothing else is taken for it.
  const double end = read_run(folder).summary.value("simulated_s", 0.0);
  std::optional<Hdf5File> file;
  RunFrame frame;
  double last = 0, nearest = INFINITY;
  for (auto path = frames.rbegin(); path != frames.rend() && !file; ++path) {
    Hdf5File candidate = Hdf5File::open(*path);
    frame.time = candidate.number_attribute("/", "time");
    if (path == frames.rbegin()) last = frame.time;
    if (!time && end - frame.time > 1e-6 * end)
      refuse(fmt::format("the last frame of that run is at {:.9g} s, and the run went on to {:.9g} s",
                         frame.time, end),
             "give \"time\": that of the frame to start from");
    if (!time || std::abs(frame.time - *time) < same_time)
      file.emplace(std::move(candidate));
    else if (!(std::abs(nearest - *time) < std::abs(frame.time - *time)))
      nearest = frame.time;
  }
  if (!file)
    refuse(fmt::format("that run has no frame at {:.9g} s", time.value_or(0)),
           fmt::format("the nearest of its {} frames is at {:.9g} s, and the last one at {:.9g} s",
                       frames.size(), nearest, last));
  frame.read = {file->path()};
  std::error_code unknown;
  if (fs::exists(folder / summary_name, unknown)) frame.read.push_back(folder / summary_name);
  frame.spheres.positions = rows_of(file->read_doubles("/position"));
  frame.spheres.velocities = rows_of(file->read_doubles("/velocity"));
  frame.spheres.spins = rows_of(file->read_doubles("/spin"));
  frame.spheres.radii = file->read_doubles("/radius");
  const std::size_t spheres = frame.spheres.positions.size();
  if (spheres == 0)
    refuse(fmt::format("the frame at {:.9g} s has no sphere", frame.time), "give another time");
  bool whole = frame.spheres.velocities.size() == spheres && frame.spheres.spins.size() == spheres &&
               frame.spheres.radii.size() == spheres;
  for (std::size_t i = 0; whole && i < spheres; ++i)
    whole = is_finite(frame.spheres.positions[i]) && is_finite(frame.spheres.velocities[i]) &&
            is_finite(frame.spheres.spins[i]) && std::isfinite(frame.spheres.radii[i]) &&
            frame.spheres.radii[i] > 0;
  if (!whole)
    refuse("the frame " + printable(file->path().string()) +
               " has lists of different lengths, or values that are no numbers",
           "give a frame that tandem has written");
  return frame;
}

}  // namespace tandem::launch

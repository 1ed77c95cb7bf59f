#include "coordinator/report/movie.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "coordinator/report/camera.hpp"
#include "coordinator/report/liquid_surface.hpp"
#include "coordinator/report/own_picture.hpp"
#include "coordinator/report/tool.hpp"
#include "coordinator/run_folder/own_files.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

constexpr int least_pixels = 64, most_pixels = 7680;

// Whether a shell would find the program.
bool is_there(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "/usr/bin:/bin";
  rest += ':';
  for (std::size_t end = rest.find(':'); end != std::string::npos;) {
    const std::string folder = rest.substr(0, end);
    if (access((fs::path(folder.empty() ? "." : folder) / program).c_str(), X_OK) == 0) return true;
    rest.erase(0, end + 1);
    end = rest.find(':');
  }
  return false;
}

void expect_tools() {
  for (const char* program : {"povray", "ffmpeg"})
    if (!is_there(program))
      throw Error(ErrorCode::resource, fmt::format("the program {} is not there", program), "tandem movie",
                  fmt::format("apt-get install {}", program));
}

// The pictures before they are a film; they go in any case.
class Stills {
 public:
  explicit Stills(const fs::path& run) : folder_(run / stills_folder) {
    std::error_code failure;
    if (fs::is_symlink(folder_, failure))
      throw Error(ErrorCode::usage, "is a link: the pictures would go elsewhere", folder_.string(),
                  "remove it");
    remove();
    fs::create_directories(folder_, failure);
    if (failure)
      throw Error(ErrorCode::resource, "cannot be made: " + failure.message(), folder_.string(),
                  "tandem movie needs the right to write in the folder of the run");
  }
  ~Stills() { remove(); }
  Stills(const Stills&) = delete;
  Stills& operator=(const Stills&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  // Files of other names stay, and their folder.
  void remove() const {
    std::error_code failure, ignored;
    std::vector<fs::path> own;
    for (fs::directory_iterator at(folder_, failure); !failure && at != fs::directory_iterator();
         at.increment(failure))
      if (is_own_file(fs::path(stills_folder) / at->path().filename())) own.push_back(at->path());
    for (const fs::path& file : own) fs::remove(file, ignored);
    fs::remove(folder_, ignored);
  }

  fs::path folder_;
};

std::vector<std::string> names_of(const scene::Scene& scene, const ColourField& field) {
  std::vector<std::string> names;
  if (!scene.dem) return names;
  if (field.name == std::string_view("group"))
    for (const scene::ParticleGroup& group : scene.dem->particles) names.push_back(group.name);
  else
    for (const scene::Material& material : scene.dem->materials) names.push_back(material.name);
  return names;
}

// Camera, floor and colours that suit all frames.
View view_of_all(const fs::path& folder, const std::vector<std::string>& names, const scene::Scene& scene,
                 const ColourField& field, const PictureSize& size) {
  View view;
  view.up = upwards(scene);
  view.size = size;
  view.soft_shadows = false;
  Extents extents(view.up);
  ScaleRange range;
  bool has_spheres = false;
  for (const std::string& name : names) {
    const Frame frame = read_frame(folder, name, field);
    if (frame.radius.size() > most_spheres)
      throw Error(
          ErrorCode::usage, fmt::format("{} has {} spheres", name, frame.radius.size()), folder.string(),
          fmt::format("POV-Ray holds {} in memory: look at particles.xdmf in ParaView", most_spheres));
    has_spheres = has_spheres || !frame.radius.empty();
    extents.add(frame);
    range.add(frame.value);
  }
  if (extents.empty())
    throw Error(ErrorCode::usage, "the frames of this run show neither spheres nor bodies", folder.string(),
                "output.particles of the scene puts the spheres into them");
  view.camera = scene.output.camera.value_or(extents.camera(size.aspect()));
  view.floor = extents.lowest() - 1e-3 * norm(view.camera.target - view.camera.eye);
  if (field.scale == ColourField::Scale::whole)
    view.scale = range.whole(field.title());
  else
    view.scale = range.from_zero(field.title());
  if (field.scale == ColourField::Scale::named) view.scale.names = names_of(scene, field);
  return view;
}

}  // namespace

PictureSize parse_picture_size(const std::string& text) {
  PictureSize size;
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](int& value) {
    const auto [rest, failure] = std::from_chars(at, end, value);
    at = rest;
    return failure == std::errc() && value >= least_pixels && value <= most_pixels && value % 2 == 0;
  };
  const bool good = number(size.width) && at != end && *at++ == 'x' && number(size.height) && at == end;
  if (!good)
    throw Error(ErrorCode::usage, fmt::format("'{}' is no size of a film", text), "--size",
                fmt::format("write width and height in pixels, both even, from {} to {}: 1280x720",
                            least_pixels, most_pixels));
  return size;
}

std::filesystem::path make_movie(const fs::path& folder, const scene::Scene& scene,
                                 const MovieOptions& options) {
  if (!options.out.empty()) {
    if (options.out.extension() != ".mp4")
      throw Error(ErrorCode::usage, "'" + options.out.string() + "' is no name for a film", "--output",
                  "let it end with .mp4");
    expect_own_or_new(options.out);
  }
  expect_tools();
  const ColourField& field = colour_field(options.colour_by);
  const std::vector<std::string> names = frame_names(folder);
  if (names.size() < 2)
    throw Error(ErrorCode::usage, fmt::format("the run has {} frames, too few for a film", names.size()),
                folder.string(), "set output.frame_interval of the scene, and run it again");
  View view = view_of_all(folder, names, scene, field, options.size);
  if (names.size() == 2)
    log::warn("the run has its first and its last frame only: output.frame_interval of the scene gives more");

  const fs::path out = options.out.empty() ? folder / "movie.mp4" : options.out;
  const InterruptGuard guard;
  const auto expect_no_interrupt = [&] {
    if (interrupted()) throw Error(ErrorCode::interrupted, "the film was interrupted", out.string());
  };
  const Stills stills(folder);
  const auto begin = std::chrono::steady_clock::now();
  double first = 0, last = 0;  // [s]
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Frame frame = with_liquid_surface(read_frame(folder, names[i], field), stills.folder());
    (i == 0 ? first : last) = frame.time;
    view.title = fmt::format("{}   t = {:.4g} s", scene.name, frame.time);
    const std::string still = fmt::format("still_{:06}", i);
    const bool drawn = render(stills.folder(), still, frame, scene, view);
    expect_no_interrupt();
    if (!drawn)
      throw Error(ErrorCode::resource, "POV-Ray did not draw " + names[i], folder.string(),
                  "the warning before this says why");
    if (i == 0) {
      const double each = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      log::info("{} frames, about {:.2g} s each", names.size(), each);
    }
  }
  // Outside the run's folder a file with the draft's name belongs to somebody else.
  const fs::path draft = fs::absolute(
      options.out.empty() ? out.string() + ".part" : fmt::format("{}.{}.part", out.string(), getpid()));
  const bool done = run_tool({.program = "ffmpeg",
                              .package = "ffmpeg",
                              .arguments = {"-nostdin",    "-loglevel",
                                            "error",       "-y",
                                            "-framerate",  fmt::format("{:g}", options.frames_per_second),
                                            "-i",          "still_%06d.png",
                                            "-c:v",        "libx264",
                                            "-preset",     "medium",
                                            "-crf",        "18",
                                            "-pix_fmt",    "yuv420p",
                                            "-movflags",   "+faststart",
                                            "-metadata",   fmt::format("comment={}", own_mark),
                                            "-f",          "mp4",
                                            draft.string()},
                              .folder = stills.folder(),
                              .log = fs::absolute(folder / "movie.log"),
                              .patience = std::chrono::seconds(3600)});
  std::error_code failure;
  if (done) fs::rename(draft, out, failure);
  if (!done || failure) {
    std::error_code ignored;
    fs::remove(draft, ignored);
    expect_no_interrupt();
    throw Error(ErrorCode::resource,
                "the film could not be written" + (failure ? ": " + failure.message() : std::string()),
                out.string(), "the warning before this says why");
  }
  const double film = static_cast<double>(names.size()) / options.frames_per_second;
  log::info("{}: {} frames from t = {:.4g} s to {:.4g} s in {:.3g} s of film", out.string(), names.size(),
            first, last, film);
  return out;
}

}  // namespace tandem::launch

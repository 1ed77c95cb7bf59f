// The scene description for POV-Ray: spheres in the colours of a scale, bodies solid in their colours with
// edges, transparent where they hide many of the particles, above a pale ground that fades into the sky.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/report/colours.hpp"
#include "coordinator/report/frame.hpp"
#include "coordinator/report/overlay.hpp"
#include "coordinator/report/regions.hpp"

namespace tandem::launch {

inline constexpr std::size_t most_spheres = 5'000'000;  // POV-Ray takes about 1 kB for each

struct PictureSize {
  int width = 1280, height = 720;  // [pixels]
  double aspect() const { return static_cast<double>(width) / height; }
};

struct View {
  scene::Camera camera;
  Vec3d up{0, 0, 1};
  double floor = 0;  // height of the pale ground along `up` [m]
  PictureSize size;
  bool soft_shadows = true;  // they take half of the time
  std::string title;         // above the legend of the bodies
  ColourScale scale;         // of the spheres
};

// A point of the scene with a name beside it.
struct Label {
  Vec3d at;  // [m]
  std::string words;
  Vec3d colour;           // of the frame around the words
  bool is_point = false;  // with a dot at the point
};

struct PictureText {
  std::vector<Label> labels;
  std::vector<Region> regions = {};  // drawn as lines
  bool extents = false;              // the box around everything, with its lengths
};

void write_pov(std::ostream& out, const Frame& frame, const scene::Scene& scene, const View& view,
               const PictureText& more = {});

// Colours of the moving bodies, in the order of the scene.
std::vector<LegendEntry> body_legend(const scene::Scene& scene);

// Draws FOLDER/NAME.png from such a description; false after a warning.
bool render(const std::filesystem::path& folder, const std::string& name, const Frame& frame,
            const scene::Scene& scene, const View& view, const PictureText& more = {});

}  // namespace tandem::launch

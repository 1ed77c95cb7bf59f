// Text, boxes and lines in front of a picture of POV-Ray.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/report/colours.hpp"

namespace tandem::launch {

// A place on the picture: x to the right from the left edge, y upwards from the lower edge.
struct Spot {
  double x = 0, y = 0;
};

enum class Align { left, middle, right };

// Writes to `out` what a camera at `eye` sees in front of everything, in the units of the POV-Ray scene.
class Overlay {
 public:
  // `near`: distance of the overlay from the eye; `height`: of the picture in the units of spots.
  Overlay(std::ostream& out, Vec3d eye, Vec3d view, Vec3d up, double field_of_view, double aspect,
          double height, double near);

  double height() const { return height_; }
  double width() const { return height_ * aspect_; }
  // The spot of a point of the scene; absent behind the camera.
  std::optional<Spot> spot(Vec3d point) const;

  // `size` of the letters' em; `at` is on the base line.
  void text(Spot at, double size, const std::string& words, Align align = Align::left,
            Vec3d colour = {0.13, 0.15, 0.18});
  // `clearness` from 0 (opaque) to 1; boxes of a lower `layer` are behind others, text is in front of all.
  void box(Spot low, Spot high, Vec3d colour, double clearness = 0, int layer = 0);
  void line(Spot from, Spot to, Vec3d colour, double thickness);
  // The approximate width of a text.
  static double text_width(const std::string& words, double size);

 private:
  std::string placed() const;
  Vec3d local(Spot at, double depth) const;

  std::ostream& out_;
  Vec3d eye_, right_, top_, view_;
  double slope_, aspect_, height_, near_;
};

// A colour bar with title, unit and ticks, or a legend of names, in the lower right corner.
void draw_scale(Overlay& overlay, const ColourScale& scale);

struct LegendEntry {
  std::string name;
  Vec3d colour;
};
// In the upper left corner, below `title`.
void draw_legend(Overlay& overlay, const std::string& title, const std::vector<LegendEntry>& entries);

}  // namespace tandem::launch

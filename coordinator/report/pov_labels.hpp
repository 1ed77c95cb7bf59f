// Words in a picture: the lengths of the box around everything, and names beside what they name.
#pragma once

#include "coordinator/report/overlay.hpp"
#include "coordinator/report/pov_writer.hpp"

namespace tandem::launch {

// A part of the picture.
struct Rectangle {
  Spot low, high;
  bool meets(const Rectangle& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
  }
};

// The box around everything along the world's axes. One edge along each axis has its ends in numbers: that
// which is lowest in the picture, of vertical ones the leftmost.
// Returns what the numbers cover.
std::vector<Rectangle> draw_extents(PovWriter& pov, Overlay& overlay, const Frame& frame, Vec3d up);

// Words beside their points, each at the first of some places where it covers nothing that is taken.
void draw_labels(PovWriter& pov, Overlay& overlay, const std::vector<Label>& labels,
                 std::vector<Rectangle> taken);

}  // namespace tandem::launch

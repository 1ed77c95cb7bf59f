#include "coordinator/report/pov_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/bounds.hpp"
namespace tandem::launch {
namespace {

constexpr Vec3d ink{0.25, 0.28, 0.32};

}  // namespace

std::vector<Rectangle> draw_extents(PovWriter& pov, Overlay& overlay, const Frame& frame, Vec3d up) {
  Bounds box;
  std::vector<Rectangle> taken;
  for (const Surface& surface : frame.surfaces)
    for (const Vec3d& vertex : surface.mesh.vertices) box.add(vertex);
  for (std::size_t i = 0; i < frame.radius.size(); ++i) box.add(frame.centre(i), frame.radius[i]);
  for (int axis = 0; axis < 3; ++axis) {
    std::optional<Spot> best;
    for (int edge = 0; edge < 4; ++edge) {
      Vec3d a = box.low, b = box.low;
      const int second = (axis + 1) % 3, third = (axis + 2) % 3;
      a[second] = b[second] = edge & 1 ? box.high[second] : box.low[second];
      a[third] = b[third] = edge & 2 ? box.high[third] : box.low[third];
      b[axis] = box.high[axis];
      pov.rod(a, b, 6e-4 * pov.size(), {0.55, 0.58, 0.62});
      const std::optional<Spot> middle = overlay.spot(pov.local(0.5 * (a + b)));
      const bool vertical = std::abs(up[axis]) > 0.9;
      if (middle && (!best || (vertical ? middle->x < best->x : middle->y < best->y))) best = middle;
    }
    if (!best) continue;
    const std::string words =
        fmt::format("{}: {:.4g} to {:.4g} m", "xyz"[axis], box.low[axis] + 0.0, box.high[axis] + 0.0);
    const double half = 0.5 * Overlay::text_width(words, 14) + 4;
    const double left = std::abs(up[axis]) > 0.9 ? half + 6 : 0;  // of a vertical edge
    Spot at{std::clamp(best->x - left, half + 2, overlay.width() - half - 2),
            std::clamp(best->y - 20, 8.0, overlay.height() - 20)};
    const auto covered = [&] { return Rectangle{{at.x - half, at.y - 5}, {at.x + half, at.y + 14}}; };
    const auto meets_one = [&] {
      return std::ranges::any_of(taken, [&](const Rectangle& other) { return other.meets(covered()); });
    };
    while (meets_one() && at.y < overlay.height() - 40) at.y += 21;
    overlay.box(covered().low, covered().high, {1, 1, 1}, 0.35);
    overlay.text(at, 14, words, Align::middle, ink);
    taken.push_back(covered());
  }
  return taken;
}

void draw_labels(PovWriter& pov, Overlay& overlay, const std::vector<Label>& labels,
                 std::vector<Rectangle> taken) {
  constexpr double size = 14, height = 20;
  for (const Label& label : labels) {
    const std::optional<Spot> point = overlay.spot(pov.local(label.at));
    if (!point) continue;
    const double width = Overlay::text_width(label.words, size) + 12;
    Rectangle place;
    for (int attempt = 0; attempt < 60; ++attempt) {
      // To the right, then to the left, farther and farther up and down.
      const double side = attempt % 2 == 0 ? 16 : -16 - width;
      const int row = attempt / 2;
      const double shift = (row % 2 == 0 ? 1 : -1) * ((row + 1) / 2) * (height + 3) + 8;
      const double x = std::clamp(point->x + side, 2.0, std::max(2.0, overlay.width() - width - 2));
      const double y = std::clamp(point->y + shift, 2.0, overlay.height() - height - 2);
      place = {{x, y}, {x + width, y + height}};
      if (std::ranges::none_of(taken, [&](const Rectangle& other) { return place.meets(other); })) break;
    }
    taken.push_back(place);
    const double near_x = std::clamp(point->x, place.low.x, place.high.x),
                 near_y = std::clamp(point->y, place.low.y, place.high.y);
    overlay.line(*point, {near_x, near_y}, ink, 1.6);
    if (label.is_point) {
      overlay.box({point->x - 4, point->y - 4}, {point->x + 4, point->y + 4}, {1, 1, 1}, 0, 3);
      overlay.box({point->x - 3, point->y - 3}, {point->x + 3, point->y + 3}, label.colour, 0, 4);
    }
    overlay.box(place.low, place.high, label.colour, 0, 3);
    overlay.box({place.low.x + 1.5, place.low.y + 1.5}, {place.high.x - 1.5, place.high.y - 1.5}, {1, 1, 1},
                0, 4);
    overlay.text({place.low.x + 6, place.low.y + 5}, size, label.words);
  }
}

}  // namespace tandem::launch

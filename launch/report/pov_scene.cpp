#include "launch/report/pov_scene.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>

#include "common/log.hpp"
#include "launch/report/element_rods.hpp"
#include "launch/report/tool.hpp"
#include "launch/report/wireframe.hpp"
#include "launch/results/body_meshes.hpp"

namespace tandem::launch {
namespace {

// POV-Ray's tolerances are absolute: in its scene the eye is always this far from the target.
constexpr double eye_distance = 10;

// Transparency of the walls of the ground, and of its shapes of contact from their front.
constexpr double clear_wall = 0.88, clear_front = 0.1;
constexpr Vec3d ground_tint{0.72, 0.78, 0.84}, contact_ground_tint{0.62, 0.60, 0.56};

// Writes in the units of POV-Ray's scene, whose origin is the target.
class PovWriter {
 public:
  PovWriter(std::ostream& out, const View& view)
      : out_(out),
        view_(view),
        size_(norm(view.camera.target - view.camera.eye)),
        scale_(eye_distance / size_) {}

  double size() const { return size_; }  // of the picture [m]
  void stage();
  void spheres(const Frame& frame);
  void liquid(const LiquidSurface& surface);
  void surface(const Surface& surface, Vec3d tint, double clearness, double line);
  void ground(const Surface& surface, Vec3d tint, double line);
  void elements(const std::vector<Rod>& rods);
  void rod(Vec3d a, Vec3d b, double radius, Vec3d colour);
  Vec3d local(Vec3d p) const { return scale_ * (p - view_.camera.target); }

 private:
  static std::string vector(Vec3d v) { return fmt::format("<{:.7g},{:.7g},{:.7g}>", v.x, v.y, v.z); }
  std::string point(Vec3d p) const { return vector(local(p)); }
  void faces(const Surface& surface, const std::vector<std::array<std::uint32_t, 3>>& triangles, Vec3d tint,
             double clearness);
  void edges(const Surface& surface, Vec3d tint, double line);
  double length(double l) const { return scale_ * l; }
  // Few textures: POV-Ray keeps one for all objects that name it.
  static constexpr std::size_t shades = 64;
  // The one of a value, or its index in a list of names.
  std::size_t shade_of(double value) const {
    const ColourScale& scale = view_.scale;
    if (!scale.names.empty()) return static_cast<std::size_t>(std::max(value, 0.0));
    const double share = std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
    return static_cast<std::size_t>(share * (shades - 1) + 0.5);
  }

  std::ostream& out_;
  const View& view_;
  double size_, scale_;
};

void PovWriter::stage() {
  const Vec3d up = view_.up, along = view_.camera.target - view_.camera.eye;
  const Vec3d right = normalized(cross(along, up));
  const Vec3d ahead = cross(up, right);
  fmt::print(out_,
             "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 24 charset utf8 }}\n");
  // A negative width makes POV-Ray's space right-handed, like that of the scene.
  fmt::print(out_, "camera {{ location {} sky {} right -x*{}/{} angle {} look_at 0 }}\n",
             point(view_.camera.eye), vector(view_.camera.up), view_.size.width, view_.size.height,
             view_.camera.field_of_view);
  // The floor has the pale colour of the horizon at its far end; above it the sky becomes darker upwards.
  fmt::print(out_,
             "sky_sphere {{ pigment {{ gradient {0} color_map {{ [0.5 srgb <0.72,0.80,0.89>] [1 srgb "
             "<0.45,0.62,0.82>] "
             "}} scale 2 translate -{0} }} }}\n",
             vector(up));
  const Vec3d key = eye_distance * (0.9 * up - 0.75 * ahead - 0.55 * right);
  const std::string soft =
      view_.soft_shadows
          ? fmt::format(" area_light {}, {}, 4, 4 adaptive 0 jitter circular orient",
                        vector(0.25 * eye_distance * right), vector(0.25 * eye_distance * ahead))
          : "";
  fmt::print(out_, "light_source {{ {} srgb <1,0.985,0.96>*1.1{} }}\n", vector(key), soft);
  fmt::print(out_, "light_source {{ {} srgb <0.92,0.96,1>*0.42 shadowless }}\n",
             vector(eye_distance * (0.5 * up - 0.4 * ahead + 1.2 * right)));
  fmt::print(out_, "#declare grain = finish {{ ambient 0.2 diffuse 0.74 specular 0.22 roughness 0.03 }}\n");
  fmt::print(out_, "#declare water = finish {{ ambient 0.2 diffuse 0.7 specular 0.5 roughness 0.005 }}\n");
  fmt::print(out_, "#declare glass = finish {{ ambient 0.3 diffuse 0.68 specular 0.15 roughness 0.01 }}\n");
  const Vec3d centre = (length(view_.floor) - scale_ * dot(view_.camera.target, up)) * up;
  fmt::print(out_,
             "disc {{ {0}, {1}, {2:.6g} pigment {{ spherical color_map {{ [0 srgbt <0.955,0.962,0.970,1>] "
             "[0.75 srgbt <0.93,0.935,0.94,0>] }} scale {2:.6g} translate {0} }} finish {{ ambient 0.28 "
             "diffuse 0.62 }} }}\n",
             vector(centre), vector(up), 3.5 * eye_distance);
}

void PovWriter::spheres(const Frame& frame) {
  std::map<std::size_t, std::vector<std::size_t>> of_shade;
  for (std::size_t i = 0; i < frame.value.size(); ++i) of_shade[shade_of(frame.value[i])].push_back(i);
  const bool named = !view_.scale.names.empty();
  for (const auto& [shade, members] : of_shade) {
    const Vec3d colour = named ? group_colour(shade) : bar_colour(static_cast<double>(shade) / (shades - 1));
    fmt::print(out_, "#declare T = texture {{ pigment {{ srgb {} }} finish {{ grain }} }}\n", vector(colour));
    for (const std::size_t i : members) {
      const Vec3d p = local(frame.centre(i));
      fmt::print(out_, "sphere{{<{:.7g},{:.7g},{:.7g}>{:.7g} texture{{T}}}}\n", p.x, p.y, p.z,
                 length(frame.radius[i]));
    }
  }
}

// Colours change from vertex to vertex.
void PovWriter::liquid(const LiquidSurface& surface) {
  if (surface.mesh.triangles.empty()) return;
  out_ << "mesh2 { vertex_vectors { " << surface.mesh.vertices.size();
  for (const Vec3d& vertex : surface.mesh.vertices) out_ << ',' << point(vertex);
  out_ << " } normal_vectors { " << surface.normals.size();
  for (const Vec3d& normal : surface.normals) out_ << ',' << vector(normal);
  out_ << " } texture_list { " << shades;
  for (std::size_t k = 0; k < shades; ++k)
    fmt::print(out_, ", texture {{ pigment {{ srgb {} }} finish {{ water }} }}",
               vector(bar_colour(static_cast<double>(k) / (shades - 1))));
  out_ << " } face_indices { " << surface.mesh.triangles.size();
  for (const auto& [a, b, c] : surface.mesh.triangles)
    fmt::print(out_, ",<{},{},{}>,{},{},{}", a, b, c, shade_of(surface.value[a]), shade_of(surface.value[b]),
               shade_of(surface.value[c]));
  out_ << " } }\n";
}

void PovWriter::faces(const Surface& surface, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                      Vec3d tint, double clearness) {
  if (triangles.empty()) return;
  out_ << "mesh2 { vertex_vectors { " << surface.mesh.vertices.size();
  for (const Vec3d& vertex : surface.mesh.vertices) out_ << ',' << point(vertex);
  out_ << " } face_indices { " << triangles.size();
  for (const auto& [a, b, c] : triangles) fmt::print(out_, ",<{},{},{}>", a, b, c);
  fmt::print(out_, " }} pigment {{ srgbt <{:.3g},{:.3g},{:.3g},{:.3g}> }} finish {{ glass }}{} }}\n", tint.x,
             tint.y, tint.z, clearness, surface.fixed ? " no_shadow" : "");
}

void PovWriter::edges(const Surface& surface, Vec3d tint, double line) {
  out_ << "union {\n";
  for (const auto& [a, b] : feature_edges(surface.mesh)) {
    fmt::print(out_, "cylinder {{ {}, {}, {:.4g} }}\n", point(a), point(b), length(line));
  }
  // An empty union is an error.
  fmt::print(out_, "sphere {{ {}, {:.4g} }}\n", point(surface.mesh.vertices.front()), length(line));
  fmt::print(out_,
             "pigment {{ srgb <{:.3g},{:.3g},{:.3g}> }} finish {{ ambient 0.5 diffuse 0.4 }} no_shadow }}\n",
             0.45 * tint.x, 0.45 * tint.y, 0.45 * tint.z);
}

void PovWriter::surface(const Surface& surface, Vec3d tint, double clearness, double line) {
  faces(surface, surface.mesh.triangles, tint, clearness);
  edges(surface, tint, line);
}

// What bodies roll on is solid from its front, and clear from behind: a room of planes shows what is in it.
void PovWriter::ground(const Surface& surface, Vec3d tint, double line) {
  std::vector<std::array<std::uint32_t, 3>> front, back;
  for (const auto& triangle : surface.mesh.triangles) {
    const Vec3d a = surface.mesh.vertices[triangle[0]], b = surface.mesh.vertices[triangle[1]],
                c = surface.mesh.vertices[triangle[2]];
    (dot(cross(b - a, c - a), view_.camera.eye - a) > 0 ? front : back).push_back(triangle);
  }
  faces(surface, front, tint, clear_front);
  faces(surface, back, tint, clear_wall);
  edges(surface, tint, line);
}

void PovWriter::elements(const std::vector<Rod>& rods) {
  for (const Rod& rod : rods) {
    Vec3d tint{0.25, 0.27, 0.3};
    if (rod.of == Rod::Of::barrel) tint = {0.45, 0.5, 0.55};
    if (rod.of == Rod::Of::piston_rod) tint = {0.85, 0.87, 0.9};
    fmt::print(out_, "cylinder {{ {}, {}, {:.4g} pigment {{ srgb {} }} finish {{ glass }} }}\n", point(rod.a),
               point(rod.b), length(rod.radius), vector(tint));
  }
}

void PovWriter::rod(Vec3d a, Vec3d b, double radius, Vec3d colour) {
  if (norm(b - a) < 1e-9 * size_) return;
  fmt::print(out_,
             "cylinder {{ {}, {}, {:.4g} pigment {{ srgb {} }} finish {{ ambient 0 diffuse 0 emission 1 }} "
             "no_shadow }}\n",
             point(a), point(b), length(radius), vector(colour));
}

// Letters keep their size in pixels in pictures smaller than the usual one, down to half of it.
double overlay_height(const PictureSize& size) {
  return std::clamp(size.height, PictureSize{}.height / 2, PictureSize{}.height);
}

struct Bounds {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(Vec3d p, double radius) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis] - radius);
      high[axis] = std::max(high[axis], p[axis] + radius);
    }
  }
};

constexpr Vec3d ink{0.25, 0.28, 0.32};

// The box around everything along the world's axes. One edge along each axis has its ends in numbers: that
// which is lowest in the picture, of vertical ones the leftmost.
void draw_extents(PovWriter& pov, Overlay& overlay, const Frame& frame, Vec3d up) {
  Bounds box;
  for (const Surface& surface : frame.surfaces)
    for (const Vec3d& vertex : surface.mesh.vertices) box.add(vertex, 0);
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
    const Spot at{std::clamp(best->x - left, half + 2, overlay.width() - half - 2),
                  std::clamp(best->y - 20, 8.0, overlay.height() - 20)};
    overlay.box({at.x - half, at.y - 5}, {at.x + half, at.y + 14}, {1, 1, 1}, 0.35);
    overlay.text(at, 14, words, Align::middle, ink);
  }
}

// Words beside their points, each at the first of some places where it covers no other.
void draw_labels(PovWriter& pov, Overlay& overlay, const std::vector<Label>& labels) {
  struct Rectangle {
    Spot low, high;
    bool meets(const Rectangle& other) const {
      return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
    }
  };
  constexpr double size = 14, height = 20;
  std::vector<Rectangle> taken;
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

}  // namespace

std::vector<LegendEntry> body_legend(const scene::Scene& scene) {
  std::vector<LegendEntry> entries;
  if (scene.mbd)
    for (std::size_t i = 0; i < scene.mbd->bodies.size(); ++i)
      entries.push_back({scene.mbd->bodies[i].name, body_colour(i)});
  return entries;
}

void write_pov(std::ostream& out, const Frame& frame, const scene::Scene& scene, const View& view,
               const PictureText& more) {
  PovWriter pov(out, view);
  pov.stage();
  pov.spheres(frame);
  if (frame.liquid_surface) pov.liquid(*frame.liquid_surface);
  const std::vector<LegendEntry> legend = body_legend(scene);
  for (const Surface& surface : frame.surfaces) {
    if (surface.mesh.triangles.empty()) continue;
    if (surface.name == contact_ground) {
      pov.ground(surface, contact_ground_tint, 6e-4 * pov.size());
      continue;
    }
    Vec3d tint = ground_tint;
    if (!surface.fixed) {
      const auto entry = std::ranges::find(legend, surface.name, &LegendEntry::name);
      tint = entry == legend.end() ? body_colour(0) : entry->colour;
    }
    // Particles inside a body show their colours through it, of spheres also at a lower clearness.
    const double of_body = frame.liquid_surface ? 0.8 : frame.has_particles() ? 0.55 : 0.4;
    pov.surface(surface, tint, surface.fixed ? clear_wall : of_body, 6e-4 * pov.size());
  }
  pov.elements(element_rods(scene, frame, pov.size()));

  Overlay overlay(out, pov.local(view.camera.eye), view.camera.target - view.camera.eye, view.camera.up,
                  view.camera.field_of_view, view.size.aspect(), overlay_height(view.size),
                  0.1 * eye_distance);
  if (more.extents) draw_extents(pov, overlay, frame, view.up);
  draw_labels(pov, overlay, more.labels);
  draw_legend(overlay, view.title, legend);
  if (frame.has_particles()) draw_scale(overlay, view.scale);
}

bool render(const std::filesystem::path& folder, const std::string& name, const Frame& frame,
            const scene::Scene& scene, const View& view, const PictureText& more) {
  const std::filesystem::path text = folder / (name + ".pov"), log_file = folder / (name + ".log");
  std::ofstream out(text);
  write_pov(out, frame, scene, view, more);
  out.close();
  if (!out) {
    log::warn("no picture: {} cannot be written", text.string());
    return false;
  }
  // Debian allows POV-Ray to write in its working folder only.
  const bool done = run_tool(
      {.program = "povray",
       .package = "povray",
       .arguments = {"+I" + name + ".pov", "+O" + name + ".png", fmt::format("+W{}", view.size.width),
                     fmt::format("+H{}", view.size.height), "+A0.25", "+AM2", "+R2", "-D", "-GA"},
       .folder = folder,
       .log = std::filesystem::absolute(log_file),
       .patience = std::chrono::seconds(300)});
  std::filesystem::remove(text);  // its numbers are in the HDF5 files
  std::error_code ignored;
  if (!done)
    for (const char* part : {".png", ".pov-state"}) std::filesystem::remove(folder / (name + part), ignored);
  return done;
}

}  // namespace tandem::launch

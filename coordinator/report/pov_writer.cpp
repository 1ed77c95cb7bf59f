#include "coordinator/report/pov_writer.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <map>

#include "coordinator/report/wireframe.hpp"

namespace tandem::launch {
namespace {

// Few textures: POV-Ray keeps one for all objects that name it.
constexpr std::size_t shades = 64;
constexpr double edge_radius = 6e-4;  // over the size of the picture
constexpr double from_behind = 0.88;  // clearness of the ground

std::string vector(Vec3d v) {
  return fmt::format("<{:.7g},{:.7g},{:.7g}>", v.x, v.y, v.z);
}

}  // namespace

PovWriter::PovWriter(std::ostream& out, const View& view)
    : out_(out),
      view_(view),
      size_(norm(view.camera.target - view.camera.eye)),
      scale_(pov_eye_distance / size_) {}

std::string PovWriter::point(Vec3d p) const {
  return vector(local(p));
}

// The one of a value, or its index in a list of names.
std::size_t PovWriter::shade_of(double value) const {
  const ColourScale& scale = view_.scale;
  if (!scale.names.empty()) return static_cast<std::size_t>(std::max(value, 0.0));
  const double share = std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
  return static_cast<std::size_t>(share * (shades - 1) + 0.5);
}

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
  // The ground has the pale colour of the horizon at its far end; above it the sky becomes darker upwards.
  fmt::print(out_,
             "sky_sphere {{ pigment {{ gradient {0} color_map {{ [0.5 srgb <0.72,0.80,0.89>] [1 srgb "
             "<0.45,0.62,0.82>] "
             "}} scale 2 translate -{0} }} }}\n",
             vector(up));
  const Vec3d key = pov_eye_distance * (0.9 * up - 0.75 * ahead - 0.55 * right);
  const std::string soft =
      view_.soft_shadows
          ? fmt::format(" area_light {}, {}, 4, 4 adaptive 0 jitter circular orient",
                        vector(0.25 * pov_eye_distance * right), vector(0.25 * pov_eye_distance * ahead))
          : "";
  fmt::print(out_, "light_source {{ {} srgb <1,0.985,0.96>*1.1{} }}\n", vector(key), soft);
  fmt::print(out_, "light_source {{ {} srgb <0.92,0.96,1>*0.42 shadowless }}\n",
             vector(pov_eye_distance * (0.5 * up - 0.4 * ahead + 1.2 * right)));
  fmt::print(out_, "#declare grain = finish {{ ambient 0.2 diffuse 0.74 specular 0.22 roughness 0.03 }}\n");
  fmt::print(out_, "#declare water = finish {{ ambient 0.2 diffuse 0.7 specular 0.5 roughness 0.005 }}\n");
  fmt::print(out_, "#declare glass = finish {{ ambient 0.3 diffuse 0.68 specular 0.15 roughness 0.01 }}\n");
  fmt::print(out_, "#declare body = finish {{ ambient 0.26 diffuse 0.66 specular 0.12 roughness 0.04 }}\n");
  // No part of the scene: it has its own light, and so no shadow falls on it.
  const Vec3d centre = (length(view_.floor) - scale_ * dot(view_.camera.target, up)) * up;
  fmt::print(out_,
             "disc {{ {0}, {1}, {2:.6g} pigment {{ spherical color_map {{ [0 srgbt <0.85,0.88,0.92,1>] "
             "[0.75 srgbt <0.86,0.86,0.85,0>] }} scale {2:.6g} translate {0} }} finish {{ ambient 0 "
             "diffuse 0 emission 1 }} no_shadow }}\n",
             vector(centre), vector(up), 3.5 * pov_eye_distance);
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

// Faces in one plane would be drawn in patches by chance. All points are moved along their lines of sight,
// those of each layer a little nearer to the eye than the layer before: the picture stays the same, and the
// later layer is in front.
std::string PovWriter::nearer() {
  const std::string eye = vector(local(view_.camera.eye));
  return fmt::format(" translate -{0} scale {1:.8g} translate {0}", eye, 1 - 1e-5 * layer_++);
}

void PovWriter::faces(const Surface& surface, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                      Vec3d tint, double clearness, bool shadow) {
  if (triangles.empty()) return;
  // Only the vertices of these triangles.
  std::map<std::uint32_t, std::size_t> index;
  std::vector<std::uint32_t> vertices;
  for (const auto& triangle : triangles)
    for (const std::uint32_t corner : triangle)
      if (index.try_emplace(corner, vertices.size()).second) vertices.push_back(corner);
  out_ << "mesh2 { vertex_vectors { " << vertices.size();
  for (const std::uint32_t vertex : vertices) out_ << ',' << point(surface.mesh.vertices[vertex]);
  out_ << " } face_indices { " << triangles.size();
  for (const auto& [a, b, c] : triangles) fmt::print(out_, ",<{},{},{}>", index[a], index[b], index[c]);
  fmt::print(out_, " }} pigment {{ srgbt <{:.3g},{:.3g},{:.3g},{:.3g}> }} finish {{ {} }}{}{} }}\n", tint.x,
             tint.y, tint.z, clearness, clearness > 0 ? "glass" : "body", shadow ? "" : " no_shadow",
             nearer());
}

void PovWriter::edges(const Surface& surface, Vec3d tint) {
  const double radius = length(edge_radius * size_);
  out_ << "union {\n";
  for (const auto& [a, b] : feature_edges(surface.mesh))
    fmt::print(out_, "cylinder {{ {}, {}, {:.4g} }}\n", point(a), point(b), radius);
  // An empty union is an error.
  fmt::print(out_, "sphere {{ {}, {:.4g} }}\n", point(surface.mesh.vertices.front()), radius);
  fmt::print(
      out_, "pigment {{ srgb <{:.3g},{:.3g},{:.3g}> }} finish {{ ambient 0.5 diffuse 0.4 }} no_shadow{} }}\n",
      0.35 * tint.x, 0.35 * tint.y, 0.35 * tint.z, nearer());
}

void PovWriter::surface(const Surface& surface, const std::vector<Patch>& patches, Vec3d tint) {
  const auto clearness = [&](const Patch& patch) { return clearness_of(patch.hidden, surface.fixed); };
  const bool is_container =
      std::ranges::any_of(patches, [&](const Patch& patch) { return clearness(patch) > 0; });
  // Solid patches are one object: those of a mesh from CAD may be thousands.
  std::vector<std::array<std::uint32_t, 3>> solid;
  for (const Patch& patch : patches) {
    if (clearness(patch) > 0)
      faces(surface, patch.triangles, tint, clearness(patch), false);
    else
      solid.insert(solid.end(), patch.triangles.begin(), patch.triangles.end());
  }
  faces(surface, solid, tint, 0, !is_container && !surface.fixed);
  edges(surface, tint);
}

void PovWriter::ground(const Surface& surface, std::vector<Patch> patches, Vec3d tint) {
  std::vector<std::array<std::uint32_t, 3>> front, back;
  for (const Patch& patch : patches)
    for (const auto& triangle : patch.triangles) {
      const Vec3d a = surface.mesh.vertices[triangle[0]], b = surface.mesh.vertices[triangle[1]],
                  c = surface.mesh.vertices[triangle[2]];
      (dot(cross(b - a, c - a), view_.camera.eye - a) > 0 ? front : back).push_back(triangle);
    }
  faces(surface, front, tint, 0, false);
  faces(surface, back, tint, from_behind, false);
  edges(surface, tint);
}

void PovWriter::elements(const std::vector<Rod>& rods) {
  for (const Rod& rod : rods) {
    Vec3d tint{0.25, 0.27, 0.3};
    if (rod.of == Rod::Of::barrel) tint = {0.45, 0.5, 0.55};
    if (rod.of == Rod::Of::piston_rod) tint = {0.85, 0.87, 0.9};
    fmt::print(out_, "cylinder {{ {}, {}, {:.4g} pigment {{ srgb {} }} finish {{ body }} }}\n", point(rod.a),
               point(rod.b), length(rod.radius), vector(tint));
  }
}

// Flat arrows a little above their surfaces.
void PovWriter::arrows(const std::vector<Arrow>& arrows) {
  for (const Arrow& arrow : arrows) {
    const Vec3d along = arrow.to - arrow.from;
    const Vec3d across = cross(normalized(arrow.normal), along);  // as long as the arrow
    const Vec3d lift = 2 * edge_radius * size_ * normalized(arrow.normal);
    const auto at = [&](double forward, double aside) {
      return point(arrow.from + forward * along + aside * across + lift);
    };
    fmt::print(
        out_,
        "mesh2 {{ vertex_vectors {{ 7,{},{},{},{},{},{},{} }} face_indices {{ 3,<0,1,2>,<0,2,3>,<4,5,6> }} "
        "pigment {{ srgb <0.95,0.55,0.05> }} finish {{ ambient 0.6 diffuse 0.4 }} no_shadow{} }}\n",
        at(0, -0.09), at(0.6, -0.09), at(0.6, 0.09), at(0, 0.09), at(0.6, -0.26), at(1, 0), at(0.6, 0.26),
        nearer());
  }
}

void PovWriter::rod(Vec3d a, Vec3d b, double radius, Vec3d colour) {
  if (norm(b - a) < 1e-9 * size_) return;
  fmt::print(out_,
             "cylinder {{ {}, {}, {:.4g} pigment {{ srgb {} }} finish {{ ambient 0 diffuse 0 emission 1 }} "
             "no_shadow }}\n",
             point(a), point(b), length(radius), vector(colour));
}

}  // namespace tandem::launch

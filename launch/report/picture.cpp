// The scene description for POV-Ray: spheres coloured by speed, bodies as tinted glass with edges, on a pale
// floor that fades into the sky.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "common/error.hpp"
#include "common/log.hpp"
#include "launch/report/camera.hpp"
#include "launch/report/element_rods.hpp"
#include "launch/report/last_frame.hpp"
#include "launch/report/report.hpp"
#include "launch/report/tool.hpp"
#include "launch/report/wireframe.hpp"

namespace tandem::launch {
namespace {

constexpr int width = 1280, height = 720;
constexpr std::size_t most_spheres = 5'000'000;  // POV-Ray takes about 1 kB for each

std::string pov(Vec3d v) {
  return fmt::format("<{:.7g},{:.7g},{:.7g}>", v.x, v.y, v.z);
}

// Lightness is linear in the value (nine colours of matplotlib's viridis, sRGB).
constexpr std::array<Vec3d, 9> viridis{{{0.267, 0.005, 0.329},
                                        {0.279, 0.175, 0.483},
                                        {0.230, 0.322, 0.546},
                                        {0.173, 0.449, 0.558},
                                        {0.128, 0.567, 0.551},
                                        {0.158, 0.684, 0.502},
                                        {0.369, 0.789, 0.383},
                                        {0.678, 0.864, 0.190},
                                        {0.993, 0.906, 0.144}}};

Vec3d colour(double share) {
  // The darkest eighth is left out: most spheres are at rest and would form one black heap.
  const double place = (0.125 + 0.875 * std::clamp(share, 0.0, 1.0)) * (viridis.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), viridis.size() - 2);
  const double rest = place - static_cast<double>(below);
  return (1 - rest) * viridis[below] + rest * viridis[below + 1];
}

// Speed of the brightest colour: the fastest hundredth of the spheres is ignored.
double top_speed(std::vector<double> speed) {
  if (speed.empty()) return 1;
  const auto place =
      speed.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(speed.size() - 1));
  std::nth_element(speed.begin(), place, speed.end());
  return std::max(*place, 1e-9);
}

void write_particles(std::ostream& out, const LastFrame& frame) {
  constexpr int shades = 32;
  const double top = top_speed(frame.speed);
  std::array<std::vector<std::size_t>, shades> of_shade;
  for (std::size_t i = 0; i < frame.speed.size(); ++i) {
    of_shade[static_cast<std::size_t>(std::min(frame.speed[i] / top, 1.0) * (shades - 1))].push_back(i);
  }
  for (int shade = 0; shade < shades; ++shade) {
    if (of_shade[shade].empty()) continue;
    fmt::print(out, "#declare T = texture {{ pigment {{ srgb {} }} finish {{ grain }} }}\n",
               pov(colour((shade + 0.5) / shades)));
    for (const std::size_t i : of_shade[shade]) {
      const double* p = &frame.position[3 * i];
      fmt::print(out, "sphere{{<{:.7g},{:.7g},{:.7g}>{:.7g} texture{{T}}}}\n", p[0], p[1], p[2],
                 frame.radius[i]);
    }
  }
}

void write_surface(std::ostream& out, const Surface& surface, Vec3d tint, double clearness, double line) {
  out << "mesh2 { vertex_vectors { " << surface.mesh.vertices.size();
  for (const Vec3d& vertex : surface.mesh.vertices) out << ',' << pov(vertex);
  out << " } face_indices { " << surface.mesh.triangles.size();
  for (const auto& [a, b, c] : surface.mesh.triangles) fmt::print(out, ",<{},{},{}>", a, b, c);
  fmt::print(out, " }} pigment {{ srgbt <{:.3g},{:.3g},{:.3g},{:.3g}> }} finish {{ glass }}{} }}\n", tint.x,
             tint.y, tint.z, clearness, surface.fixed ? " no_shadow" : "");
  out << "union {\n";
  for (const auto& [a, b] : feature_edges(surface.mesh)) {
    fmt::print(out, "cylinder {{ {}, {}, {:.4g} }}\n", pov(a), pov(b), line);
  }
  // An empty union is an error.
  fmt::print(out, "sphere {{ {}, {:.4g} }}\n", pov(surface.mesh.vertices.front()), line);
  fmt::print(out,
             "pigment {{ srgb <{:.3g},{:.3g},{:.3g}> }} finish {{ ambient 0.5 diffuse 0.4 }} no_shadow }}\n",
             0.45 * tint.x, 0.45 * tint.y, 0.45 * tint.z);
}

void write_elements(std::ostream& out, const std::vector<Rod>& rods) {
  for (const Rod& rod : rods) {
    Vec3d tint{0.25, 0.27, 0.3};
    if (rod.of == Rod::Of::barrel) tint = {0.45, 0.5, 0.55};
    if (rod.of == Rod::Of::piston_rod) tint = {0.85, 0.87, 0.9};
    fmt::print(out, "cylinder {{ {}, {}, {:.4g} pigment {{ srgb {} }} finish {{ glass }} }}\n", pov(rod.a),
               pov(rod.b), rod.radius, pov(tint));
  }
}

double lowest(const LastFrame& frame, Vec3d up) {
  double low = 1e300;
  for (const Surface& surface : frame.surfaces) {
    for (const Vec3d& vertex : surface.mesh.vertices) low = std::min(low, dot(vertex, up));
  }
  for (std::size_t i = 0; i < frame.radius.size(); ++i) {
    const double* p = &frame.position[3 * i];
    low = std::min(low, dot(Vec3d{p[0], p[1], p[2]}, up) - frame.radius[i]);
  }
  return low;
}

void write_stage(std::ostream& out, const scene::Camera& camera, Vec3d up, double floor) {
  const Vec3d view = camera.target - camera.eye;
  const double size = norm(view);
  const Vec3d right = normalized(cross(view, up));
  const Vec3d ahead = cross(up, right);
  fmt::print(out, "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 24 }}\n");
  // A negative width makes POV-Ray's space right-handed, like that of the scene.
  fmt::print(out, "camera {{ location {} sky {} right -x*{}/{} angle {} look_at {} }}\n", pov(camera.eye),
             pov(camera.up), width, height, camera.field_of_view, pov(camera.target));
  // The floor has the pale colour of the horizon at its far end; above it the sky becomes darker upwards.
  fmt::print(out,
             "sky_sphere {{ pigment {{ gradient {0} color_map {{ [0.5 srgb <0.72,0.80,0.89>] [1 srgb "
             "<0.45,0.62,0.82>] "
             "}} scale 2 translate -{0} }} }}\n",
             pov(up));
  const Vec3d key = camera.target + size * (0.9 * up - 0.75 * ahead - 0.55 * right);
  fmt::print(out,
             "light_source {{ {} srgb <1,0.985,0.96>*1.1 area_light {}, {}, 4, 4 adaptive 0 jitter circular "
             "orient }}\n",
             pov(key), pov(0.25 * size * right), pov(0.25 * size * ahead));
  fmt::print(out, "light_source {{ {} srgb <0.92,0.96,1>*0.42 shadowless }}\n",
             pov(camera.target + size * (0.5 * up - 0.4 * ahead + 1.2 * right)));
  fmt::print(out, "#declare grain = finish {{ ambient 0.2 diffuse 0.74 specular 0.22 roughness 0.03 }}\n");
  fmt::print(out, "#declare glass = finish {{ ambient 0.25 diffuse 0.55 specular 0.15 roughness 0.01 }}\n");
  const Vec3d centre = camera.target + (floor - dot(camera.target, up)) * up;
  fmt::print(out,
             "disc {{ {0}, {1}, {2:.6g} pigment {{ spherical color_map {{ [0 srgbt <0.955,0.962,0.970,1>] "
             "[0.75 srgbt <0.93,0.935,0.94,0>] }} scale {2:.6g} translate {0} }} finish {{ ambient 0.28 "
             "diffuse 0.62 }} }}\n",
             pov(centre), pov(up), 3.5 * size);
}

void write_scene(std::ostream& out, const LastFrame& frame, const scene::Scene& scene) {
  const Vec3d up = upwards(scene);
  const scene::Camera camera =
      scene.output.camera.value_or(automatic_camera(frame, up, static_cast<double>(width) / height));
  const double size = norm(camera.target - camera.eye);
  write_stage(out, camera, up, lowest(frame, up) - 1e-3 * size);
  write_particles(out, frame);
  for (const Surface& surface : frame.surfaces) {
    if (surface.mesh.triangles.empty()) continue;
    const Vec3d tint = surface.fixed ? Vec3d{0.72, 0.78, 0.84} : Vec3d{0.96, 0.56, 0.24};
    write_surface(out, surface, tint, surface.fixed ? 0.88 : 0.4, 6e-4 * size);
  }
  write_elements(out, element_rods(scene, frame, size));
}

bool draw(const std::filesystem::path& folder, const scene::Scene& scene) {
  const LastFrame frame = read_last_frame(folder);
  if (frame.position.empty() && frame.surfaces.empty()) {
    log::warn(scene.dem && !scene.output.particles
                  ? "no picture: frames have no spheres (output.particles), and there is no body to draw"
                  : "no picture: the run has written no frame");
    return false;
  }
  if (frame.radius.size() > most_spheres) {
    log::warn("no picture: {} spheres are more than POV-Ray holds in memory ({}); ParaView opens {}",
              frame.radius.size(), most_spheres, (folder / "particles.xdmf").string());
    return false;
  }
  const std::filesystem::path text = folder / "picture.pov", log_file = folder / "picture.log";
  std::ofstream out(text);
  write_scene(out, frame, scene);
  out.close();
  if (!out) {
    log::warn("no picture: {} cannot be written", text.string());
    return false;
  }
  log::info("drawing picture.png with POV-Ray, which takes some seconds; --no-picture leaves it out");
  // Debian allows POV-Ray to write in its working folder only.
  const bool done =
      run_tool({.program = "povray",
                .package = "povray",
                .arguments = {"+Ipicture.pov", "+Opicture.png", fmt::format("+W{}", width),
                              fmt::format("+H{}", height), "+A0.25", "+AM2", "+R2", "-D", "-GA"},
                .folder = folder,
                .log = std::filesystem::absolute(log_file),
                .patience = std::chrono::seconds(300)});
  std::filesystem::remove(text);  // its numbers are in the HDF5 files
  return done;
}

}  // namespace

bool render_picture(const std::filesystem::path& folder, const scene::Scene& scene) {
  try {
    return draw(folder, scene);
  } catch (const Error& error) {
    log::warn("no picture: {}", error.what());
    return false;
  }
}

}  // namespace tandem::launch

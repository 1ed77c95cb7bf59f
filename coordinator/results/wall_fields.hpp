// What the spheres do to the triangles of walls, as cell data of the bodies' meshes in frames: where
// output.wall_fields of the scene names the walls.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// Values of all triangles of one body: `width` of each. NaN on triangles of other walls.
struct CellColumn {
  std::string name;
  std::size_t width = 1;
  std::vector<double> values;
};

class WallFields {
 public:
  // `bodies`: as body_meshes() makes them of this scene.
  WallFields(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes,
             const std::vector<BodyMesh>& bodies);
  // Of each body, in their order, at this frame; bodies without such walls have no columns. Forces are means
  // since the frame before, and NaN in the first one. Error{protocol} where the frame has other triangles.
  std::vector<std::vector<CellColumn>> of(const protocol::ParticlesFrame& frame);

 private:
  struct Part {
    std::size_t body = 0;            // index in `bodies`
    std::size_t first_triangle = 0;  // of the body's mesh
    std::size_t first_row = 0;       // of ParticlesFrame::walls
    std::vector<double> area;        // of each triangle [m2]
    std::optional<double> hardness;  // [Pa]
  };
  std::vector<Part> parts_;
  std::vector<std::size_t> triangles_;  // of each body
  std::size_t rows_ = 0;
  std::vector<double> last_;  // sums of the frame before
  Nanoseconds last_time_;
};

}  // namespace tandem::launch

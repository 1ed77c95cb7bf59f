#include "launch/step/solids.hpp"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <cmath>
#include <fstream>
#include <map>

#include "common/geometry/mass_properties.hpp"
#include "common/geometry/stl_bytes.hpp"
#include "launch/step/document.hpp"
#include "launch/step/features.hpp"
#include "launch/step/refusal.hpp"
#include "launch/step/solid_mesh.hpp"

namespace tandem::step {

using Json = nlohmann::json;

namespace {

// A solid that lacks a face has a volume as well, of no meaning: each edge belongs to two triangles, once in
// each direction, and the mesh has the volume up to its deviation.
void expect_closed(const TriangleMesh& mesh, double volume, double deviation) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      uses[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
    area += 0.5 *
            norm(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  }
  for (const auto& [edge, balance] : uses)
    if (balance != 0)
      throw Refusal("has a solid with a missing or open face", "repair it in the CAD program");
  const double found = mass_of_mesh(mesh, 1).mass;
  if (std::abs(found - volume) > area * deviation + 1e-4 * volume)
    throw Refusal("has a solid of " + std::to_string(1e9 * volume) + " mm3 whose faces enclose " +
                      std::to_string(1e9 * found) + " mm3",
                  "repair it in the CAD program");
}

}  // namespace

Json facts_of_product(const TopoDS_Shape& shape, std::optional<double> deviation,
                      const std::filesystem::path& file) {
  std::size_t solids = 0;
  GProp_GProps properties;
  for (TopExp_Explorer each(shape, TopAbs_SOLID); each.More(); each.Next(), ++solids) {
    GProp_GProps solid;
    // Without an error that it keeps, OpenCASCADE integrates over curved faces by a fixed number of points.
    BRepGProp::VolumeProperties(each.Current(), solid, 1e-10);
    if (!(solid.Mass() > 0))
      throw Refusal("has a solid that encloses no volume: it is open, or inside out",
                    "repair it in the CAD program");
    properties.Add(solid);
  }
  Json facts{{"solids", solids}};
  if (solids == 0) return facts;
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  const double diagonal = std::sqrt(box.SquareExtent()) * metres;
  const gp_XYZ centre = properties.CentreOfMass().XYZ() * metres, low = box.CornerMin().XYZ() * metres,
               high = box.CornerMax().XYZ() * metres;
  const gp_Mat inertia = properties.MatrixOfInertia();  // about the centre, of density 1 / mm3
  facts["volume"] = properties.Mass() * std::pow(metres, 3);
  facts["centre"] = {centre.X(), centre.Y(), centre.Z()};
  Json& elements = facts["inertia"] = Json::array();
  for (const auto& [i, k] : {std::pair{1, 1}, {2, 2}, {3, 3}, {1, 2}, {1, 3}, {2, 3}})
    elements.push_back(inertia.Value(i, k) * std::pow(metres, 5));
  facts["low"] = {low.X(), low.Y(), low.Z()};
  facts["high"] = {high.X(), high.Y(), high.Z()};

  const double stated = deviation.value_or(1e-3 * diagonal);
  const SolidMesh mesh = mesh_of_solids(shape, stated);
  expect_closed(mesh.mesh, properties.Mass() * std::pow(metres, 3), mesh.deviation);
  std::ofstream(file, std::ios::binary) << stl_bytes(mesh.mesh);
  facts["triangles"] = mesh.mesh.triangles.size();
  facts["deviation"] = mesh.deviation;
  facts["stated_deviation"] = stated;
  Json& features = facts["features"] = Json::array();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (Json feature = feature_of(mesh.faces[f]); !feature.is_null()) {
      feature["first"] = mesh.first[f];
      feature["count"] = mesh.first[f + 1] - mesh.first[f];
      features.push_back(std::move(feature));
    }
  return facts;
}

}  // namespace tandem::step

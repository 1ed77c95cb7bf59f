#include "launch/step/solids.hpp"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <cmath>
#include <fstream>

#include "common/geometry/stl_bytes.hpp"
#include "launch/step/document.hpp"
#include "launch/step/features.hpp"
#include "launch/step/refusal.hpp"
#include "launch/step/solid_mesh.hpp"

namespace tandem::step {

using Json = nlohmann::json;

Json facts_of_product(const TopoDS_Shape& shape, std::optional<double> deviation,
                      const std::filesystem::path& file) {
  std::size_t solids = 0;
  GProp_GProps properties;
  for (TopExp_Explorer each(shape, TopAbs_SOLID); each.More(); each.Next(), ++solids) {
    GProp_GProps solid;
    BRepGProp::VolumeProperties(each.Current(), solid);
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

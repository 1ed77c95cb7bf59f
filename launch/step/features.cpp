#include "launch/step/features.hpp"

#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <cmath>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>

#include "launch/step/document.hpp"

namespace tandem::step {
namespace {

using Json = nlohmann::json;

Json length(const gp_XYZ& v) {
  return {v.X() * metres, v.Y() * metres, v.Z() * metres};
}
Json direction(const gp_XYZ& v) {
  return {v.X(), v.Y(), v.Z()};
}

}  // namespace

Json feature_of(const TopoDS_Face& face) {
  const BRepAdaptor_Surface surface(face);
  if (surface.GetType() != GeomAbs_Cylinder && surface.GetType() != GeomAbs_Plane) return nullptr;
  GProp_GProps area;
  BRepGProp::SurfaceProperties(face, area);
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  if (surface.GetType() == GeomAbs_Plane) {
    const gp_Pln plane = surface.Plane();
    const double sign = reversed != !plane.Direct() ? -1 : 1;
    return {{"kind", "plane"},
            {"point", length(area.CentreOfMass().XYZ())},
            {"normal", direction(plane.Axis().Direction().XYZ() * sign)},
            {"area", area.Mass() * metres * metres}};
  }
  const gp_Cylinder cylinder = surface.Cylinder();
  const double begin = surface.FirstVParameter(), end = surface.LastVParameter();
  const double arc = end > begin ? area.Mass() / (cylinder.Radius() * (end - begin)) : 0;
  return {{"kind", "cylinder"},
          {"point", length(cylinder.Location().XYZ())},
          {"axis", direction(cylinder.Axis().Direction().XYZ())},
          {"radius", cylinder.Radius() * metres},
          {"hole", reversed != !cylinder.Direct()},
          {"begin", begin * metres},
          {"end", end * metres},
          {"angle", std::min(arc, 2 * M_PI)}};
}

}  // namespace tandem::step

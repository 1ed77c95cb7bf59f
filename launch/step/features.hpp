// Cylindrical and plane faces of a solid.
#pragma once

#include <TopoDS_Face.hxx>
#include <nlohmann/json.hpp>

namespace tandem::step {

// {"kind": "cylinder", point, axis, radius, hole, begin, end, angle} or {"kind": "plane", point, normal,
// area} in the frame of the product [m]; null for other surfaces. begin, end: along the axis from the point;
// angle: of the arc that the face covers on average [rad]; normal: out of the solid.
nlohmann::json feature_of(const TopoDS_Face& face);

}  // namespace tandem::step

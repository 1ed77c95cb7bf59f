#include "launch/step/solid_mesh.hpp"

#include <fmt/format.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "common/geometry/triangle_tree.hpp"
#include "launch/step/document.hpp"
#include "launch/step/refusal.hpp"

namespace tandem::step {
namespace {

// Nodes of all faces, with those joined that are the same point of an edge or the same vertex.
class JoinedNodes {
 public:
  void add(const TopoDS_Face& face, const Handle(Poly_Triangulation) & triangles, const TopLoc_Location& at) {
    const std::size_t base = parent_.size();
    parent_.resize(base + static_cast<std::size_t>(triangles->NbNodes()));
    std::iota(parent_.begin() + static_cast<std::ptrdiff_t>(base), parent_.end(), base);
    for (int i = 1; i <= triangles->NbNodes(); ++i) {
      const gp_XYZ p = triangles->Node(i).Transformed(at.Transformation()).XYZ() * metres;
      // The triangles of an STL file have corners of single precision.
      position_.push_back({static_cast<float>(p.X()), static_cast<float>(p.Y()), static_cast<float>(p.Z())});
    }
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon =
          BRep_Tool::PolygonOnTriangulation(edge, triangles, at);
      if (polygon.IsNull()) continue;
      std::vector<std::size_t> nodes;
      for (int i = 1; i <= polygon->NbNodes(); ++i)
        nodes.push_back(base + static_cast<std::size_t>(polygon->Node(i)) - 1);
      join_edge(edge, nodes);
    }
  }

  std::size_t root(std::size_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  Vec3d position(std::size_t node) const { return position_[node]; }

 private:
  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  void join_edge(const TopoDS_Edge& edge, const std::vector<std::size_t>& nodes) {
    if (const std::vector<std::size_t>* others = edges_.Seek(edge)) {
      if (others->size() == nodes.size())
        for (std::size_t i = 0; i < nodes.size(); ++i) join((*others)[i], nodes[i]);
    } else {
      edges_.Bind(edge, nodes);
    }
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    join_vertex(TopExp::FirstVertex(forward), nodes.front());
    join_vertex(TopExp::LastVertex(forward), nodes.back());
    // The pole of a sphere and the apex of a cone are edges of one point.
    if (BRep_Tool::Degenerated(edge))
      for (const std::size_t node : nodes) join(nodes.front(), node);
  }

  void join_vertex(const TopoDS_Vertex& vertex, std::size_t node) {
    if (vertex.IsNull()) return;
    if (const std::size_t* other = vertices_.Seek(vertex))
      join(*other, node);
    else
      vertices_.Bind(vertex, node);
  }

  std::vector<std::size_t> parent_;
  std::vector<Vec3d> position_;
  NCollection_DataMap<TopoDS_Shape, std::vector<std::size_t>, TopTools_ShapeMapHasher> edges_;
  NCollection_DataMap<TopoDS_Shape, std::size_t, TopTools_ShapeMapHasher> vertices_;
};

// Where the nodes of a face are in the parameters of its surface.
class Parameters {
 public:
  Parameters(const TopoDS_Face& face, const Handle(Poly_Triangulation) & triangles, const TopLoc_Location& at)
      : triangles_(triangles) {
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
      if (!BRep_Tool::Degenerated(edge)) continue;
      const Handle(Poly_PolygonOnTriangulation) polygon =
          BRep_Tool::PolygonOnTriangulation(edge, triangles, at);
      if (polygon.IsNull()) continue;
      gp_Pnt2d begin, end;
      BRep_Tool::UVPoints(edge, face, begin, end);
      for (int i = 1; i <= polygon->NbNodes(); ++i) points_[polygon->Node(i)] = {begin.XY(), end.XY()};
    }
  }

  // Of the pole of a sphere and the apex of a cone, which are one point for a whole line of parameters: those
  // nearest to the parameters `seen_from`.
  gp_XY of(int node, const gp_XY& seen_from) const {
    const auto point = points_.find(node);
    if (point == points_.end()) return of(node);
    const auto& [begin, end] = point->second;
    const gp_XY along = end - begin;
    const double share = along.SquareModulus() > 0 ? (seen_from - begin) * along / along.SquareModulus() : 0;
    return begin + along * std::clamp(share, 0.0, 1.0);
  }
  gp_XY of(int node) const { return triangles_->UVNode(node).XY(); }

 private:
  Handle(Poly_Triangulation) triangles_;
  std::map<int, std::pair<gp_XY, gp_XY>> points_;  // nodes on edges of one point, and the ends of the line
};

// Largest distance from the surface, at the middle of a triangle and of its sides in the parameters of the
// surface, to the triangle [m].
double deviation_of(const TopoDS_Face& face, const Handle(Poly_Triangulation) & triangles,
                    const TopLoc_Location& at) {
  const BRepAdaptor_Surface surface(face);
  if (surface.GetType() == GeomAbs_Plane || !triangles->HasUVNodes()) return 0;
  const Parameters parameters(face, triangles, at);
  const auto vector = [](const gp_XYZ& p) { return Vec3d{p.X(), p.Y(), p.Z()}; };
  double worst = 0;
  for (int t = 1; t <= triangles->NbTriangles(); ++t) {
    std::array<int, 3> node{};
    triangles->Triangle(t).Get(node[0], node[1], node[2]);
    std::array<Vec3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = vector(triangles->Node(node[i]).Transformed(at.Transformation()).XYZ());
    std::array<gp_XY, 4> middle;  // of the triangle, and of its sides
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = node[i], b = node[(i + 1) % 3], c = node[(i + 2) % 3];
      middle[0] += parameters.of(a, (parameters.of(b) + parameters.of(c)) / 2.0) / 3.0;
      middle[i + 1] = (parameters.of(a, parameters.of(b)) + parameters.of(b, parameters.of(a))) / 2.0;
    }
    for (const gp_XY& uv : middle) {
      const Vec3d x = vector(surface.Value(uv.X(), uv.Y()).XYZ());
      worst = std::max(worst, norm(x - nearest_point(corner[0], corner[1], corner[2], x)));
    }
  }
  return worst * metres;
}

SolidMesh triangles_of(const TopoDS_Shape& shape) {
  SolidMesh result;
  JoinedNodes nodes;
  std::vector<std::array<std::size_t, 3>> corners;
  std::size_t base = 0;
  for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next())
    for (TopExp_Explorer faces(solids.Current(), TopAbs_FACE); faces.More(); faces.Next()) {
      const TopoDS_Face face = TopoDS::Face(faces.Current());
      TopLoc_Location at;
      const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, at);
      if (triangles.IsNull())
        throw Refusal("has a face that OpenCASCADE cannot mesh", "repair it in the CAD program");
      nodes.add(face, triangles, at);
      result.faces.push_back(face);
      result.first.push_back(corners.size());
      for (int t = 1; t <= triangles->NbTriangles(); ++t) {
        std::array<int, 3> node{};
        triangles->Triangle(t).Get(node[0], node[1], node[2]);
        if (face.Orientation() == TopAbs_REVERSED) std::swap(node[1], node[2]);
        const auto corner = [&](int i) {
          return base + static_cast<std::size_t>(node[static_cast<std::size_t>(i)]) - 1;
        };
        corners.push_back({corner(0), corner(1), corner(2)});
      }
      base += static_cast<std::size_t>(triangles->NbNodes());
      result.deviation = std::max(result.deviation, deviation_of(face, triangles, at));
    }
  result.first.push_back(corners.size());
  // Triangles whose corners are joined are dropped, so that the first one of each face is counted anew.
  std::vector<std::uint32_t> number(base, UINT32_MAX);
  std::size_t face = 0;
  for (std::size_t t = 0; t <= corners.size(); ++t) {
    while (face < result.first.size() && result.first[face] == t)
      result.first[face++] = result.mesh.triangles.size();
    if (t == corners.size()) break;
    std::array<std::size_t, 3> root{};
    std::transform(corners[t].begin(), corners[t].end(), root.begin(),
                   [&](std::size_t node) { return nodes.root(node); });
    if (root[0] == root[1] || root[1] == root[2] || root[2] == root[0]) continue;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t& vertex = number[root[i]];
      if (vertex == UINT32_MAX) {
        vertex = static_cast<std::uint32_t>(result.mesh.vertices.size());
        result.mesh.vertices.push_back(nodes.position(root[i]));
      }
      triangle[i] = vertex;
    }
    result.mesh.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace

SolidMesh mesh_of_solids(const TopoDS_Shape& shape, double deviation) {
  // OpenCASCADE takes its deflection as a target, not as a bound.
  double deflection = deviation / metres, least = std::numeric_limits<double>::infinity();
  constexpr double angle = 0.5;  // between neighbouring triangles [rad]
  for (int attempt = 0; attempt < 6; ++attempt, deflection *= 0.6) {
    BRepTools::Clean(shape);
    BRepMesh_IncrementalMesh(shape, deflection, false, angle, false);
    SolidMesh result = triangles_of(shape);
    const bool is_sound = degenerate_triangles(result.mesh).empty();
    if (result.deviation <= deviation && is_sound) return result;
    if (is_sound) least = std::min(least, result.deviation);
  }
  // The edges of a file may be beside its faces, by what the CAD program tolerates.
  if (std::isfinite(least))
    throw Refusal(
        fmt::format("gets no mesh within a deviation of {:.3g} m: the least that was reached is {:.3g} m",
                    deviation, least),
        "give a larger --deviation");
  throw Refusal(
      fmt::format("gets no mesh within a deviation of {:.3g} m: it has triangles without area in the "
                  "single precision of an STL file",
                  deviation),
      "give another --deviation, or leave it out");
}

}  // namespace tandem::step

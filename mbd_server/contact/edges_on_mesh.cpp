// Edges of a body that cross edges of a mesh.
#include <algorithm>
#include <cmath>

#include "mbd_server/contact/features.hpp"
#include "mbd_server/contact/mesh_search.hpp"

namespace tandem::mbd {
namespace {

// A crossing so near to the end of an edge is one of the corner, as a share of the edge.
constexpr double at_end = 1e-6;

class EdgesOnMesh : MeshSearch {
 public:
  explicit EdgesOnMesh(const MeshSearch& search) : MeshSearch(search) {}

  void add() {
    std::vector<int> edges;
    for (std::size_t k = 0; k < a_.edges.size(); ++k) {
      const ContactShape::Edge& e = a_.edges[k];
      const Vector3d p = local(a_.points[nth(e.from)]), q = local(a_.points[nth(e.to)]);
      const Vector3d margin = Vector3d::Constant(a_.radius + reach_ + depth_);
      mesh_.near(p.cwiseMin(q) - margin, p.cwiseMax(q) + margin, near_);
      edges.clear();
      for (const int f : near_)
        for (const int g : mesh_.face(f).edges)
          if (mesh_.edge(g).bend == Bend::convex || mesh_.edge(g).bend == Bend::border) edges.push_back(g);
      std::sort(edges.begin(), edges.end());
      edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
      for (const int g : edges) crossing(k, p, q - p, g);
    }
  }

 private:
  void crossing(std::size_t k, const Vector3d& p, const Vector3d& d, int g) {
    const ContactMesh::Edge& edge = mesh_.edge(g);
    const Vector3d q = mesh_.point(edge.from), e = mesh_.point(edge.to) - q, N = d.cross(e);
    if (N.norm() <= parallel * d.norm() * e.norm()) return;
    const Vector3d D = q - p;
    const double s = D.cross(e).dot(N) / N.squaredNorm(), t = D.cross(d).dot(N) / N.squaredNorm();
    if (s < at_end || s > 1 - at_end || t < 0 || t > 1) return;
    const ContactMesh::Face& first = mesh_.face(edge.faces[0]);
    Vector3d normals = first.normal;
    if (edge.faces[1] != none) normals += mesh_.face(edge.faces[1]).normal;
    const Vector3d n = N.dot(normals) > 0 ? Vector3d(-N.normalized()) : N.normalized();  // into the mesh
    for (const int f : edge.faces)
      if (f != none && -n.dot(outward(f, g)) < -tilt_of_edge) return;
    if (a_.is_polytope()) {
      const ContactShape::Edge& own = a_.edges[k];
      for (std::size_t i = 0; i < 2; ++i) {
        const Vector3d m = R_ * a_.faces[nth(own.faces[i])].normal, across = d.cross(m).normalized(),
                       in = local(a_.centre) - p;
        const double out = across.dot(in) > 0 ? -across.dot(n) : across.dot(n);
        if (out < -tilt_of_edge) return;
      }
      if (n.dot(R_ * (a_.faces[nth(own.faces[0])].normal + a_.faces[nth(own.faces[1])].normal)) <= 0) return;
    }
    const double gap = n.dot(D) - a_.radius;
    if (gap > reach_ || gap < -2 * std::min(first.thickness, a_.thickness)) return;
    // Nearer to an end than it is deep, a corner touches instead.
    const double from_end = std::min(std::min(s, 1 - s) * d.norm(), std::min(t, 1 - t) * e.norm());
    if (from_end < -gap) return;
    ContactFeature f;
    f.kind = ContactFeature::Kind::lines;
    f.a = index_a_, f.b = index_b_;
    f.code = code_of(Family::lines, static_cast<std::int64_t>(k), g);
    f.face = edge.faces[0];
    f.place_a = a_.points[nth(a_.edges[k].from)];
    f.axis_a = (a_.points[nth(a_.edges[k].to)] - f.place_a).normalized();
    if (N.dot(n) < 0) f.axis_a = -f.axis_a;
    f.place_b = q;
    f.axis_b = e.normalized();
    f.radius_a = a_.radius;
    out_.push_back(f);
  }
};

}  // namespace

void add_edges_on_mesh(const MeshSearch& search) {
  EdgesOnMesh(search).add();
}

}  // namespace tandem::mbd

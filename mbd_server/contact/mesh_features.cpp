#include "mbd_server/contact/mesh_features.hpp"

#include "mbd_server/contact/balls_on_mesh.hpp"

namespace tandem::mbd {

void find_mesh_features(const Model& model, int a, int b, const std::vector<LinkMotion>& links, double reach,
                        double depth, std::vector<ContactFeature>& features) {
  const MeshSearch search(model, a, b, links, reach, depth, features);
  const ContactShape& shape = model.contact.shape(a);
  BallsOnMesh balls(search);
  for (std::size_t i = 0; i < shape.points.size(); ++i)
    if (balls.add(i)) balls.add_watch(i);
  if (shape.kind == ContactShape::Kind::sphere) return;
  add_edges_on_mesh(search);
  add_mesh_corners(search);
}

void watched_features(const Model& model, const ContactFeature& watch, const std::vector<LinkMotion>& links,
                      double reach, double depth, std::vector<ContactFeature>& features,
                      std::optional<ContactFeature>* behind) {
  BallsOnMesh balls(MeshSearch(model, watch.a, watch.b, links, reach, depth, features));
  const auto ball = static_cast<std::size_t>(watch.code >> 24 & 0xffffff);
  if (balls.add(ball) && behind) *behind = balls.behind(ball);
}

}  // namespace tandem::mbd

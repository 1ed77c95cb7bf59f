#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {

namespace {

// As the scene's check of a plane road.
void expect_above(const TyreOnLink& tyre, const Vector3d& centre, const std::string& path) {
  const std::optional<Road::Place> place = tyre.road->below(centre, tyre.normal);
  if (!place || place->from_behind) return;
  const double height = place->normal.dot(centre - place->point) / place->normal.dot(tyre.normal);
  if (!(height > 0.5 * tyre.radius))
    throw Error(ErrorCode::scene,
                fmt::format("the centre of the wheel of tyre \"{}\" is {:.4g} m above road \"{}\" at the "
                            "start, less than half of the radius of {:.4g} m",
                            tyre.name, height, place->surface->name, tyre.radius),
                path + ".radius", "give the radius in metres, and place the wheel on the road");
}

}  // namespace

// The ground's shapes are the first ones, in their order.
void place_road(const scene::Scene& scene, const scene::Tyre& from, const std::string& path,
                const Model& model, TyreOnLink& tyre) {
  if (from.road.empty()) return;
  const auto road = std::make_shared<Road>();
  for (const std::string& name : from.road) {
    const auto& ground = scene.contact->ground;
    const auto index =
        static_cast<int>(std::ranges::find(ground, name, &scene::Shape::name) - ground.begin());
    const ContactShape& shape = model.contact.shape(index);
    road->surfaces.push_back({name, shape.mesh, shape.centre, shape.axes.col(2), index});
  }
  tyre.road = road;
  const scene::Joint& joint = scene.mbd->joints[from.joint.value];
  expect_above(tyre, to_eigen(joint.child_position.value_or(joint.position)) - model.origin, path);
}

}  // namespace tandem::mbd

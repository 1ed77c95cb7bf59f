#include "coordinator/watch/energy_watch.hpp"

#include <algorithm>
#include <cmath>

#include "coordinator/watch/rigid_body.hpp"

namespace tandem::launch {
namespace {

// Share of the weights at the distances of the bodies from the origin that counts as energy that moves:
// a pose in a frame may be off by a millionth of the size of its body.
constexpr double resolved_energy = 2e-3;

// Whether the coordinator knows what this element stores.
bool has_known_energy(const scene::Force& force) {
  if (const auto* spring = std::get_if<scene::SpringDamper>(&force)) return !spring->table;
  if (const auto* spring = std::get_if<scene::RotationalSpringDamper>(&force))
    return !spring->table && spring->stiffness == 0;
  return std::holds_alternative<scene::BodyLoad>(force) || std::holds_alternative<scene::Actuator>(force);
}

}  // namespace

EnergyWatch::EnergyWatch(const scene::Scene& scene) : gravity_(scene.gravity) {
  if (!scene.mbd) return;
  const scene::Mbd& mbd = *scene.mbd;
  known_ =
      std::ranges::all_of(mbd.forces, has_known_energy) &&
      std::ranges::none_of(mbd.joints, [](const scene::Joint& joint) { return joint.limits.has_value(); });
  touches_ = scene.contact.has_value();
  bodies_ = mbd.bodies;
  const auto on_body = [&](BodyId body, Vec3d point) {
    if (body == ground) return point;
    const Pose& pose = mbd.bodies[body.value].pose;
    return pose.q_WB.conjugate().rotate(point - pose.p_WB);
  };
  for (const scene::Force& force : mbd.forces)
    if (const auto* s = std::get_if<scene::SpringDamper>(&force))
      springs_.push_back({s->body_a, s->body_b, on_body(s->body_a, s->point_a),
                          on_body(s->body_b, s->point_b), s->stiffness, s->length});
  for (const scene::Body& body : bodies_)
    least_scale_ += resolved_energy * body.mass * norm(gravity_) * (gyration(body) + norm(body.pose.p_WB));
}

EnergyWatch::Energy EnergyWatch::energy_of(const protocol::BodiesFrame& frame) const {
  Energy energy;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const scene::Body& body = bodies_[b];
    const protocol::BodyState& state = frame.bodies[b];
    energy.kinetic += kinetic_energy(body, state.pose, state.twist);
    energy.potential -= body.mass * dot(gravity_, state.pose.p_WB);
  }
  const auto place = [&](BodyId body, Vec3d point) {
    if (body == ground) return point;
    const Pose& pose = frame.bodies[body.value].pose;
    return pose.p_WB + pose.q_WB.rotate(point);
  };
  for (const Spring& spring : springs_) {
    const double stretch =
        norm(place(spring.body_b, spring.point_b) - place(spring.body_a, spring.point_a)) - spring.length;
    energy.stored += 0.5 * spring.stiffness * stretch * stretch;
  }
  if (touches_) energy.stored += frame.contacts.back();
  energy.potential += energy.stored;
  return energy;
}

void EnergyWatch::observe(const protocol::BodiesFrame& frame) {
  if (!known_ || frame.bodies.size() != bodies_.size() || (touches_ && frame.contacts.empty())) return;
  const Energy now = energy_of(frame);
  if (first_.frames++ == 0) {
    // A prestressed spring stores energy of which the rounding remains.
    first_ = {frame.energy, now.kinetic, now.potential, resolved_energy * now.stored, 1};
    return;
  }
  first_.scale = std::max({first_.scale, now.kinetic, std::abs(now.potential - first_.potential)});
  const double reported = frame.energy - first_.reported,
               computed = (now.kinetic - first_.kinetic) + (now.potential - first_.potential);
  const double difference = std::abs(reported - computed), scale = first_.scale + least_scale_;
  const Difference d{difference == 0 ? 0 : difference / scale, reported, computed, to_seconds(frame.time)};
  if (!largest_ || !(d.share <= largest_->share)) largest_ = d;
}

void EnergyWatch::save_or_restore(Archive& archive) {
  archive("energy_watch/first", first_);
  bool any = largest_.has_value();
  archive("energy_watch/any", any);
  Difference d = largest_.value_or(Difference{});
  archive("energy_watch/largest", d);
  for (const double value : {first_.reported, first_.kinetic, first_.potential, first_.scale, d.share,
                             d.reported, d.computed, d.time})
    archive.expect(std::isfinite(value), "energy_watch", "an energy is not finite");
  archive.expect(first_.scale >= 0 && d.share >= 0, "energy_watch", "an energy that moves is negative");
  largest_ = any ? std::optional(d) : std::nullopt;
}

}  // namespace tandem::launch

#include "participant/library/features.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/scene/columns.hpp"

namespace tandem::participant {
namespace {

class Features {
 public:
  void add(const std::string& name, const std::string& where) {
    const bool listed = std::ranges::any_of(list_, [&](const Feature& f) { return f.name == name; });
    if (!listed) list_.push_back({name, where});
  }
  std::vector<Feature> take() { return std::move(list_); }

 private:
  std::vector<Feature> list_;
};

const char* name(scene::JointType type) {
  switch (type) {
    case scene::JointType::fixed:
      return "joint:fixed";
    case scene::JointType::revolute:
      return "joint:revolute";
    case scene::JointType::prismatic:
      return "joint:prismatic";
    case scene::JointType::spherical:
      return "joint:spherical";
    case scene::JointType::free:
      return "joint:free";
    case scene::JointType::cylindrical:
      return "joint:cylindrical";
    case scene::JointType::universal:
      return "joint:universal";
    case scene::JointType::planar:
      return "joint:planar";
    case scene::JointType::screw:
      return "joint:screw";
    case scene::JointType::distance:
      return "joint:distance";
  }
  return "joint:unknown";
}

const char* name(scene::CouplerType type) {
  if (type == scene::CouplerType::linear) return "coupler.linear";
  return type == scene::CouplerType::cam ? "coupler.cam" : "coupler";
}

const char* name(scene::ContactLaw law) {
  switch (law) {
    case scene::ContactLaw::hertz_mindlin:
      return "contact:hertz_mindlin";
    case scene::ContactLaw::hertz_frictionless:
      return "contact:hertz_frictionless";
    case scene::ContactLaw::paper:
      return "contact:paper";
    case scene::ContactLaw::hooke:
      return "contact:hooke";
    case scene::ContactLaw::jkr:
      return "contact:jkr";
    case scene::ContactLaw::sjkr:
      return "contact:sjkr";
  }
  return "contact:unknown";
}

struct NameOfForce {
  std::string operator()(const scene::SpringDamper& f) const {
    return f.table || f.damping_table ? "force:spring_damper_table" : "force:spring_damper";
  }
  std::string operator()(const scene::RotationalSpringDamper& f) const {
    return f.table || f.damping_table ? "force:rotational_spring_damper_table"
                                      : "force:rotational_spring_damper";
  }
  std::string operator()(const scene::BodyLoad& f) const {
    return f.over ? "force:body_load_over_joint" : "force:body_load";
  }
  std::string operator()(const scene::Actuator& f) const {
    if (f.over) return "force:actuator_over_joint";
    return f.input.empty() ? "force:actuator" : "force:controlled_actuator";
  }
  template <class Other>
  std::string operator()(const Other&) const {
    return std::string("force:") + Other::type;
  }
};

struct NameOfShape {
  std::string operator()(const scene::PlaneShape&) const { return "wall:plane"; }
  std::string operator()(const scene::BoxShape&) const { return "wall:triangles"; }
  std::string operator()(const scene::MeshShape&) const { return "wall:triangles"; }
  std::string operator()(const scene::CylinderShape& shape) const {
    return shape.segments ? "wall:triangles" : "wall:cylinder";
  }
  std::string operator()(const scene::SphereShape&) const { return "wall:sphere"; }
};

std::string quoted(const std::string& list, const std::string& name) {
  return list + " '" + name + "'";
}

void add_walls(const std::vector<scene::Wall>& walls, const std::string& list, Features& features) {
  for (const scene::Wall& wall : walls) {
    features.add(std::visit(NameOfShape(), wall.shape), quoted(list, wall.name));
    if (wall.surface_velocity) features.add("wall.surface_velocity", quoted(list, wall.name));
  }
}

}  // namespace

std::vector<Feature> features_of_mbd(const scene::Scene& scene) {
  Features features;
  if (!scene.mbd) return {};
  for (const scene::Joint& joint : scene.mbd->joints) {
    const std::string where = quoted("mbd.joints", joint.name);
    features.add(name(joint.type), where);
    if (joint.damping != 0) features.add("joint.damping", where);
    if (joint.rate != 0) features.add("joint.rate", where);
    if (joint.child_position) features.add("joint.child_position", where);
    if (joint.cut) features.add("joint.cut", where);
    if (joint.limits) features.add("joint.limits", where);
    if (joint.friction) features.add(joint.friction->breakaway ? "joint.stiction" : "joint.friction", where);
    if (joint.motion) features.add("joint.motion", where);
  }
  if (scene.mbd->start == scene::Start::equilibrium) {
    features.add("start.equilibrium", "mbd.start");
    if (scene.sph && !scene.sph->walls.empty()) features.add("start.equilibrium_with_liquid", "mbd.start");
  }
  for (const scene::Coupler& coupler : scene.mbd->couplers)
    features.add(name(coupler.type), quoted("mbd.couplers", coupler.name));
  for (const scene::Force& force : scene.mbd->forces)
    features.add(std::visit(NameOfForce(), force),
                 quoted("mbd.forces", std::visit([](const auto& f) { return f.name; }, force)));
  return features.take();
}

std::vector<Feature> features_of_dem(const scene::Scene& scene, const std::string& spinning_group) {
  Features features;
  if (!scene.dem) return {};
  const scene::Dem& dem = *scene.dem;
  features.add(name(dem.contact), "dem.contact");
  if (dem.rolling) features.add("contact.rolling", "dem.contact");
  if (dem.twisting) features.add("contact.twisting", "dem.contact");
  for (const scene::ParticleGroup& group : dem.particles) {
    const std::string where = quoted("dem.particles", group.name);
    if (group.fixed) features.add("particles.fixed", where);
    if (std::holds_alternative<scene::InletFill>(group.fill)) features.add("particles.inlet", where);
  }
  if (!spinning_group.empty()) features.add("particles.spin", quoted("dem.particles", spinning_group));
  add_walls(dem.walls, "dem.walls", features);
  if (!dem.outlets.empty()) features.add("outlet", quoted("dem.outlets", dem.outlets.front().name));
  if (dem.periodic[0] || dem.periodic[1] || dem.periodic[2]) features.add("domain.periodic", "dem.domain");
  if (dem.follows) features.add("domain.follows", "dem.domain");
  if (dem.relax_start) features.add("relax_start", "dem.relax_start");
  return features.take();
}

std::vector<Feature> features_of_sph(const scene::Scene& scene) {
  Features features;
  if (!scene.sph) return {};
  const scene::Sph& sph = *scene.sph;
  for (const scene::Liquid& liquid : sph.liquids)
    for (const auto& fill : liquid.fill)
      if (std::holds_alternative<scene::LiquidInside>(fill))
        features.add("liquid.inside", quoted("sph.liquids", liquid.name));
  add_walls(sph.walls, "sph.walls", features);
  const auto add_friction = [&](scene::WallFriction friction, const std::string& where) {
    features.add(friction == scene::WallFriction::no_slip ? "liquid.no_slip" : "liquid.free_slip", where);
  };
  if (!sph.walls.empty()) add_friction(sph.wall_friction, "sph.wall_friction");
  for (const scene::LiquidPair& pair : sph.pairs) add_friction(pair.wall_friction, "sph.pairs");
  if (!sph.inlets.empty()) features.add("liquid.inlet", quoted("sph.inlets", sph.inlets.front().name));
  if (!sph.outlets.empty()) features.add("outlet", quoted("sph.outlets", sph.outlets.front().name));
  if (sph.periodic[0] || sph.periodic[1] || sph.periodic[2]) features.add("domain.periodic", "sph.domain");
  if (sph.follows) features.add("domain.follows", "sph.domain");
  return features.take();
}

void expect_known(const std::vector<Feature>& features, const std::vector<std::string>& known,
                  const std::string& program) {
  const auto is_known = [&](const std::string& name) {
    return std::ranges::any_of(known, [&](const std::string& pattern) {
      return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1))
                                    : name == pattern;
    });
  };
  std::string unknown, where;
  for (const Feature& feature : features) {
    if (is_known(feature.name)) continue;
    unknown += (unknown.empty() ? "" : ", ") + feature.name;
    if (where.empty()) where = feature.where;
  }
  if (unknown.empty()) return;
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw Error(ErrorCode::scene, "the scene asks for " + unknown + ", which " + program + " does not know",
              where, "it knows " + (list.empty() ? "free bodies only" : list) + "; or choose another solver");
}

}  // namespace tandem::participant

#include "launch/import/joints.hpp"

#include <fmt/format.h>

#include "launch/import/urdf_file.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

// Rate [rad/s] or [m/s] from which dry friction acts almost fully. Friction in URDF jumps with the sign of
// the rate, which no implicit step can integrate; this rate is far below those of machines.
constexpr double friction_slip = 1e-3;

[[noreturn]] void fail(const std::string& file, const urdf::Joint& joint, const std::string& problem,
                       const std::string& hint) {
  fail_on_urdf(file, "joint '" + joint.name + "'", problem, hint);
}

bool turns(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}
bool has_coordinate(const urdf::Joint& joint) {
  return turns(joint) || joint.type == urdf::Joint::PRISMATIC;
}
// A joint whose child is only a frame is not a joint of the scene.
bool carries_body(const urdf::Joint& joint, const LinkFrames& frames) {
  return frames.at(joint.child_link_name).body == joint.child_link_name;
}

const char* type_of(const urdf::Joint& joint, const std::string& file) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return "revolute";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    case urdf::Joint::FLOATING:
      return "free";
    case urdf::Joint::FIXED:
      return "fixed";
    default:
      fail(file, joint, "a planar joint cannot be imported",
           "build it of two prismatic joints and a continuous one, with light links between them");
  }
}

// Adds all properties of a joint except its type and position, or a note on why not.
class Reader {
 public:
  Reader(const urdf::Joint& joint, Json& entry, std::vector<std::string>& notes)
      : joint_(joint), entry_(entry), notes_(notes) {}

  void read(const std::optional<StopStiffness>& stops) {
    read_travel(stops);
    read_dynamics();
    if (joint_.safety) note("<safety_controller>: a scene has no controllers");
    if (joint_.calibration) note("<calibration>: a scene has no encoders");
  }

 private:
  void note(const std::string& what) { notes_.push_back("joint '" + joint_.name + "': " + what); }
  const char* unit(const char* angular, const char* linear) const { return turns(joint_) ? angular : linear; }

  void read_travel(const std::optional<StopStiffness>& stops) {
    if (!joint_.limits) return;
    const double lower = joint_.limits->lower, upper = joint_.limits->upper;
    if (joint_.type != urdf::Joint::CONTINUOUS && (lower != 0 || upper != 0)) {
      const std::string range = fmt::format("limits {:.6g} to {:.6g} {}", lower, upper, unit("rad", "m"));
      if (!has_coordinate(joint_))
        note(range + ": only revolute and prismatic joints have stops");
      else if (lower > 0 || upper < 0)
        note(range + ": the model starts at zero, beyond them, where a stop would throw it back");
      else if (!stops)
        note(
            fmt::format("{}: URDF does not say how stiff the stops are: import with --stops, or add "
                        "\"limits\": {{\"lower\": {:.6g}, \"upper\": {:.6g}, \"stiffness\": ...}}",
                        range, lower, upper));
      else
        entry_["limits"] = {{"lower", lower},
                            {"upper", upper},
                            {"stiffness", turns(joint_) ? stops->angular : stops->linear}};
    }
    if (joint_.limits->effort > 0)
      note(fmt::format("effort limit {:.6g} {}: there is no drive to limit", joint_.limits->effort,
                       unit("N m", "N")));
    if (joint_.limits->velocity > 0)
      note(fmt::format("velocity limit {:.6g} {}: there is no drive to limit", joint_.limits->velocity,
                       unit("rad/s", "m/s")));
  }

  void read_dynamics() {
    if (!joint_.dynamics) return;
    const double damping = joint_.dynamics->damping, friction = joint_.dynamics->friction;
    if (!has_coordinate(joint_)) {
      const std::string type = entry_.at("type");
      if (damping != 0) note(fmt::format("damping {:.6g}: a {} joint has none", damping, type));
      if (friction != 0) note(fmt::format("friction {:.6g}: a {} joint has none", friction, type));
      return;
    }
    if (damping != 0) entry_["damping"] = damping;
    if (friction != 0) entry_["friction"] = {{"force", friction}, {"slip", friction_slip}};
  }

  const urdf::Joint& joint_;
  Json& entry_;
  std::vector<std::string>& notes_;
};

Json root_joint(const urdf::Link& root, const LinkFrames& frames) {
  return {{"name", root.name + "_to_ground"},
          {"type", "fixed"},
          {"parent", "ground"},
          {"child", root.name},
          {"position", list(frames.at(root.name).pose.p_WB)}};
}

}  // namespace

Json joints_of(const urdf::ModelInterface& model, const LinkFrames& frames, const JointOptions& options,
               const std::string& file, std::vector<std::string>& notes) {
  Json joints = Json::array();
  const urdf::Link& root = *model.getRoot();
  if (root.inertial && !options.free_root) joints.push_back(root_joint(root, frames));
  for (const auto& [name, joint] : model.joints_) {
    const LinkFrame& child = frames.at(joint->child_link_name);
    const std::string type = type_of(*joint, file);
    Json entry{{"name", name},
               {"type", type},
               {"parent", frames.at(joint->parent_link_name).body},
               {"child", child.body},
               {"position", list(child.pose.p_WB)}};
    if (has_coordinate(*joint)) {
      const Vec3d axis = vector(joint->axis);
      if (!(norm(axis) > 0)) fail(file, *joint, "the axis is 0 0 0", "give the axis a direction");
      // The joint's frame is the child's at zero coordinates.
      entry["axis"] = list(child.pose.q_WB.rotate(normalized(axis)));
    }
    Reader(*joint, entry, notes).read(options.stops);
    if (carries_body(*joint, frames)) joints.push_back(entry);
  }
  return joints;
}

Json couplers_of(const urdf::ModelInterface& model, const LinkFrames& frames, const std::string& file,
                 std::vector<std::string>& notes) {
  Json couplers = Json::array();
  for (const auto& [name, joint] : model.joints_) {
    if (!joint->mimic) continue;
    const std::string& leader_name = joint->mimic->joint_name;
    const double multiplier = joint->mimic->multiplier, offset = joint->mimic->offset;
    const auto found = model.joints_.find(leader_name);
    if (found == model.joints_.end() || found->second == joint)
      fail(file, *joint,
           "mimics joint '" + leader_name +
               (found == model.joints_.end() ? "', which does not exist" : "', itself"),
           "name another joint of the model");
    const urdf::Joint& leader = *found->second;
    const auto note = [&](const std::string& why) {
      notes.push_back(fmt::format("joint '{}': mimic of joint '{}' (multiplier {:.6g}, offset {:.6g}): {}",
                                  name, leader_name, multiplier, offset, why));
    };
    if (offset != 0) {
      note("couplers tie the travel from the start, where all coordinates are zero");
    } else if (multiplier == 0) {
      note("it does not move: make it a fixed joint");
    } else if (!has_coordinate(*joint) || !has_coordinate(leader) || !carries_body(*joint, frames) ||
               !carries_body(leader, frames)) {
      note("one of them has no coordinate in the scene");
    } else if (!turns(*joint) && !turns(leader)) {
      note("a scene has no coupler of two sliding joints");
    } else {
      // A coupler gives q_b / q_a, and a rack is always b.
      const bool reversed = !turns(leader);
      couplers.push_back({{"name", name},
                          {"type", turns(*joint) && turns(leader) ? "gear" : "rack_and_pinion"},
                          {"joint_a", reversed ? name : leader_name},
                          {"joint_b", reversed ? leader_name : name},
                          {"ratio", reversed ? 1 / multiplier : multiplier}});
    }
  }
  return couplers;
}

}  // namespace tandem::launch

#include "common/scene/plain_form.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/node.hpp"
#include "common/scene/orientation.hpp"
#include "common/scene/tolerance.hpp"
#include "common/scene/validate_parts.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

using nlohmann::json;

json list_of(Vec3d v) {
  return json::array({v.x, v.y, v.z});
}
json list_of(Quat q) {
  return json::array({q.w, q.x, q.y, q.z});
}

// first * second: a pose in the frame of a pose.
Pose composed(const Pose& first, const Pose& second) {
  return {first.p_WB + first.q_WB.rotate(second.p_WB), (first.q_WB * second.q_WB).normalized()};
}
Pose inverse(const Pose& pose) {
  const Quat q = pose.q_WB.conjugate();
  return {-q.rotate(pose.p_WB), q};
}

class PlainForm {
 public:
  PlainForm(json& document, const std::string& origin) : document_(document), origin_(origin) {}

  bool run() {
    if (document_.contains("mbd")) {
      each("mbd", "joints", [&](json& joint, const std::string& path) { angles_of_joint(joint, path); });
      each("mbd", "forces", [&](json& force, const std::string& path) { angles_of_force(force, path); });
      each("mbd", "bodies", [&](json& body, const std::string& path) {
        orientation(body, path);
        each_shape(body, path, [&](json& shape, const std::string& at) { orientation(shape, at); });
      });
    }
    each("dem", "walls", [&](json& wall, const std::string& path) {
      orientation(wall, path);
      if (wall.contains("surface_velocity") && wall["surface_velocity"].is_object())
        function(wall["surface_velocity"]["speed"], path + ".surface_velocity.speed",
                 "the speed of a surface is no angle");
    });
    for (const char* list : {"walls", "sensors", "inlets"})
      each("sph", list, [&](json& object, const std::string& path) { orientation(object, path); });
    each("dem", "sensors", [&](json& sensor, const std::string& path) { orientation(sensor, path); });
    if (document_.contains("mbd") && document_["mbd"].contains("contact"))
      if (json& contact = document_["mbd"]["contact"]; contact.contains("ground"))
        for (std::size_t i = 0; i < contact["ground"].size(); ++i)
          orientation(contact["ground"][i], element("mbd.contact.ground", i));
    place();
    return changed_;
  }

 private:
  template <class Act>
  void each(const char* part, const char* list, const Act& act) {
    if (!document_.contains(part) || !document_[part].contains(list)) return;
    json& elements = document_[part][list];
    for (std::size_t i = 0; i < elements.size(); ++i)
      act(elements[i], element(std::string(part) + "." + list, i));
  }
  template <class Act>
  static void each_shape(json& body, const std::string& path, const Act& act) {
    if (!body.contains("shapes")) return;
    for (std::size_t i = 0; i < body["shapes"].size(); ++i)
      act(body["shapes"][i], element(path + ".shapes", i));
  }

  // ---- angles

  // Replaces KEY_deg, a number or a list, by KEY. `refusal` says why there are no angles here.
  void in_radians(json& object, const std::string& path, const std::string& key,
                  const char* refusal = nullptr) {
    const std::string in_degrees = key + "_deg";
    const auto given = object.find(in_degrees);
    if (given == object.end()) return;
    if (refusal) fail(origin_, path + "." + in_degrees, refusal, "give " + key);
    if (object.contains(key))
      fail(origin_, path + "." + in_degrees, key + " and " + in_degrees + " are both given",
           "keep one of them");
    const auto radians = [](const json& degrees) { return degrees.get<double>() / 180 * std::numbers::pi; };
    json value;
    if (given->is_array())
      for (const json& degrees : *given) value.push_back(radians(degrees));
    else
      value = radians(*given);
    object.erase(given);
    object[key] = std::move(value);
    changed_ = true;
  }

  void need(const json& object, const std::string& path, const std::string& key, const char* meaning) {
    if (!object.contains(key))
      fail(origin_, path, "the key '" + key + "' is missing", "add " + key + ": " + meaning);
  }

  void angles_of_joint(json& joint, const std::string& path) {
    const char* refusal =
        joint["type"] == "prismatic" ? "the coordinate of a prismatic joint is a length" : nullptr;
    in_radians(joint, path, "rate", refusal);
    if (joint.contains("limits")) {
      for (const char* key : {"lower", "upper"}) in_radians(joint["limits"], path + ".limits", key, refusal);
      need(joint["limits"], path + ".limits", "lower", "lower end of the travel [rad] or [m]");
      need(joint["limits"], path + ".limits", "upper", "upper end of the travel [rad] or [m]");
    }
    if (joint.contains("motion")) function(joint["motion"], path + ".motion", refusal);
  }

  void angles_of_force(json& force, const std::string& path) {
    in_radians(force, path, "angle");
    if (force.contains("size")) function(force["size"], path + ".size", "the size of a force is no angle");
    if (force.contains("target")) function(force["target"], path + ".target", why_no_angle(force));
    if (force.contains("brake") && force["brake"].contains("engaged"))
      function(force["brake"]["engaged"], path + ".brake.engaged", "the share of a brake is no angle");
    if (force.contains("over")) over_joint(force["over"], path + ".over");
  }

  static const char* why_no_angle(const json& drive) {
    if (drive["type"] == "cylinder") return "the target of a cylinder is no angle";
    return drive["control"] == "throttle" ? "a throttle is no angle" : nullptr;
  }

  void over_joint(json& over, const std::string& path) {
    const char* refusal = nullptr;
    each("mbd", "joints", [&](const json& joint, const std::string&) {
      if (joint["name"] == over["joint"] && joint["type"] == "prismatic")
        refusal = "the coordinate of a prismatic joint is a length";
    });
    if (!refusal && over.contains("arguments_deg"))
      validate_curve_arguments(
          over["arguments_deg"],
          over.contains("period_deg") ? std::optional<double>(over["period_deg"]) : std::nullopt,
          AngleUnit::degrees, origin_, path);
    for (const char* key : {"arguments", "period", "offset"}) in_radians(over, path, key, refusal);
    need(over, path, "arguments", "increasing coordinates [rad] or [m], or rates [rad/s] or [m/s]");
    if (!over.contains("offset")) return;
    const double offset = over["offset"];
    for (json& argument : over["arguments"]) argument = argument.get<double>() + offset;
    over.erase("offset");
    changed_ = true;
  }

  void function(json& f, const std::string& path, const char* refusal) {
    in_radians(f, path, "phase");
    for (const char* key : {"value", "rate", "from", "to", "offset", "amplitude", "values"})
      in_radians(f, path, key, refusal);
    const json& type = f["type"];
    const bool ramp = type == "ramp", table = type == "table", harmonic = type == "harmonic";
    if (ramp) need(f, path, "to", "coordinate after the ramp [rad] or [m], or its rate [rad/s] or [m/s]");
    if (table) need(f, path, "values", "coordinate at each time [rad] or [m], or its rate [rad/s] or [m/s]");
    if (harmonic) need(f, path, "amplitude", "amplitude [rad], [m], [N] or [N m]");
  }

  // ---- orientations

  void orientation(json& object, const std::string& path) {
    if (!object.contains("orientation") || !object["orientation"].is_object()) return;
    const json given = object["orientation"];
    object["orientation"] = list_of(read_rotation(Node(given, path + ".orientation", origin_)));
    changed_ = true;
  }

  // ---- relative poses

  void place() {
    each("mbd", "bodies", [&](json& body, const std::string& path) {
      bodies_.add(body["name"].get<std::string>());
      bool relative = body.contains("relative_to");
      each_shape(body, path,
                 [&](json& shape, const std::string&) { relative |= shape.contains("relative_to"); });
      any_ |= relative;
      json_of_.push_back(&body);
    });
    for (const char* list : {"joints", "walls", "sensors"})
      each(list[0] == 'j' ? "mbd" : "dem", list,
           [&](json& object, const std::string&) { any_ |= object.contains("relative_to"); });
    for (const char* list : {"walls", "sensors"})
      each("sph", list, [&](json& object, const std::string&) { any_ |= object.contains("relative_to"); });
    each("mbd", "forces", [&](json& force, const std::string&) { any_ |= force.contains("local"); });
    if (!any_) return;
    changed_ = true;
    if (bodies_.list().size() < json_of_.size()) return;  // a name is given twice, which is refused later

    frames_.resize(json_of_.size());
    followed_.resize(json_of_.size());
    for (std::uint32_t i = 0; i < json_of_.size(); ++i) place_body(i);
    each("mbd", "joints", [&](json& joint, const std::string& path) { place_joint(joint, path); });
    each("mbd", "forces", [&](json& force, const std::string& path) { place_force(force, path); });
    each("mbd", "bodies", [&](json& body, const std::string& path) {
      const std::string own = body["name"];
      each_shape(body, path, [&](json& shape, const std::string& at) { place_shape(shape, at, own); });
    });
    const auto place_of_particles = [&](json& shape, const std::string& path) {
      place_shape(shape, path, shape.contains("body") ? shape["body"].get<std::string>() : "ground");
    };
    for (const char* part : {"dem", "sph"})
      for (const char* list : {"walls", "sensors"}) each(part, list, place_of_particles);
  }

  static std::string body_path(std::uint32_t body) { return element("mbd.bodies", body); }

  // The pose as it is written; a quaternion has to be one before vectors are rotated by it.
  Pose written(const json& object, const std::string& path) const {
    const Node node(object, path, origin_);
    Pose pose;
    node.read("position", pose.p_WB);
    node.read("orientation", pose.q_WB);
    require_unit(pose.q_WB, origin_, path + ".orientation");
    return pose;
  }

  // Index of the body under `key`, absent for the ground.
  std::optional<std::uint32_t> body_at(const json& object, const std::string& path, const char* key) const {
    const auto name = object.at(key).get<std::string>();
    if (name == "ground") return {};
    const auto index = bodies_.index(name);
    if (!index)
      fail(origin_, path + "." + key, "unknown name '" + shortened(name) + "'",
           suggest_name(name, bodies_.list(), "bodies"));
    return index;
  }

  std::optional<std::uint32_t> reference_of(std::uint32_t body) const {
    const json& object = *json_of_[body];
    return object.contains("relative_to") ? body_at(object, body_path(body), "relative_to") : std::nullopt;
  }

  [[noreturn]] void fail_in_circle(const std::vector<std::uint32_t>& chain, std::uint32_t again) const {
    std::string circle;
    const auto begin = std::find(chain.begin(), chain.end(), again);
    for (auto at = begin; at != chain.end(); ++at) circle += "'" + bodies_.list()[*at] + "' to ";
    fail(origin_, body_path(again) + ".relative_to",
         "the pose of '" + bodies_.list()[again] + "' is relative to itself: " + circle + "'" +
             bodies_.list()[again] + "'",
         "give one of them relative to the ground or to another body");
  }

  // Follows the bodies to one whose pose in the world is known, and returns along them.
  void place_body(std::uint32_t first) {
    std::vector<std::uint32_t> chain;
    for (std::optional<std::uint32_t> body = first; body && !frames_[*body]; body = reference_of(*body)) {
      if (followed_[*body]) fail_in_circle(chain, *body);
      followed_[*body] = true;
      chain.push_back(*body);
    }
    for (; !chain.empty(); chain.pop_back()) {
      const std::uint32_t body = chain.back();
      json& object = *json_of_[body];
      Pose pose = written(object, body_path(body));
      if (const auto reference = reference_of(body)) {
        pose = composed(*frames_[*reference], pose);
        object["position"] = list_of(pose.p_WB);
        object["orientation"] = list_of(pose.q_WB);
      }
      frames_[body] = pose;
    }
    json_of_[first]->erase("relative_to");
  }

  // The pose in the world of the body under relative_to, which is then removed; absent where it is that of
  // `own`, or not given.
  std::optional<Pose> take_reference(json& object, const std::string& path, const std::string& own) {
    if (!object.contains("relative_to")) return {};
    const auto reference = body_at(object, path, "relative_to");
    const bool is_own = object["relative_to"] == own;
    object.erase("relative_to");
    if (is_own) return {};
    return reference ? *frames_[*reference] : Pose{};
  }

  void place_joint(json& joint, const std::string& path) {
    const auto reference = take_reference(joint, path, "ground");
    if (!reference) return;
    const Node node(joint, path, origin_);
    for (const char* key : {"position", "child_position"}) {
      if (!joint.contains(key)) continue;
      Vec3d point;
      node.read(key, point);
      joint[key] = list_of(reference->p_WB + reference->q_WB.rotate(point));
    }
    for (const char* key : {"axis", "axis2"}) {
      if (!joint.contains(key)) continue;
      Vec3d axis;
      node.read_unit(key, axis);
      require_unit(axis, origin_, path + "." + key);
      joint[key] = list_of(reference->q_WB.rotate(axis));
    }
  }

  // A local force: its points and direction are in the frames of the bodies that hold them.
  void place_force(json& force, const std::string& path) {
    if (!force.contains("local")) return;
    const bool local = force["local"].get<bool>();
    force.erase("local");
    if (!local) return;
    const auto frame = [&](const json& object, const std::string& at, const char* key) {
      const auto body = object.contains(key) ? body_at(object, at, key) : std::nullopt;
      return body ? *frames_[*body] : Pose{};
    };
    const auto move_point = [&](json& object, const std::string& at, const char* point, const char* body) {
      if (!object.contains(point)) return;
      const Pose pose = frame(object, at, body);
      Vec3d p;
      Node(object, at, origin_).read(point, p);
      object[point] = list_of(pose.p_WB + pose.q_WB.rotate(p));
    };
    move_point(force, path, "point_a", "body_a");
    move_point(force, path, "point_b", "body_b");
    move_point(force, path, "point", "body");
    if (force.contains("direction")) {
      Vec3d direction;
      Node(force, path, origin_).read_unit("direction", direction);
      require_unit(direction, origin_, path + ".direction");
      force["direction"] = list_of(frame(force, path, "body").q_WB.rotate(direction));
    }
    if (force.contains("points"))
      for (std::size_t i = 0; i < force["points"].size(); ++i)
        move_point(force["points"][i], element(path + ".points", i), "point", "body");
  }

  // A wall, shape or sensor of the body `own`.
  void place_shape(json& shape, const std::string& path, const std::string& own) {
    const auto reference = take_reference(shape, path, own);
    if (!reference) return;
    Pose body;
    if (own != "ground") {
      const auto index = bodies_.index(own);
      if (!index) body_at(shape, path, "body");  // which refuses the name
      body = *frames_[*index];
    }
    const Pose pose = composed(inverse(body), composed(*reference, written(shape, path)));
    shape["position"] = list_of(pose.p_WB);
    shape["orientation"] = list_of(pose.q_WB);
  }

  json& document_;
  const std::string& origin_;
  bool changed_ = false, any_ = false;
  Names bodies_;
  std::vector<json*> json_of_;               // of each body
  std::vector<std::optional<Pose>> frames_;  // of each body, in the world
  std::vector<bool> followed_;               // bodies that have been in a chain
};

}  // namespace

bool to_plain_form(json& document, const std::string& origin) {
  return PlainForm(document, origin).run();
}

}  // namespace tandem::scene

#include "common/scene/material_values.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/scene/fault.hpp"
#include "common/scene/material_library.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {
namespace material_values {
namespace {

using json = nlohmann::ordered_json;

// The value of a string of an object; empty where there is none. The schema is checked later.
std::string word(const json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : "";
}

// Elements of a list of an object; none where there is no such list.
std::vector<json*> elements(json& object, const char* key) {
  std::vector<json*> all;
  if (object.is_object() && object.contains(key) && object[key].is_array())
    for (json& element : object[key]) all.push_back(&element);
  return all;
}

class Filler {
 public:
  Filler(json& document, const std::string& origin) : document_(document), origin_(origin) {}

  std::vector<Parameter> fill() {
    if (document_.contains("dem") && document_["dem"].is_object()) fill_grains(document_["dem"]);
    if (document_.contains("sph")) fill_liquids(document_["sph"]);
    return std::move(taken_);
  }

 private:
  void take(json& object, const char* key, double value, const std::string& name, const char* unit) {
    object[key] = value;
    taken_.push_back({name + "." + key, value, unit});
  }

  void take_figure(json& object, const char* key, const std::optional<double>& value,
                   const LibraryMaterial& material, const char* unit, const std::string& path) {
    if (object.contains(key)) return;
    if (!value)
      fail(origin_, path,
           fmt::format("the library has no '{}' of the {} '{}'", key, material.kind, material.name),
           fmt::format("give {} in the list of materials; docs/materials.md says what the library has", key));
    take(object, key, *value, material.name, unit);
  }

  void complete(json& object, const LibraryMaterial& material, const std::string& path) {
    if (material.viscosity)
      fail(origin_, path,
           fmt::format("'{}' is a liquid of the library, which grains and their walls cannot be of",
                       material.name),
           fmt::format("write it as a liquid, \"sph\": {{\"liquids\": [{{\"name\": \"{}\", ...}}]}}, or take "
                       "a solid such as "
                       "'glass', or give density, young and poisson of your own in dem.materials",
                       material.name));
    take_figure(object, "density", material.density, material, "kg/m3", path);
    take_figure(object, "young", material.young, material, "Pa", path);
    take_figure(object, "poisson", material.poisson, material, "-", path);
    completed_.emplace_back(material.name);
  }

  void fill_grains(json& dem) {
    std::vector<std::string> listed;
    std::size_t number = 0;
    for (json* object : elements(dem, "materials")) {
      const std::string name = word(*object, "name"), path = fmt::format("dem.materials[{}]", number++);
      listed.push_back(name);
      const LibraryMaterial* material = find_library_material(name);
      const auto lacks = [&](const char* key) { return !object->contains(key); };
      if (material && (lacks("density") || lacks("young") || lacks("poisson")))
        complete(*object, *material, path);
    }
    const auto use = [&](const json& user, const std::string& path) {
      const std::string name = word(user, "material");
      const LibraryMaterial* material = find_library_material(name);
      if (!material || std::ranges::find(listed, name) != listed.end()) return;
      if (dem.contains("materials") && !dem["materials"].is_array()) return;  // the schema says so later
      json object{{"name", name}};
      complete(object, *material, path + ".material");
      dem["materials"].push_back(std::move(object));
      listed.push_back(name);
    };
    for (const char* list : {"particles", "walls"}) {
      number = 0;
      for (const json* user : elements(dem, list)) use(*user, fmt::format("dem.{}[{}]", list, number++));
    }
    if (document_.contains("mbd")) {
      number = 0;
      for (json* body : elements(document_["mbd"], "bodies")) {
        std::size_t shapes = 0;
        for (const json* shape : elements(*body, "shapes")) {
          const std::string path = fmt::format("mbd.bodies[{}].shapes[{}]", number, shapes++);
          if (word(*shape, "use") == "wall") use(*shape, path);
        }
        ++number;
      }
    }
    for (std::size_t i = 0; i < completed_.size(); ++i)
      for (std::size_t k = i; k < completed_.size(); ++k) fill_pair(dem, completed_[i], completed_[k]);
  }

  // What the scene says of the pair, or of both materials, stays.
  void fill_pair(json& dem, const std::string& a, const std::string& b) {
    const LibraryPair* known = find_library_pair(a, b);
    if (!known || (dem.contains("pairs") && !dem["pairs"].is_array())) return;
    const auto gives = [&](const std::string& name, const char* key) {
      return std::ranges::any_of(elements(dem, "materials"), [&](const json* object) {
        return word(*object, "name") == name && object->contains(key);
      });
    };
    json* pair = nullptr;
    for (json* each : elements(dem, "pairs"))
      if ((word(*each, "a") == a && word(*each, "b") == b) ||
          (word(*each, "a") == b && word(*each, "b") == a))
        pair = each;
    json added{{"a", a}, {"b", b}};
    json& target = pair ? *pair : added;
    const auto add = [&](const char* key, const std::optional<double>& value) {
      if (!value || target.contains(key) || (gives(a, key) && gives(b, key))) return;
      take(target, key, *value, a + "-" + b, "-");
    };
    add("restitution", known->restitution);
    add("friction", known->friction);
    if (pair || added.size() == 2) return;
    for (const char* key : {"restitution", "friction"})
      if (!added.contains(key) && !(gives(a, key) && gives(b, key)) && meet(dem, a, b))
        fail(origin_, "dem.pairs", fmt::format("the library has no {} of '{}' on '{}'", key, a, b),
             fmt::format(R"(add {{"a": "{}", "b": "{}", "{}": ...}} to dem.pairs)", a, b, key));
    dem["pairs"].push_back(std::move(added));
  }

  // Is one of them that of particles, under a law that needs restitution and friction?
  static bool meet(json& dem, const std::string& a, const std::string& b) {
    const std::string law = word(dem, "contact");
    if (law == "paper" || law == "hertz_frictionless") return false;
    return std::ranges::any_of(elements(dem, "particles"), [&](const json* group) {
      const std::string name = word(*group, "material");
      return name == a || name == b;
    });
  }

  void fill_liquids(json& sph) {
    std::size_t number = 0;
    for (json* liquid : elements(sph, "liquids")) {
      const std::string path = fmt::format("sph.liquids[{}]", number++);
      const LibraryMaterial* material = find_library_material(word(*liquid, "name"));
      if (!material || !material->viscosity) continue;
      take_figure(*liquid, "density", material->density, *material, "kg/m3", path);
      take_figure(*liquid, "viscosity", material->viscosity, *material, "Pa s", path);
    }
  }

  json& document_;
  const std::string& origin_;
  std::vector<std::string> completed_;  // materials of grains
  std::vector<Parameter> taken_;
};

// Misspelt names of the library, before others say what their figures lack.
class NameCheck {
 public:
  NameCheck(const nlohmann::json& dem, const std::string& origin) : dem_(dem), origin_(origin) {}

  void of_list() {
    if (!dem_.contains("materials") || !dem_["materials"].is_array()) return;
    for (std::size_t i = 0; i < dem_["materials"].size(); ++i) {
      const nlohmann::json& material = dem_["materials"][i];
      if (material.is_string()) expect_object(material, i);
      const std::string name = word(material, "name");
      listed_.push_back(name);
      if (find_library_material(name)) continue;
      const std::string* meant = nearest_name(name, library_);
      for (const char* key : {"density", "young", "poisson"})
        if (meant && material.is_object() && !material.contains(key))
          fail(origin_, fmt::format("dem.materials[{}]", i),
               fmt::format("the key '{}' is missing, and '{}' is no material of the library", key,
                           shortened(name)),
               fmt::format("did you mean '{}'? if not, add {}", *meant, key));
    }
  }

  void of_users(const nlohmann::json& users, const std::string& list, bool walls_only) const {
    if (!users.is_array()) return;
    for (std::size_t i = 0; i < users.size(); ++i) {
      const std::string name = word(users[i], "material");
      if (name.empty() || (walls_only && word(users[i], "use") != "wall") || find_library_material(name) ||
          std::ranges::find(listed_, name) != listed_.end())
        continue;
      // The names of the scene come first, and have a check of their own.
      if (!listed_.empty() && (nearest_name(name, listed_) || !nearest_name(name, library_))) continue;
      fail(origin_, fmt::format("{}[{}].material", list, i),
           fmt::format("'{}' is no material of the scene or of the library", shortened(name)),
           suggest_name(name, library_, "materials of the library"));
    }
  }

 private:
  // "materials": ["steel"]
  void expect_object(const nlohmann::json& material, std::size_t i) const {
    const std::string name = material;
    const bool is_known = std::ranges::find(library_, name) != library_.end();
    fail(origin_, fmt::format("dem.materials[{}]", i),
         fmt::format("the value is \"{}\", and each material is an object", shortened(name)),
         is_known
             ? fmt::format("write {{\"name\": \"{}\"}}, which the library completes", name)
             : fmt::format("write {{\"name\": \"{}\", \"density\": ..., \"young\": ..., \"poisson\": ...}}{}",
                           shortened(name),
                           nearest_name(name, library_)
                               ? ", or did you mean '" + *nearest_name(name, library_) + "'?"
                               : std::string()));
  }

 private:
  static std::string word(const nlohmann::json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_string()
               ? object[key].get<std::string>()
               : "";
  }

  const nlohmann::json& dem_;
  const std::string& origin_;
  std::vector<std::string> listed_;
  const std::vector<std::string> library_ = library_solids();
};

// A liquid that leaves its density or viscosity to the library.
void expect_known_liquids(const nlohmann::json& sph, const std::string& origin) {
  if (!sph.is_object() || !sph.contains("liquids") || !sph["liquids"].is_array()) return;
  for (std::size_t i = 0; i < sph["liquids"].size(); ++i) {
    const nlohmann::json& liquid = sph["liquids"][i];
    if (!liquid.is_object() || !liquid.contains("name") || !liquid["name"].is_string()) continue;
    const char* missing = !liquid.contains("density")     ? "density"
                          : !liquid.contains("viscosity") ? "viscosity"
                                                          : nullptr;
    const std::string name = liquid["name"];
    const LibraryMaterial* material = find_library_material(name);
    if (!missing || (material && material->viscosity)) continue;
    const std::vector<std::string> liquids = library_liquids();
    const std::string* meant = nearest_name(name, liquids);
    if (!material && !meant) continue;
    fail(origin, fmt::format("sph.liquids[{}]", i),
         fmt::format("the key '{}' is missing, and '{}' is {}", missing, shortened(name),
                     material ? "a solid of the library" : "no liquid of the library"),
         material ? fmt::format("give density and viscosity, or take a liquid such as '{}'", liquids.front())
                  : fmt::format("did you mean '{}'? if not, add {}", *meant, missing));
  }
}

}  // namespace
}  // namespace material_values

void expect_known_materials(const nlohmann::json& document, const std::string& origin) {
  if (!document.is_object()) return;
  if (document.contains("sph")) material_values::expect_known_liquids(document["sph"], origin);
  if (!document.contains("dem") || !document["dem"].is_object()) return;
  const nlohmann::json& dem = document["dem"];
  material_values::NameCheck names(dem, origin);
  names.of_list();
  for (const char* list : {"particles", "walls"})
    if (dem.contains(list)) names.of_users(dem[list], std::string("dem.") + list, false);
  if (!document.contains("mbd") || !document["mbd"].is_object() || !document["mbd"].contains("bodies"))
    return;
  const nlohmann::json& bodies = document["mbd"]["bodies"];
  for (std::size_t i = 0; bodies.is_array() && i < bodies.size(); ++i)
    if (bodies[i].is_object() && bodies[i].contains("shapes"))
      names.of_users(bodies[i]["shapes"], fmt::format("mbd.bodies[{}].shapes", i), true);
}

bool may_use_library(const std::string& text) {
  return std::ranges::any_of(library_materials(), [&](const LibraryMaterial& material) {
    return text.find(fmt::format("\"{}\"", material.name)) != std::string::npos;
  });
}

std::vector<Parameter> put_in_materials(nlohmann::ordered_json& document, const std::string& origin) {
  return material_values::Filler(document, origin).fill();
}

}  // namespace tandem::scene

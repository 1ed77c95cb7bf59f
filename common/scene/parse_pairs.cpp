// The constants of contacts: given for a pair, or combined from those of its two materials.
#include <algorithm>
#include <cmath>

#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

// Value of a pair of materials that is not given: a geometric mean keeps the value of two equal materials,
// and is zero if one of them is.
double geometric_mean(double a, double b) {
  return std::sqrt(a * b);
}
// For two springs in series, each one half of a contact.
double harmonic_mean(double a, double b) {
  return 2 * a * b / (a + b);
}
// Dupre's work of adhesion with Berthelot's rule for the interface: gamma_a + gamma_b - gamma_ab.
double work_of_adhesion(double a, double b) {
  return 2 * std::sqrt(a * b);
}

struct Constant {
  const char* key;  // of the pair
  double Pair::*value;
  const char* material_key;  // of the materials; null: only the pair can give it
  double (*combine)(double, double);
};

constexpr Constant constants[] = {
    {"restitution", &Pair::restitution, "restitution", geometric_mean},
    {"friction", &Pair::friction, "friction", geometric_mean},
    {"normal_stiffness", &Pair::normal_stiffness, nullptr, nullptr},
    {"normal_damping", &Pair::normal_damping, nullptr, nullptr},
    {"tangential_stiffness", &Pair::tangential_stiffness, nullptr, nullptr},
    {"tangential_damping", &Pair::tangential_damping, nullptr, nullptr},
    {"spring_stiffness", &Pair::spring_stiffness, "spring_stiffness", harmonic_mean},
    {"spring_ratio", &Pair::spring_ratio, nullptr, nullptr},
    {"work_of_adhesion", &Pair::work_of_adhesion, "surface_energy", work_of_adhesion},
    {"cohesion_energy_density", &Pair::cohesion_energy_density, "cohesion_energy_density", geometric_mean},
    {"rolling_friction", &Pair::rolling_friction, "rolling_friction", geometric_mean},
    {"rolling_damping", &Pair::rolling_damping, "rolling_damping", geometric_mean},
    {"wear_coefficient", &Pair::wear_coefficient, nullptr, nullptr},
};

struct Need {
  std::string key, by;  // a constant, and the materials or pairs that lack it
};

std::vector<Need> needs(const Dem& dem) {
  std::vector<Need> result;
  const auto add = [&](std::initializer_list<const char*> keys, const std::string& by) {
    for (const char* key : keys) result.push_back({key, by});
  };
  switch (dem.contact) {
    case ContactLaw::hertz_mindlin:
      add({"restitution", "friction"}, "contact 'hertz_mindlin'");
      break;
    case ContactLaw::hertz_frictionless:
      add({"restitution"}, "contact 'hertz_frictionless'");
      break;
    case ContactLaw::paper:
      add({"friction", "normal_stiffness", "normal_damping", "tangential_stiffness", "tangential_damping"},
          "contact 'paper'");
      break;
    case ContactLaw::hooke:
      add({"restitution", "friction", "spring_stiffness"}, "contact 'hooke'");
      break;
    case ContactLaw::jkr:
      add({"restitution", "friction", "work_of_adhesion"}, "contact 'jkr'");
      break;
    case ContactLaw::sjkr:
      add({"restitution", "friction", "cohesion_energy_density"}, "contact 'sjkr'");
      break;
  }
  if (dem.rolling) add({"rolling_friction", "rolling_damping"}, "rolling 'elastic_plastic'");
  return result;
}

const Constant* find(const std::string& key) {
  for (const Constant& c : constants)
    if (c.key == key) return &c;
  return nullptr;
}

// Sets the constant from the two materials where both have it.
bool combine(const Constant& c, const Node& a, const Node& b, Pair& pair) {
  if (c.material_key == nullptr || !a.has(c.material_key) || !b.has(c.material_key)) return false;
  pair.*c.value =
      c.combine(a.value().at(c.material_key).get<double>(), b.value().at(c.material_key).get<double>());
  return true;
}

}  // namespace

// A pair may have the constants of laws other than the scene's, so that laws can be compared with one file;
// those of the scene's law have no default. Two materials without a pair get one if they have all constants
// of the law.
void parse_pairs(const Node& node, Dem& dem) {
  const Names names = node.names("materials");
  const std::vector<Node> materials = node.elements("materials");
  const std::vector<Need> needed = needs(dem);
  std::vector<bool> given(materials.size() * materials.size());
  for (const Node& from : node.elements("pairs")) {
    Pair pair{MaterialId{from.resolve("a", names, "materials")},
              MaterialId{from.resolve("b", names, "materials")}};
    const Node &a = materials[pair.a.value], &b = materials[pair.b.value];
    for (const Constant& c : constants)
      if (from.has(c.key))
        from.read(c.key, pair.*c.value);
      else
        combine(c, a, b, pair);
    for (const Need& need : needed) {
      Pair unused;
      const Constant& c = *find(need.key);
      if (from.has(c.key) || combine(c, a, b, unused)) continue;
      std::string hint = need.by + " needs it for every pair";
      if (c.material_key != nullptr) hint += std::string(", or '") + c.material_key + "' for both materials";
      from.fail("the key '" + need.key + "' is missing", hint);
    }
    given[pair.a.value * materials.size() + pair.b.value] = true;
    given[pair.b.value * materials.size() + pair.a.value] = true;
    dem.pairs.push_back(pair);
  }
  for (std::uint32_t a = 0; a < materials.size(); ++a)
    for (std::uint32_t b = a; b < materials.size(); ++b) {
      if (given[a * materials.size() + b]) continue;
      Pair pair{MaterialId{a}, MaterialId{b}};
      for (const Constant& c : constants) combine(c, materials[a], materials[b], pair);
      const auto lacks = [&](const Need& need) {
        return !combine(*find(need.key), materials[a], materials[b], pair);
      };
      const auto first = std::ranges::find_if(needed, lacks);
      if (first == needed.end()) {
        dem.pairs.push_back(pair);
      } else if (!std::ranges::all_of(needed, lacks)) {
        const char* of_materials = find(first->key)->material_key;
        dem.incomplete_pairs.push_back({MaterialId{a}, MaterialId{b},
                                        of_materials ? of_materials : first->key, first->by,
                                        of_materials != nullptr});
      }
    }
}

}  // namespace tandem::scene

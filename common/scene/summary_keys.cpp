#include "common/scene/summary_keys.hpp"

#include <algorithm>

#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"

namespace tandem::scene {
namespace {

// Scenes whose runs have a certain number.
struct Runs {
  bool (*of)(const Scene& scene);
  const char* need;
};

bool has_traffic(const Scene& scene) {
  if (!scene.dem) return false;
  const auto& groups = scene.dem->particles;
  return !scene.dem->outlets.empty() ||
         std::any_of(groups.begin(), groups.end(), [](const ParticleGroup& group) {
           return std::holds_alternative<InletFill>(group.fill);
         });
}

bool is_packed(const ParticleGroup& group) {
  return std::holds_alternative<PackingFill>(group.fill);
}
bool is_placed(const ParticleGroup& group, bool settles) {
  const bool moves = !group.fixed && !std::holds_alternative<InletFill>(group.fill);
  return is_packed(group) || std::holds_alternative<RunFill>(group.fill) || (settles && moves);
}
bool has_settled(const Scene& scene) {
  return scene.dem && scene.dem->settle;
}
bool has_packing(const Scene& scene) {
  return scene.dem && std::ranges::any_of(scene.dem->particles, is_packed);
}
bool has_placed(const Scene& scene) {
  return scene.dem && std::ranges::any_of(scene.dem->particles, [&](const ParticleGroup& group) {
           return is_placed(group, has_settled(scene));
         });
}

bool has_belts(const Scene& scene) {
  return scene.dem && std::ranges::any_of(scene.dem->walls,
                                          [](const Wall& wall) { return wall.surface_velocity.has_value(); });
}

bool has_tyres(const Scene& scene) {
  return scene.mbd && std::ranges::any_of(scene.mbd->forces, [](const Force& force) {
           return std::holds_alternative<Tyre>(force);
         });
}

namespace runs_of {
const Runs none{nullptr, ""};
const Runs any{[](const Scene&) { return true; }, "all scenes"};
const Runs mbd{[](const Scene& scene) { return scene.mbd.has_value(); }, "scenes with 'mbd'"};
const Runs dem{[](const Scene& scene) { return scene.dem.has_value(); }, "scenes with 'dem'"};
const Runs sph{[](const Scene& scene) { return scene.sph.has_value(); }, "scenes with 'sph'"};
const Runs coupled{[](const Scene& scene) { return scene.mbd && scene.has_particles(); },
                   "scenes with 'mbd' and particles"};
const Runs traffic{has_traffic, "scenes with inlets or outlets"};
const Runs liquid_traffic{[](const Scene& scene) {
                            return scene.sph && !(scene.sph->inlets.empty() && scene.sph->outlets.empty());
                          },
                          "scenes with sph.inlets or sph.outlets"};
const Runs placed{has_placed, "scenes with a packing, a fill from a run or settle"};
const Runs packed{has_packing, "scenes with a packing"};
const Runs settled{has_settled, "scenes with dem.settle"};
const Runs belts{has_belts, "scenes with walls that have a surface_velocity"};
const Runs elements{[](const Scene& scene) { return !elements_of(scene).empty(); },
                    "scenes with forces, couplers or driven joints"};
const Runs contact{[](const Scene& scene) { return scene.contact.has_value(); }, "scenes with mbd.contact"};
const Runs tyres_and_contact{[](const Scene& scene) { return scene.contact && has_tyres(scene); },
                             "scenes with tyres and mbd.contact"};
const Runs sensors{[](const Scene& scene) { return !sensor_columns(scene).empty(); },
                   "scenes with dem.sensors or sph.sensors"};
const Runs dissipation{[](const Scene& scene) { return scene.output.dissipation; },
                       "scenes with output.dissipation"};
const Runs adaptive{[](const Scene& scene) { return scene.coupling.adaptive.has_value(); },
                    "scenes with coupling.adaptive"};
}  // namespace runs_of

struct Key {
  const Runs* runs;
  std::string text;
};

// The lines of figures.def that are numbers.
const std::vector<Key>& table() {
  static const std::vector<Key> keys = [] {
    enum Type { Text, Texts, Count, Number, Estimate };
    std::vector<Key> list;
    const auto add = [&](const Runs& runs, const std::string& key) {
      if (runs.of != nullptr) list.push_back({&runs, key});
    };
    const auto add_fact = [&](const Runs& runs, Type type, const char* solver, const char* key) {
      if (type != Text && type != Texts) add(runs, summary_key(solver, key));
    };
#define MBD_FACT(runs, type, member, key, ...) add_fact(runs_of::runs, type, "mbd", key);
#define DEM_FACT(runs, type, member, key, ...) add_fact(runs_of::runs, type, "dem", key);
#define SPH_FACT(runs, type, member, key, ...) add_fact(runs_of::runs, type, "sph", key);
#define COORDINATOR_KEY(runs, key, meaning) add(runs_of::runs, key);
#define NUMBER(runs, key) add(runs_of::runs, key);
#include "common/scene/figures.def"
    return list;
  }();
  return keys;
}

// The names in this scene for which a word of the table stands.
std::vector<std::string> names_of(const std::string& word, const Scene& scene) {
  std::vector<std::string> names;
  if (word == "BODY" && scene.mbd)
    for (const Body& body : scene.mbd->bodies) names.push_back(body.name);
  if (word == "INLET" && scene.dem)
    for (const ParticleGroup& group : scene.dem->particles)
      if (std::holds_alternative<InletFill>(group.fill)) names.push_back(group.name);
  if (word == "FILL" && scene.dem)
    for (const ParticleGroup& group : scene.dem->particles)
      if (is_placed(group, has_settled(scene))) names.push_back(group.name);
  if (word == "PACKING" && scene.dem)
    for (const ParticleGroup& group : scene.dem->particles)
      if (is_packed(group)) names.push_back(group.name);
  if (word == "OUTLET" && scene.dem)
    for (const Outlet& outlet : scene.dem->outlets) names.push_back(outlet.name);
  if (word == "FEED" && scene.sph)
    for (const LiquidInlet& inlet : scene.sph->inlets) names.push_back(inlet.name);
  if (word == "DRAIN" && scene.sph)
    for (const Outlet& outlet : scene.sph->outlets) names.push_back(outlet.name);
  if (word == "COLUMN") return element_columns(scene);
  if (word == "SENSED") return sensor_columns(scene);
  if (word == "WALL" && scene.dem)
    for (const Wall& wall : scene.dem->walls)
      if (wall.surface_velocity) names.push_back(wall.name);
  return names;
}

}  // namespace

std::string summary_key(std::string_view solver, const std::string& fact) {
  if (solver == "sph") return "sph." + fact;
  return fact == "solver_seconds" ? std::string(solver) + "_" + fact : fact;
}

std::vector<std::string> summary_keys(const Scene& scene) {
  std::vector<std::string> keys;
  for (const Key& key : table()) {
    if (!key.runs->of(scene)) continue;
    std::size_t at = std::string::npos;
    for (const std::string word :
         {"BODY", "INLET", "FILL", "PACKING", "OUTLET", "FEED", "DRAIN", "WALL", "COLUMN", "SENSED"}) {
      at = key.text.find("." + word);
      if (at == std::string::npos) continue;
      for (const std::string& name : names_of(word, scene))
        keys.push_back(std::string(key.text).replace(at + 1, word.size(), name));
      break;
    }
    if (at == std::string::npos) keys.push_back(key.text);
  }
  return keys;
}

std::string runs_with(const std::string& key) {
  for (const Key& known : table())
    if (known.text == key) return known.runs->need;
  return {};
}

}  // namespace tandem::scene

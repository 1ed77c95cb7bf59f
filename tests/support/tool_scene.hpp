// A scene whose domain follows a body.
#pragma once

#include <nlohmann/json.hpp>

namespace tandem::test {

// A tool above a floor, and spheres of 1 cm.
inline nlohmann::json tool_scene(const nlohmann::json& dem = nlohmann::json::object()) {
  nlohmann::json all = {{"materials",
                         {{{"name", "m"},
                           {"density", 2500},
                           {"young", 1e7},
                           {"poisson", 0.25},
                           {"restitution", 0.5},
                           {"friction", 0.4}}}},
                        {"particles",
                         {{{"name", "p"},
                           {"material", "m"},
                           {"radius", 0.01},
                           {"fill",
                            {{"type", "lattice"},
                             {"min", {0, 0, 0}},
                             {"max", {0.5, 0.1, 0.1}},
                             {"spacing", 0.025},
                             {"jitter", 0}}}}}},
                        {"walls",
                         {{{"name", "blade"},
                           {"body", "tool"},
                           {"material", "m"},
                           {"shape", {{"type", "box"}, {"size", {0.01, 0.08, 0.02}}}}},
                          {{"name", "floor"},
                           {"material", "m"},
                           {"shape", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}}}},
                        {"domain", {{"min", {0, 0, -0.01}}, {"max", {0.5, 0.1, 0.3}}, {"follows", "tool"}}}};
  all.update(dem);
  return {{"tandem", "1.0"},
          {"name", "tool"},
          {"end_time", 1},
          {"coupling", {{"window", 0.001}}},
          {"mbd",
           {{"bodies",
             {{{"name", "tool"}, {"mass", 1}, {"inertia", {1, 1, 1}}, {"position", {0.4, 0.05, 0.2}}}}}}},
          {"dem", all}};
}

}  // namespace tandem::test

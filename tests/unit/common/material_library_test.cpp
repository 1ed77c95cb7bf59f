// The library of materials: its page, and scenes that take figures from it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/scene/material_library.hpp"
#include "common/scene/parameters.hpp"
#include "common/scene/parse.hpp"

namespace tandem::scene {
namespace material_library_test {

using testing::HasSubstr;
using testing::Not;

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:g}", *value) : "";
}

TEST(MaterialLibrary, PageHasEveryFigureWithItsSource) {
  const std::string page = read_input(TANDEM_SOURCE_DIR "/docs/materials.md", {.largest = largest_text});
  EXPECT_GE(library_materials().size(), 25u);
  for (const LibraryMaterial& m : library_materials()) {
    const std::string figures =
        m.viscosity ? number(m.viscosity) : number(m.young) + " | " + number(m.poisson);
    EXPECT_THAT(page,
                HasSubstr(fmt::format("| `{}` | {:g} | {} | {} |\n", m.name, m.density, figures, m.source)));
  }
  for (const LibraryPair& p : library_pairs()) {
    EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` | `{}` | {} | {} | {} |\n", p.a, p.b,
                                            number(p.restitution), number(p.friction), p.source)));
    EXPECT_TRUE(find_library_material(p.a) && find_library_material(p.b)) << p.a << " " << p.b;
  }
}

TEST(MaterialLibrary, FiguresArePossible) {
  for (const LibraryMaterial& m : library_materials()) {
    SCOPED_TRACE(m.name);
    EXPECT_TRUE(m.density > 800 && m.density < 12000);
    EXPECT_EQ(m.viscosity.has_value(), std::string(m.kind) == "liquid");
    EXPECT_TRUE(!m.young || (*m.young > 1e8 && *m.young < 3e11));
    EXPECT_TRUE(!m.poisson || (*m.poisson > 0 && *m.poisson < 0.5));
  }
}

// Spheres of `material` on a floor of `wall`; `dem`: more keys of dem.
std::string scene_of(const std::string& material, const std::string& wall, const std::string& dem) {
  return R"({"tandem": "1.1", "name": "bed", "end_time": 0.001, "coupling": {"window": 0.001}, "dem": {)" +
         dem + R"("particles": [{"name": "spheres", "material": ")" + material + R"(",
              "radius": 0.005,
              "fill": {"type": "lattice", "min": [0, 0, 0.1], "max": [0.05, 0.05, 0.15], "spacing": 0.02}}],
            "walls": [{"name": "floor", "material": ")" +
         wall + R"(", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
            "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}}})";
}

// The error of reading the scene, or nothing.
std::string refusal(std::string text) {
  try {
    put_in_parameters(text, {}, "bed.json");
    validate(parse(text, "bed.json"), "bed.json");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(MaterialLibrary, ASceneOfGlassNeedsNoFigures) {
  std::string text = scene_of("glass", "glass", "");
  const std::vector<Parameter> taken = put_in_parameters(text, {}, "bed.json");
  const Scene scene = parse(text, "bed.json");
  ASSERT_EQ(scene.dem->materials.size(), 1u);
  EXPECT_EQ(scene.dem->materials[0].density, 2500);
  EXPECT_EQ(scene.dem->materials[0].young, 71e9);
  EXPECT_EQ(scene.dem->materials[0].poisson, 0.22);
  ASSERT_EQ(scene.dem->pairs.size(), 1u);
  EXPECT_EQ(scene.dem->pairs[0].restitution, 0.97);
  EXPECT_EQ(scene.dem->pairs[0].friction, 0.092);
  std::vector<std::string> names;
  for (const Parameter& figure : taken) names.push_back(figure.name);
  EXPECT_THAT(names, testing::ElementsAre("glass.density", "glass.young", "glass.poisson",
                                          "glass-glass.restitution", "glass-glass.friction"));
}

TEST(MaterialLibrary, WhatTheSceneSaysStays) {
  std::string text = scene_of("glass", "glass", R"("materials": [{"name": "glass", "young": 1e7}],
      "pairs": [{"a": "glass", "b": "glass", "friction": 0.5}],)");
  put_in_parameters(text, {}, "bed.json");
  const Scene scene = parse(text, "bed.json");
  EXPECT_EQ(scene.dem->materials[0].young, 1e7);
  EXPECT_EQ(scene.dem->materials[0].poisson, 0.22);
  EXPECT_EQ(scene.dem->pairs[0].friction, 0.5);
  EXPECT_EQ(scene.dem->pairs[0].restitution, 0.97);
  // Nothing is added to a scene that has all figures.
  const std::string whole =
      scene_of("glass", "glass", R"("materials": [{"name": "glass", "density": 2400, "young": 1e7,
      "poisson": 0.3, "restitution": 0.9, "friction": 0.3}],)");
  text = whole;
  EXPECT_TRUE(put_in_parameters(text, {}, "bed.json").empty());
  EXPECT_EQ(text, whole);
}

TEST(MaterialLibrary, WhatNoSourceHasIsRefusedByName) {
  EXPECT_THAT(
      refusal(scene_of("ptfe", "steel", "")),
      HasSubstr("the library has no 'poisson' of the plastic 'ptfe' (give poisson in the list of materials"));
  // Sand on sand has no source at all; sand on steel has a friction only.
  const std::string sand = R"("pairs": [{"a": "sand", "b": "sand", "restitution": 0.5, "friction": 0.5}],)";
  EXPECT_THAT(refusal(scene_of("sand", "steel", sand)), HasSubstr("the library has no restitution of"));
  const std::string unknown = refusal(scene_of("glass", "steel", ""));
  EXPECT_THAT(unknown, HasSubstr("glass"));
  EXPECT_THAT(unknown, HasSubstr("steel"));
  EXPECT_THAT(refusal(scene_of("water", "steel", "")),
              HasSubstr("dem.particles[0].material: 'water' is a liquid of the library, which grains and "
                        "their walls cannot "
                        "be of (write it as a liquid, \"sph\": {\"liquids\": [{\"name\": \"water\", ...}]}, "
                        "or take a solid"));
  EXPECT_THAT(refusal(scene_of("mud", "mud", R"("materials": [{"name": "mud", "density": 1500}],)")),
              HasSubstr("dem.materials[0]: the key 'young' is missing"));
}

TEST(MaterialLibrary, AMisspeltNameGetsTheNearestOne) {
  EXPECT_THAT(
      refusal(scene_of("glass", "stel", "")),
      HasSubstr("dem.walls[0].material: 'stel' is no material of the scene or of the library (did you "
                "mean 'steel'?)"));
  EXPECT_THAT(refusal(scene_of("glas", "glas", R"("materials": [{"name": "glas"}],)")),
              HasSubstr("dem.materials[0]: the key 'density' is missing, and 'glas' is no material of the "
                        "library (did you mean "
                        "'glass'? if not, add density)"));
  EXPECT_THAT(
      refusal(scene_of("unobtainium", "unobtainium", "")),
      HasSubstr(
          "'unobtainium' is no material of the scene or of the library (known materials of the library: "));
  EXPECT_THAT(refusal(scene_of("steel", "steel", R"("materials": ["steel"],)")),
              HasSubstr("dem.materials[0]: the value is \"steel\", and each material is an object (write "
                        "{\"name\": \"steel\"}, "
                        "which the library completes)"));
  EXPECT_THAT(refusal(scene_of("stel", "steel", R"("materials": ["stel"],)")),
              HasSubstr("or did you mean 'steel'?"));
  EXPECT_THAT(refusal(scene_of("steel", "steel", R"("materials": {"steel": {}},)")),
              HasSubstr("dem.materials: the value is an object (give a list"));
  // Grains are of no liquid, and liquids of no solid.
  const std::string watr = refusal(scene_of("watr", "steel", ""));
  EXPECT_THAT(watr, HasSubstr("'watr' is no material of the scene or of the library (known materials"));
  EXPECT_THAT(watr, Not(HasSubstr("water")));
  const auto liquid = [](const std::string& name) {
    return R"({"tandem": "1.1", "name": "x", "sph": {"liquids": [{"name": ")" + name + R"(", "fill": []}]}})";
  };
  EXPECT_THAT(refusal(liquid("watr")),
              HasSubstr("sph.liquids[0]: the key 'density' is missing, and 'watr' is no liquid of "
                        "the library (did you mean 'water'? if not, add density)"));
  EXPECT_THAT(refusal(liquid("steel")),
              HasSubstr("'steel' is a solid of the library (give density and viscosity, or take a "
                        "liquid such as"));
  EXPECT_THAT(refusal(liquid("stel")), Not(HasSubstr("steel")));
  // The names of the scene come first, and what has all its figures may have any name.
  const std::string gras =
      R"("materials": [{"name": "gras", "density": 1, "young": 1e7, "poisson": 0.3, "restitution": 0.5, "friction": 0.5}],)";
  EXPECT_EQ(refusal(scene_of("gras", "gras", gras)), "");
  EXPECT_THAT(refusal(scene_of("gras", "grass", gras)), HasSubstr("did you mean 'gras'?"));
}

TEST(MaterialLibrary, LiquidsTakeDensityAndViscosity) {
  std::string text =
      R"({"tandem": "1.1", "name": "x", "sph": {"liquids": [{"name": "engine_oil", "fill": []}]}})";
  const std::vector<Parameter> taken = put_in_parameters(text, {}, "x.json");
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_THAT(text, HasSubstr("884.1"));
  EXPECT_THAT(text, HasSubstr("0.486"));
}

}  // namespace material_library_test
}  // namespace tandem::scene

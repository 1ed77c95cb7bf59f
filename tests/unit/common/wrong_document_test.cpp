// Wrong scenes: the document as a whole, coupling, output and checks.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

const WrongScene wrong_document[] = {
    {"UnknownTopLevelKey", R"([{"op": "add", "path": "/gravty", "value": [0, 0, -9.81]}])",
     "unknown key 'gravty' (did you mean 'gravity'?)"},
    {"MissingName", R"([{"op": "remove", "path": "/name"}])",
     "the key 'name' is missing (add name: name of the scene)"},
    {"NameWithABlank", R"([{"op": "replace", "path": "/name", "value": "my machine"}])",
     "name: the value is \"my machine\" (give a word of letters, digits, _ and -: name of the scene)"},
    {"OtherFormatVersion", R"([{"op": "replace", "path": "/tandem", "value": "2.0"}])",
     "tandem: the value is \"2.0\" (did you mean '1.0'?)"},
    {"FormatVersionAsNumber", R"([{"op": "replace", "path": "/tandem", "value": 1.0}])",
     "tandem: the value is 1 (give a string: version of the scene format)"},
    {"ZeroEndTime", R"([{"op": "replace", "path": "/end_time", "value": 0}])",
     "end_time: the value is 0 (give a number from 1e-09 to 1e+09: simulated time, a whole number of windows "
     "[s])"},
    {"EndTimeAsText", R"([{"op": "replace", "path": "/end_time", "value": "0.5 s"}])",
     "end_time: the value is \"0.5 s\" (give a number: simulated time, a whole number of windows [s])"},
    {"EndTimeBeyondTheClock", R"([{"op": "replace", "path": "/end_time", "value": 1000000000000.0}])",
     "end_time: the value is 1e+12 (give a number from 1e-09 to 1e+09: simulated time, a whole number of "
     "windows [s])"},
    {"EndTimeNotWholeWindows", R"([{"op": "replace", "path": "/end_time", "value": 0.5005}])",
     "end_time: 0.5005 s is not a whole multiple of the window of 0.001 s (the nearest is 0.501 s)"},
    {"GravityAsNumber", R"([{"op": "replace", "path": "/gravity", "value": -9.81}])",
     "gravity: the value is -9.81 (give a list of 3 numbers: acceleration of gravity, world axes [m/s2])"},
    {"GravityOfTwoNumbers", R"([{"op": "replace", "path": "/gravity", "value": [0, -9.81]}])",
     "gravity: the value is [0,-9.81] (give a list of 3 numbers: acceleration of gravity, world axes "
     "[m/s2])"},
    {"GravityWithText", R"([{"op": "replace", "path": "/gravity", "value": [0, 0, "down"]}])",
     "gravity[2]: the value is \"down\" (give a number: acceleration of gravity, world axes [m/s2])"},
    {"UnknownScheme", R"([{"op": "replace", "path": "/coupling/scheme", "value": "dem_frist"}])",
     "coupling.scheme: the value is \"dem_frist\" (did you mean 'dem_first'?)"},
    {"SchemeAsNumber", R"([{"op": "replace", "path": "/coupling/scheme", "value": 1}])",
     "coupling.scheme: the value is 1 (give a string: order of work in a window)"},
    {"NegativeWindow", R"([{"op": "replace", "path": "/coupling/window", "value": -0.001}])",
     "coupling.window: the value is -0.001 (give a number from 1e-09 to 1e+09: macro step, a whole number of "
     "nanoseconds "
     "[s])"},
    {"WindowOfHalfANanosecond", R"([{"op": "replace", "path": "/coupling/window", "value": 1.5e-09}])",
     "coupling.window: the window of 1.5e-09 s is not a whole number of nanoseconds (give a multiple of 1e-9 "
     "s)"},
    {"WindowBelowANanosecond", R"([{"op": "replace", "path": "/coupling/window", "value": 1e-12}])",
     "coupling.window: the value is 1e-12 (give a number from 1e-09 to 1e+09: macro step, a whole number of "
     "nanoseconds [s])"},
    {"UnknownLoadShape", R"([{"op": "add", "path": "/coupling/load", "value": "maen"}])",
     "coupling.load: the value is \"maen\" (did you mean 'mean'?)"},
    {"HeldLoadWithASlope", R"([{"op": "add", "path": "/coupling/load", "value": "linear"}])",
     "coupling.load: a load that is held until the next window has no slope there (use \"mean\", or scheme "
     "dem_first)"},
    {"LinearLoadOfLinearImplicit",
     R"([{"op": "replace", "path": "/coupling", "value": {"scheme": "linear_implicit", "load": "linear"}}])",
     "coupling.load: scheme linear_implicit knows the mean of the load only (use \"mean\")"},
    {"EndLoadOfAnImplicitScheme",
     R"([{"op": "replace", "path": "/coupling", "value": {"scheme": "implicit", "load": "end"}}])",
     "coupling.load: the end value does not conserve the impulse, which this scheme is made for (use "
     "\"mean\")"},
    {"QuadraticPathOfMbdFirst", R"([{"op": "add", "path": "/coupling/path", "value": "quadratic"}])",
     "coupling.path: only the schemes dem_first and implicit follow a quadratic path (leave it out, or use "
     "scheme dem_first)"},
    {"LinearLoadAlongAStraightPath",
     R"([{"op": "replace", "path": "/coupling", "value": {"scheme": "dem_first", "load": "linear"}}])",
     "coupling.path: a linear load along a straight path is not stable on a contact without damping (add "
     "\"path\": \"quadratic\")"},
    {"IterationWithoutImplicit", R"([{"op": "add", "path": "/coupling/iteration", "value": {}}])",
     "coupling.iteration: the scheme does not iterate (leave it out, or use scheme implicit)"},
    {"RelaxationOfTwo",
     R"([{"op": "replace", "path": "/coupling", "value": {"scheme": "implicit", "iteration": {"relaxation": 2}}}])",
     "coupling.iteration.relaxation: the value is 2 (give a number < 2: share of a correction that is taken "
     "[-])"},
    {"UnknownIterationMethod",
     R"([{"op": "replace", "path": "/coupling", "value": {"scheme": "implicit", "iteration": {"method": "aitkin"}}}])",
     "coupling.iteration.method: the value is \"aitkin\" (did you mean 'aitken'?)"},
    {"AdaptiveWithoutLimits",
     R"([{"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1e-4}}])",
     "coupling.adaptive: the key 'max_window' is missing (add max_window: longest window, a whole number of "
     "nanoseconds [s])"},
    {"AdaptiveLimitOfAHalfNanosecond",
     R"([{"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1.5e-9, "max_window": 1}}])",
     "coupling.adaptive.min_window: the window of 1.5e-09 s is not a whole number of nanoseconds (give a "
     "multiple of 1e-9 s)"},
    {"FirstWindowOutsideItsLimits",
     R"([{"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1e-5, "max_window": 1e-4}}])",
     "coupling.window: the first window of 0.001 s is not within 1e-05 s and 1e-04 s (give one within "
     "coupling.adaptive)"},
    {"AdaptiveWindowOfOneSolver",
     R"([{"op": "remove", "path": "/dem"}, {"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1e-5, "max_window": 1e-2}}])",
     "coupling.adaptive: one solver alone has no error of coupling (leave it out)"},
    {"AdaptiveWindowsOfAHeldLoad",
     R"([{"op": "add", "path": "/coupling/scheme", "value": "mbd_first"},
         {"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1e-5, "max_window": 1e-2}}])",
     "coupling.adaptive: a load that is held keeps either its force or its impulse when windows change their "
     "length "
     "(leave it out, or use scheme dem_first)"},
    {"QuadraticPathOfAMeanLoad",
     R"([{"op": "add", "path": "/coupling/scheme", "value": "implicit"},
         {"op": "add", "path": "/coupling/path", "value": "quadratic"}])",
     "coupling.path: the mean of a load belongs to a path of constant velocity (leave it out, or add "
     "\"load\": "
     "\"linear\")"},
    {"NeitherSolver", R"([{"op": "remove", "path": "/mbd"}, {"op": "remove", "path": "/dem"}])",
     "the scene has neither 'mbd' nor 'dem' nor 'sph' (give bodies, particles, a liquid, or several of "
     "them)"},
    {"FrameIntervalNotWholeWindows",
     R"([{"op": "replace", "path": "/output/frame_interval", "value": 0.0015}])",
     "output.frame_interval: 0.0015 s is not a whole multiple of the window of 0.001 s (the nearest is 0.002 "
     "s)"},
    {"FrameIntervalBelowANanosecond",
     R"([{"op": "replace", "path": "/output/frame_interval", "value": 1e-300}])",
     "output.frame_interval: 1e-300 s is not a whole multiple of the window of 0.001 s (the nearest is 0.001 "
     "s)"},
    {"FrameIntervalBelowTheShortestWindow",
     R"([{"op": "add", "path": "/coupling/adaptive", "value": {"min_window": 1e-5, "max_window": 1e-2}},
         {"op": "replace", "path": "/output/frame_interval", "value": 1e-300}])",
     "output.frame_interval: 1e-300 s is less than coupling.adaptive.min_window of 1e-05 s: each frame ends "
     "a "
     "window (give at least min_window, or 0 for the first and last frame only)"},
    {"CameraLooksAtItself", R"([{"op": "replace", "path": "/output/camera/target", "value": [3, 3, 2]}])",
     "output.camera.target: the target [3, 3, 2] is the eye itself (look at another point)"},
    {"CameraUpAlongTheView", R"([{"op": "replace", "path": "/output/camera/up", "value": [3, 3, 1]}])",
     "output.camera.up: up [3, 3, 1] is parallel to the line of sight [-3, -3, -1] (give a direction "
     "across it)"},
    {"FieldOfViewOfAHalfCircle",
     R"([{"op": "replace", "path": "/output/camera/field_of_view", "value": 180}])",
     "output.camera.field_of_view: the value is 180 (give a number < 180: horizontal opening angle [deg])"},
    {"CheckOfUnknownSignal",
     R"([{"op": "replace", "path": "/checks/0/of", "value": "crate.contact_forse.z"}])",
     "checks[0].of: unknown signal 'crate.contact_forse.z' (did you mean 'crate.contact_force.z'?)"},
    {"CheckOfUnknownBody", R"([{"op": "replace", "path": "/checks/0/of", "value": "lid.contact_force.z"}])",
     "checks[0].of: unknown signal 'lid.contact_force.z' (known bodies, joints, elements and sensors: crate, "
     "arm, "
     "ball, "
     "bird, ground, slide, hinge, socket, spring, coil)"},
    {"CheckOfAMisspeltChannel", R"([{"op": "replace", "path": "/checks/0/of", "value": "spring.lenght"}])",
     "checks[0].of: unknown signal 'spring.lenght' (did you mean 'spring.length'?)"},
    {"PlotOfUnknownSignal",
     R"([{"op": "add", "path": "/output/plots", "value": ["coil.torque", "coil.torqe"]}])",
     "output.plots[1]: unknown signal 'coil.torqe' (did you mean 'coil.torque'?)"},
    {"PlotThatNothingMatches", R"([{"op": "add", "path": "/output/plots", "value": ["*.pressure_*"]}])",
     "output.plots[0]: no signal matches '*.pressure_*' (there are, among others: coil.loss_energy, "
     "coil.loss_power, coil.stored_energy, coil.power, coil.speed, coil.torque, spring.loss_energy, "
     "spring.loss_power, spring.stored_energy, spring.power, spring.velocity, spring.length)"},
    {"FieldsOfSpheresThatFramesLack",
     R"([{"op": "add", "path": "/output/fields", "value": ["group"]}, {"op": "add", "path": "/output/particles", "value": false}])",
     "output.fields: are columns of the spheres in frames, and frames of this scene have none (leave out "
     "output.fields, or write \"particles\": true)"},
    {"WallFieldsWithoutSpheres", R"([{"op": "add", "path": "/output/wall_fields", "value": ["inside"]}])",
     "output.wall_fields: come with the spheres in frames, and frames of this scene have none (leave it out, "
     "or write \"particles\": true)"},
    {"WallFieldsOfAnUnknownWall",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "add", "path": "/output/wall_fields", "value": ["insid"]}])",
     "output.wall_fields[0]: there is no wall 'insid' (did you mean 'inside'?)"},
    {"WallFieldsOfAPlane",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "add", "path": "/output/wall_fields", "value": ["inside", "floor"]}])",
     "output.wall_fields[1]: the wall 'floor' is a plane, one surface without triangles (give a box or a "
     "mesh)"},
    {"WallFieldsOfARoundCylinder",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "remove", "path": "/dem/walls/2/shape/segments"},
         {"op": "add", "path": "/output/wall_fields", "value": ["post"]}])",
     "output.wall_fields[0]: the wall 'post' is a round cylinder, one surface without triangles (give its "
     "shape 'segments')"},
    {"WearOfAWallWithoutHardness",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "add", "path": "/dem/pairs/1/wear_coefficient", "value": 0.001},
         {"op": "add", "path": "/output/wall_fields", "value": ["inside"]}])",
     "output.wall_fields[0]: the material 'steel' of the wall 'inside' wears, with a wear_coefficient of "
     "0.001, and has no hardness (give the material 'hardness' [Pa], or leave the wear_coefficient out)"},
    {"ContactsOfABodyWithoutWalls",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "add", "path": "/output/contacts", "value": ["ground", "bird"]}])",
     "output.contacts[1]: the body 'bird' carries no wall, so that spheres pass through it (leave it out, or "
     "give it a wall)"},
    {"ContactsOfAnUnknownBody",
     R"([{"op": "add", "path": "/output/particles", "value": true}, {"op": "add", "path": "/output/contacts", "value": ["crat"]}])",
     "output.contacts: unknown name 'crat' (did you mean 'crate'?)"},
    {"DissipationOfALawThatDoesNotTellIt",
     R"([{"op": "add", "path": "/output/dissipation", "value": true}, {"op": "replace", "path": "/dem/contact", "value": "sjkr"},
         {"op": "add", "path": "/dem/materials/0/cohesion_energy_density", "value": 10}, {"op": "add", "path": "/dem/materials/1/cohesion_energy_density", "value": 10}])",
     "output.dissipation: the contact law of the scene does not tell what its dampers or its adhesion "
     "dissipate (leave it out, or choose hertz_mindlin, hertz_frictionless or hooke)"},
    {"PlotOfTooManyStars", R"([{"op": "add", "path": "/output/plots", "value": ["*a*b*c*d*"]}])",
     "output.plots[0]: '*a*b*c*d*' has more than four * (write one pattern for each chart)"},
    {"CheckOfAMisspeltNumberOfTheSummary",
     R"([{"op": "replace", "path": "/checks/0/of", "value": "summary.lost_partcles"}])",
     "checks[0].of: summary.json of this scene has no number 'lost_partcles' (did you mean "
     "'lost_particles'?)"},
    {"CheckOfTheParticlesOfASceneWithoutAny",
     R"([{"op": "remove", "path": "/dem"}, {"op": "replace", "path": "/checks/0/of", "value": "summary.skin_m"}])",
     "checks[0].of: summary.json of this scene has no number 'skin_m' (that is a number of scenes with "
     "'dem')"},
    {"CheckOfSummaryWithoutKey", R"([{"op": "replace", "path": "/checks/0/of", "value": "summary."}])",
     "checks[0].of: the value is \"summary.\", without a key (name a number of summary.json)"},
    {"CheckOfContactWithoutParticles", R"([{"op": "remove", "path": "/dem"}])",
     "checks[0].of: unknown signal 'crate.contact_force.z' (known signals: crate.position.x, "
     "crate.position.y, crate.position.z, crate.orientation.w, crate.orientation.x, crate.orientation.y, "
     "crate.orientation.z, crate.velocity.x, crate.velocity.y, crate.velocity.z, crate.angular_velocity.x, "
     "crate.angular_velocity.y, and 1 more)"},
    {"CheckWithUnknownReduce", R"([{"op": "replace", "path": "/checks/0/reduce", "value": "average"}])",
     "checks[0].reduce: the value is \"average\" (known values: last, mean, rms, mean_abs, min, max, range, "
     "period)"},
    {"CheckAfterTheEnd", R"([{"op": "replace", "path": "/checks/0/to", "value": 0.6}])",
     "checks[0].to: 0.6 s is after the end of the run at 0.5 s (leave it out to mean the end)"},
    {"CheckOfEmptyPart", R"([{"op": "replace", "path": "/checks/0/from", "value": 0.5}])",
     "checks[0].from: 0.5 s is not before the end of the part at 0.5 s (give a shorter time)"},
    {"CheckRelativeToZero", R"([{"op": "replace", "path": "/checks/0/expected", "value": 0}])",
     "checks[0].tolerance: the tolerance is relative to an expected value of 0 (add \"absolute\": true)"},
    {"CheckWithNegativeTolerance", R"([{"op": "replace", "path": "/checks/0/tolerance", "value": -0.1}])",
     "checks[0].tolerance: the value is -0.1 (give a number >= 0: allowed deviation as a share of the "
     "expected value [-])"},
    {"TwoChecksOfOneName", R"([{"op": "replace", "path": "/checks/1/name", "value": "weight"}])",
     "checks[1].name: the name 'weight' is given twice (names in checks must differ)"},
    {"AbsoluteAsText", R"([{"op": "replace", "path": "/checks/1/absolute", "value": "yes"}])",
     "checks[1].absolute: the value is \"yes\" (give a boolean: true: the tolerance has the unit of the "
     "signal)"},
};

INSTANTIATE_TEST_SUITE_P(Document, WrongSceneTest, testing::ValuesIn(wrong_document), name_of_case);

TEST(WrongText, NoJson) {
  EXPECT_EQ(verdict(""),
            "scene.json: line 1, column 1: syntax error while parsing value - unexpected end of input; "
            "expected '[', "
            "'{', or a literal (the file must be one JSON object, without comments or trailing commas)");
  EXPECT_EQ(verdict("# a scene"),
            "scene.json: line 1, column 1: syntax error while parsing value - invalid literal; last read: "
            "'#' (the file "
            "must be one JSON object, without comments or trailing commas)");
}

TEST(WrongText, TrailingComma) {
  EXPECT_EQ(
      verdict("{\n  \"tandem\": \"1.0\",\n}"),
      "scene.json: line 3, column 1: syntax error while parsing object key - unexpected '}'; expected string "
      "literal (the file must be one JSON object, without comments or trailing commas)");
}

TEST(WrongText, CutOff) {
  EXPECT_EQ(verdict("{\"tandem\": \"1.0\", \"mbd\": {\"bodies\": [{\"name\": \"box\""),
            "scene.json: line 1, column 52: syntax error while parsing object - unexpected end of input; "
            "expected '}' "
            "(the file must be one JSON object, without comments or trailing commas)");
}

TEST(WrongText, NotANumber) {
  EXPECT_EQ(verdict("{\"end_time\": NaN}"),
            "scene.json: line 1, column 14: syntax error while parsing value - invalid literal; last read: "
            "'\"end_time\": N' (the file must be one JSON object, without comments or trailing commas)");
}

TEST(WrongText, InvalidUtf8) {
  EXPECT_EQ(verdict("{\"name\": \"\xff\"}"),
            "scene.json: line 1, column 11: syntax error while parsing value - invalid string: ill-formed "
            "UTF-8 byte; "
            "last read: '\"\xff' (the file must be one JSON object, without comments or trailing commas)");
}

TEST(WrongText, NoObject) {
  EXPECT_EQ(verdict("[]"),
            "scene.json: the value is [] (give an object: a multibody system, particles, a liquid, or "
            "several of them; SI units; "
            "docs/scene_format.md is the page for people)");
}

TEST(WrongText, NumberBeyondDouble) {
  EXPECT_EQ(
      verdict(R"({"dem": {"materials": [{"name": "a"}, {"density": 1e999}]}})"),
      "scene.json: dem.materials[1].density: the number is too large (give a finite number below 1.8e308)");
}

// Messages contain only the begin of a long text, and it is not matched with a pattern.
TEST(WrongText, OfAMegabyte) {
  const std::string text(1000000, 'x'), begin(97, 'x');
  EXPECT_EQ(verdict_on_patch(R"([{"op": "replace", "path": "/name", "value": ")" + text + "\"}]"),
            "scene.json: name: the value is \"" + begin.substr(1) +
                "... (give at most 100 characters: name of the scene)");
  EXPECT_EQ(verdict_on_patch(R"([{"op": "replace", "path": "/checks/0/of", "value": ")" + text + "\"}]")
                .substr(0, 130),
            "scene.json: checks[0].of: unknown signal '" + begin.substr(0, 88));
  for (const std::string& scene : {"{\"" + text + "\": 1}", "{\"" + text + "\": 1, \"" + text + "\": 2}",
                                   "{\"" + text + "\": {\"a\": 1e999}}", "{\"name\": \"" + text}) {
    const std::string said = verdict(scene);
    EXPECT_LT(said.size(), 500u) << said;
    EXPECT_NE(said.find("xxx..."), std::string::npos) << said;
  }
}

TEST(WrongText, KeyGivenTwice) {
  EXPECT_EQ(verdict(R"({"mbd": {"bodies": [{"mass": 1}, {"mass": 1, "mass": 2}]}})"),
            "scene.json: mbd.bodies[1].mass: the key 'mass' is given twice (keep one of them)");
}

TEST(WrongText, DeepNesting) {
  const std::string deep(1'000'000, '[');
  EXPECT_EQ(verdict(deep),
            "scene.json: lists and objects are nested more than 64 deep (a scene needs fewer than 10 "
            "levels)");
}

}  // namespace
}  // namespace tandem::scene::test

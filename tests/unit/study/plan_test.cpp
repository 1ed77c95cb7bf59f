// The runs of a study.
#include <set>

#include "tests/unit/study/study_folder.hpp"

namespace tandem::launch {
namespace {

class PlanTest : public StudyFolderTest {
 protected:
  std::string refusal(const std::string& change) const {
    return message([&] { make_plan(study(change)); });
  }
};

TEST_F(PlanTest, EveryCombinationIsARunOfItsOwn) {
  const Plan plan = make_plan(study(R"({"set": [{"of": "/mbd/bodies/0/mass", "value": 3}]})"));
  ASSERT_EQ(plan.runs.size(), 4u);
  EXPECT_EQ(plan.runs[0].label(), "window=0.01 rho_inf=0.5");
  EXPECT_EQ(plan.runs[3].label(), "window=0.02 rho_inf=0.9");
  std::set<std::string> keys;
  for (const PlannedRun& run : plan.runs) keys.insert(run.key);
  EXPECT_EQ(keys.size(), 4u);
  const auto scene = nlohmann::json::parse(plan.runs[3].scene);
  EXPECT_EQ(scene["coupling"]["window"], 0.02);
  EXPECT_EQ(scene["mbd"]["integrator"]["rho_inf"], 0.9);
  EXPECT_EQ(scene["mbd"]["bodies"][0]["mass"], 3);
}

// The scene has a setting that the explicit method does not have.
TEST_F(PlanTest, ExplicitMethodLeavesOutSettingsOfTheScene) {
  EXPECT_TRUE(make_plan(study()).try_explicit_method);
  put("scene.json",
      R"({"tandem": "1.0", "name": "pendulum", "end_time": 1, "coupling": {"window": 0.01}, "mbd": {
      "integrator": {"rho_inf": 0.9},
      "bodies": [{"name": "bob", "mass": 1, "inertia": [1, 1, 1], "position": [1, 0, 0]}],
      "joints": [{"name": "hinge", "type": "revolute", "child": "bob", "position": [0, 0, 0], "axis": [0, 1, 0]}]}})");
  const Plan plan = make_plan(study(R"({"order_in": null, "sweep": [
      {"of": "method", "values": ["generalized_alpha", "dormand_prince"]}]})"));
  EXPECT_FALSE(plan.try_explicit_method);
  ASSERT_EQ(plan.runs.size(), 2u);
  EXPECT_FALSE(nlohmann::json::parse(plan.runs[1].scene)["mbd"]["integrator"].contains("rho_inf"));
}

TEST_F(PlanTest, KeysFollowTheScene) {
  const std::string key = make_plan(study()).runs[0].key;
  EXPECT_EQ(make_plan(study(R"({"name": "other", "limit": 5})")).runs[0].key, key) << "not what is run";
  EXPECT_NE(make_plan(study(R"({"threads": 2})")).runs[0].key, key);
  EXPECT_NE(make_plan(study(R"({"set": [{"of": "end_time", "value": 2}]})")).runs[0].key, key);
}

TEST_F(PlanTest, FilesKeepTheirPlaceAndCountByTheirContent) {
  put("balls.csv", "x,y,z\n0,0,0\n");
  put("scene.json", R"({"tandem": "1.0", "name": "balls", "end_time": 1, "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
    "pairs": [{"a": "glass", "b": "glass", "restitution": 0.6, "friction": 0.3}],
    "particles": [{"name": "p", "material": "glass", "radius": 0.1, "fill": {"type": "file", "file": "balls.csv"}}],
    "domain": {"min": [-9, -9, -9], "max": [9, 9, 9]}}})");
  const std::string change = R"({"sweep": [{"of": "window", "values": [0.01]}], "reference": null,
      "measures": [{"name": "lost", "of": ["summary.lost_particles"]}]})";
  const PlannedRun run = make_plan(study(change)).runs[0];
  EXPECT_EQ(nlohmann::json::parse(run.scene)["dem"]["particles"][0]["fill"]["file"],
            (folder_ / "balls.csv").string());
  put("balls.csv", "x,y,z\n0,0,1\n");
  EXPECT_NE(make_plan(study(change)).runs[0].key, run.key);
}

TEST_F(PlanTest, ReferenceRunGivesTimes) {
  const Plan plan =
      make_plan(study(R"({"reference": {"type": "run", "times": null, "signals": null, "every": 0.3,
      "set": [{"of": "window", "value": 0.001}]}, "sweep": [{"of": "window", "values": [0.01, 0.02]}]})"));
  ASSERT_EQ(plan.times.size(), 3u);
  EXPECT_DOUBLE_EQ(plan.times[2], 0.9);
  EXPECT_EQ(nlohmann::json::parse(plan.reference->scene)["coupling"]["window"], 0.001);
}

TEST_F(PlanTest, Refusals) {
  EXPECT_EQ(refusal(R"({"scene": "none.json"})"), "none.json: does not exist (check the path)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "rho_inf", "values": [0.5, 1.5]}], "order_in": "rho_inf"})"),
            "study.json: run rho_inf=1.5: scene.json: mbd.integrator.rho_inf: the value is 1.5 (give a "
            "number from 0 to 1: "
            "spectral radius at infinite frequency [-])");
  EXPECT_EQ(refusal(R"({"set": [{"of": "/mbd/bodies/bob/mass", "value": 1}]})"),
            "study.json: run window=0.01 rho_inf=0.5: the scene has no place '/mbd/bodies/bob/mass' for a "
            "value (check the "
            "pointer; lists are numbered from 0)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "window", "values": [0.01, 0.04]}]})"),
            "study.json: run window=0.04: no window of 0.04 s ends at 0.5 s (choose windows that divide the "
            "times of the "
            "reference)");
  EXPECT_EQ(refusal(R"({"set": [{"of": "end_time", "value": 0.8}]})"),
            "study.json: run window=0.01 rho_inf=0.5: it ends at 0.8 s, before 1 s (choose windows that "
            "divide the times "
            "of the reference)");
  EXPECT_EQ(refusal(R"({"reference": {"signals": [{"of": "hinge.p", "values": [1, 2]}]},
                        "measures": [{"name": "a", "of": ["hinge.p"]}]})"),
            "study.json: run window=0.01 rho_inf=0.5: measure 'a': there is no signal 'hinge.p' (did you "
            "mean 'hinge.q'?)");
}

TEST_F(PlanTest, ParametersOfTheSceneCanBeSet) {
  put("scene.json",
      R"({"tandem": "1.1", "name": "pendulum", "end_time": 1, "coupling": {"window": 0.01},
      "parameters": {"weight": 2}, "mbd": {
      "bodies": [{"name": "bob", "mass": "=3*weight", "inertia": [1, 1, 1], "position": [1, 0, 0]}],
      "joints": [{"name": "hinge", "type": "revolute", "child": "bob", "position": [0, 0, 0], "axis": [0, 1, 0]}]}})");
  const auto mass = [](const Plan& plan) {
    return nlohmann::json::parse(plan.runs[0].scene).at("/mbd/bodies/0/mass"_json_pointer).get<double>();
  };
  const Study it = study();
  EXPECT_EQ(mass(make_plan(it)), 6);
  EXPECT_EQ(mass(make_plan(it, {}, {{"weight", 5}})), 15);
  EXPECT_NE(make_plan(it).runs[0].key, make_plan(it, {}, {{"weight", 5}}).runs[0].key);
  EXPECT_NE(message([&] { make_plan(it, {}, {{"wieght", 5}}); }).find("weight"), std::string::npos);
}

}  // namespace
}  // namespace tandem::launch

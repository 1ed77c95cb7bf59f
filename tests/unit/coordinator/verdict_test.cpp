// Each rule of the verdict: an artificial run just within its limit, and one just beyond.
#include "coordinator/verdict/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <set>

#include "coordinator/verdict/status.hpp"
#include "tests/support/page_table.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::Contains;
using ::testing::HasSubstr;

scene::Scene toy_scene() {
  scene::Scene scene;
  scene.coupling.window = 1e-3;
  scene.mbd.emplace();
  scene.mbd->integrator.step = 1e-3;
  scene.dem.emplace();
  scene.dem->materials = {{"glass", 2500, 1e7, 0.25}, {"steel", 7850, 1e9, 0.3}};
  scene.dem->speed_limit = 10;
  return scene;
}

// A run without objections; it has the figures of all rules.
Json good_run() {
  return Json::parse(R"({
    "windows": 1000, "spheres": 10000, "dof": 3, "mbd_dof_lowest": 3, "mbd_locked": 0, "mbd_cavitated_s": 0, "mbd_contact_depth_share": 0, "mbd_tyre_bottoming_share": 0, "mbd_periods_per_step": 0, "micro_step_s": 1e-5, "critical_time_s": 5e-5,
    "advised_micro_step_s": 2e-6,
    "mbd_largest_energy_balance_J": 0, "mbd_energy_scale_J": 10, "energy_residual": 0, "impulse_closure": 0,
    "impulse_outstanding": 0, "windows_of_too_large_error": 0, "mbd_largest_constraint_violation": 0,
    "mbd_sharpest_turn": 0, "mbd_sharpest_turn_at_s": 0.25,
    "mbd_largest_reaction_N": 100, "mbd_reaction_scale_N": 100, "mbd_largest_reaction_joint": "hinge",
    "mbd_steps": 1000, "mbd_shortened_steps": 0, "mbd_doubtful_steps": 0,
    "mbd_position_error_estimate": 0, "mbd_local_error_sum": 0, "mbd_energy_error_estimate_J": 0, "max_overlap_ratio": 0, "max_speed": 1,
    "lost_particles": 0, "momentum_balance": 0, "momentum_balance_windows": 0, "windows_of_too_long_steps": 0, "wall_crossings": [],
    "motion_jumps": [], "frame_differences": [], "joint_violations": [], "path_differences": [],
    "body_energy_differences": [{"of": "the run", "share": 0, "reported_J": 5, "computed_J": 4, "time_s": 0.2}], "unloaded_walls": [],
    "bad_endings": [], "false_spheres": [], "particle_frame_differences": [],
    "angular_momentum_balance": 0, "largest_micro_step_s": 1e-5, "critical_time_of_scene_s": 6e-5,
    "border": {"box": {"impulse_booked": [0, 0, 8], "impulse_applied": [0, 0, 8], "impulse_outstanding": [0, 0, 0],
      "angular_impulse_booked": [0, 2, 0], "angular_impulse_applied": [0, 2, 0],
      "angular_impulse_outstanding": [0, 0, 0], "momentum_residual": 0, "angular_momentum_residual": 0,
      "omega_H": 1, "stable_omega_H": 1.5, "stable_window_s": 2e-4,
      "stable_scheme": "linear_implicit"}},
    "sph": {"sound_speed_m_per_s": 20, "longest_step_s": 1e-4, "density_error": 0.2, "mach": 0.3, "dense_share": 0.01, "dense_error": 0.12, "fast_share": 0.001, "fast_mach": 0.4, "passed_walls": 0,
      "particles": 1000, "lost_kg": 0, "mass_in_all_kg": 100, "energy_residual_J": 0, "energy_scale_J": 10, "momentum_balance": 0},
    "warnings": []})");
}

Json crossing(double share) {
  return Json::array({{{"wall_a", "tyre"},
                       {"body_a", "wheel"},
                       {"wall_b", "floor"},
                       {"body_b", "ground"},
                       {"time_s", 0.2},
                       {"depth_m", 0.1 * share},
                       {"share", share}}});
}

Json state_difference(double share) {
  return Json::array({{{"body", "box"},
                       {"share", share},
                       {"position_m", 0.05},
                       {"rotation_rad", 0},
                       {"velocity_m_per_s", 2},
                       {"angular_velocity_rad_per_s", 0},
                       {"time_s", 0.2}}});
}

Json violated_joint(double share) {
  return Json::array({{{"of", "joint 'hinge'"},
                       {"share", share},
                       {"what", "its two sides are 0.1 m apart"},
                       {"time_s", 0.2}}});
}
Json strayed_body(double share) {
  return Json::array(
      {{{"of", "orientation of body 'box'"}, {"share", share}, {"open_rad", 0.1}, {"time_s", 0.2}}});
}

struct RuleCase {
  const char* rule;
  const char* at;  // JSON pointer of the figure
  Json inside, outside;
  std::vector<const char*> says;  // parts of the line: the object, and the value to use instead
};
std::ostream& operator<<(std::ostream& out, const RuleCase& c) {
  return out << c.rule;
}

const std::vector<RuleCase>& rule_cases() {
  static const std::vector<RuleCase> all = {
      {"energy_mbd",
       "/mbd_largest_energy_balance_J",
       -0.099,
       -0.101,
       {"-0.101 J", "mbd.integrator.step = 0.0009 s"}},
      {"energy_coupling", "/energy_residual", -0.049, 0.051, {"made 0.051", "coupling.window = 0.00089 s"}},
      {"impulse_closure", "/impulse_closure", 0.9e-9, 1.1e-9, {"docs/protocol.md"}},
      {"impulse_outstanding",
       "/impulse_outstanding",
       0.099,
       0.11,
       {"0.11 of", "coupling.window = 0.00082 s"}},
      {"window_stability", "/border/box/omega_H", 2.99, 3.01, {"body 'box'", "coupling.window = 0.0002 s"}},
      {"window_error", "/windows_of_too_large_error", 10, 11, {"coupling.adaptive.min_window"}},
      {"constraints",
       "/mbd_largest_constraint_violation",
       0.9e-4,
       1.1e-4,
       {"0.00011", "mbd.integrator.step"}},
      {"harmonic_step",
       "/mbd_periods_per_step",
       0.1,
       2,
       {"holds 2 periods", "mbd.integrator.step = 2.5e-05 s"}},
      {"reaction",
       "/mbd_largest_reaction_N",
       0.99e5,
       1.01e5,
       {"joint 'hinge' bears 1.01e+05 N", "spherical"}},
      {"freedom", "/mbd_dof_lowest", 3, 2, {"1 of 3 degrees of freedom", "more digits"}},
      {"branch", "/mbd_sharpest_turn", 19, 21, {"t = 0.25 s", "21 per rad", "more digits"}},
      {"locked", "/mbd_locked", 0, 1, {"no degree of freedom", "assembly_tolerance"}},
      {"cavitation", "/mbd_cavitated_s", 0, 0.02, {"cavitated for 0.02 s", "valve_flow"}},
      {"contact_depth",
       "/mbd_contact_depth_share",
       0.24,
       0.5,
       {"0.5 of the thinner", "4 times where they hit"}},
      {"tyre_bottoming",
       "/mbd_tyre_bottoming_share",
       0.009,
       0.3,
       {"0.3 of the time that the tyre is on it", "smaller than the loaded radius", "mbd.contact.ignore"}},
      {"shortened_steps", "/mbd_shortened_steps", 10, 11, {"0.011 of the steps", "step = 0.00045 s"}},
      {"doubtful_steps", "/mbd_doubtful_steps", 0, 1, {"1 steps", "step = 9e-05 s"}},
      {"position_error", "/mbd_position_error_estimate", 0.0099, 0.04, {"0.04", "step = 0.00045 s"}},
      {"local_errors",
       "/mbd_local_error_sum",
       0.0099,
       0.04,
       {"is not estimated: too few steps; what", "adds up to 0.04", "step = 0.00045 s",
        "--estimate richardson"}},
      {"energy_error", "/mbd_energy_error_estimate_J", 0.099, 0.4, {"0.04 of", "step = 0.00045 s"}},
      // Twice the limit requires a modulus (2 / 0.95)^(5/2) times as large.
      {"overlap",
       "/max_overlap_ratio",
       0.0499,
       0.1,
       {"overlap is 0.1", "young = 6.4e+07 Pa (now 1e+07)", "'glass'", "step becomes 0.39"}},
      {"speed", "/max_speed", 9.9, 10.1, {"10.1 m/s", "dem.micro_step = 5e-06 s"}},
      {"lost", "/lost_particles", 10, 11, {"11 of 10000 spheres", "dem.domain"}},
      {"momentum_windows", "/momentum_balance_windows", 0.9e-3, 1.1e-3, {"tandem conform --role dem"}},
      {"body_momentum",
       "/border/box/momentum_residual",
       0.9e-3,
       1.1e-3,
       {"body 'box' gets a momentum", "0.0011", "tandem conform --role mbd"}},
      {"body_angular_momentum",
       "/border/box/angular_momentum_residual",
       0.0099,
       0.011,
       {"body 'box' gets an angular momentum", "0.011", "--check torque_impulse", "mbd.integrator.step"}},
      {"momentum", "/momentum_balance", 0.9e-6, 1.1e-6, {"\"precision\": \"double\""}},
      {"collision_steps", "/windows_of_too_long_steps", 10, 11, {"dem.micro_step = 2e-06 s (now 1e-05)"}},
      {"critical_step", "/micro_step_s", 1.9e-5, 2.1e-5, {"0.42 of", "dem.micro_step = 1e-05 s"}},
      {"motion_chain",
       "/motion_jumps",
       state_difference(0.9e-6),
       state_difference(1.1e-6),
       {"body 'box' jumps", "t = 0.2 s it begins 0.05 m, 0 rad, 2 m/s and 0 rad/s", "--check motion_chain"}},
      {"particle_frames",
       "/false_spheres",
       Json::array(),
       Json::array(
           {{{"of", "radius"}, {"spheres", 2}, {"time_s", 0.5}, {"example", "its sphere 7 is too large"}}}),
       {"t = 0.5 s 2 spheres are wrong", "its sphere 7 is too large", "--check observe_particles"}},
      {"particle_account",
       "/particle_frame_differences",
       Json::array({{{"of", "kinetic energy"}, {"share", 0.9e-3}, {"time_s", 0.5}, {"values", "is 3 J"}}}),
       Json::array({{{"of", "kinetic energy"}, {"share", 1.1e-3}, {"time_s", 0.5}, {"values", "is 3 J"}}}),
       {"kinetic energy of the frame of t = 0.5 s is 3 J", "0.0011", "--check kinetic_energy"}},
      {"angular_momentum",
       "/angular_momentum_balance",
       0.0099,
       0.011,
       {"off by 0.011 of the torques", "--check torque_on_body"}},
      {"joints",
       "/joint_violations",
       violated_joint(0.9e-3),
       violated_joint(1.1e-3),
       {"joint 'hinge' is violated: in the results at t = 0.2 s its two sides are 0.1 m apart", "0.0011",
        "--check joint_motion"}},
      {"body_path",
       "/path_differences",
       strayed_body(0.009),
       strayed_body(0.02),
       {"the orientation of body 'box' does not follow from its velocity: by t = 0.2 s it is off by 0.1 rad",
        "0.02 of the way", "--check rotation", "a shorter coupling.window"}},
      {"body_energy",
       "/body_energy_differences/0/share",
       0.9e-3,
       1.1e-3,
       {"changed by 5 J at t = 0.2 s, and by 4 J by their poses", "0.0011", "--check energy"}},
      {"contact_load",
       "/unloaded_walls",
       Json::array(),
       Json::array({{{"of", "body 'box'"}, {"spheres", 3}, {"time_s", 0.2}, {"example", "sphere 7 does"}}}),
       {"body 'box' has no load in the frame of t = 0.2 s", "sphere 7 does", "--check weight_on_body"}},
      {"ending",
       "/bad_endings",
       Json::array(),
       Json::array({{{"of", "mbd_server 'mine'"}, {"what", "exited with status 9"}}}),
       {"mbd_server 'mine' exited with status 9 after the run", "--check finish"}},
      {"body_frames",
       "/frame_differences",
       state_difference(0.9e-6),
       state_difference(1.1e-6),
       {"body 'box' is elsewhere in the results", "t = 0.2 s by 0.05 m", "--check observe_bodies"}},
      {"body_contact",
       "/wall_crossings",
       crossing(0.0099),
       crossing(0.02),
       {"wall 'tyre' of 'wheel' and wall 'floor' of 'ground'", "0.2 s", "0.002 m", "limits"}},
      // The error falls with the square of the speed of sound, with a tenth in reserve.
      {"liquid_density",
       "/sph/dense_share",
       0.049,
       0.08,
       {"up to 0.08 of the mass", "by up to 0.12 in the mean", "sound_speed of 44 m/s (now 20)"}},
      {"mach",
       "/sph/fast_share",
       0.0099,
       0.03,
       {"up to 0.03 of the mass", "up to 0.4 in the mean", "sound_speed of 40 m/s (now 20)",
        "expected_speed of 4 m/s"}},
      {"passed_walls", "/sph/passed_walls", 0, 3, {"3 times a particle", "sound_speed of 30 m/s (now 20)"}},
      {"lost_liquid",
       "/sph/lost_kg",
       0.09,
       0.11,
       {"0.11 of 100 kg of the liquid left the domain", "sph.domain", "sph.outlets"}},
      {"energy_liquid",
       "/sph/energy_residual_J",
       -0.099,
       -0.2,
       {"0.02 of the energy", "sph.micro_step = 5e-05 s"}},
      {"momentum_liquid", "/sph/momentum_balance", 0.9e-6, 1.1e-6, {"\"precision\": \"double\""}},
  };
  return all;
}

// `summary` has what the coordinator measured and what the solvers report.
Verdict verdict_of(const scene::Scene& scene, const Json& summary) {
  protocol::SolverFacts facts;
  for (const auto role : {protocol::Role::mbd, protocol::Role::dem})
    protocol::decode_facts(role, summary.dump(), facts);
  if (summary.contains("sph")) protocol::decode_facts(protocol::Role::sph, summary["sph"].dump(), facts);
  return judge({scene, summary, facts});
}

class EachRule : public ::testing::TestWithParam<RuleCase> {};

TEST_P(EachRule, IsSilentInsideItsLimitAndSpeaksOutsideIt) {
  const RuleCase& c = GetParam();
  const scene::Scene scene = toy_scene();
  Json run = good_run();
  const Json::json_pointer at(c.at);
  ASSERT_TRUE(run.contains(at));
  // Used in place of an estimate.
  if (c.rule == std::string("local_errors"))
    run["mbd_position_error_estimate"] = "not estimated: too few steps; and what measures it";
  run[at] = c.inside;
  const Verdict inside = verdict_of(scene, run);
  EXPECT_THAT(inside.judged, Contains(c.rule));
  EXPECT_TRUE(inside.lines.empty()) << to_json(inside).dump(1);

  run[at] = c.outside;
  const Verdict outside = verdict_of(scene, run);
  ASSERT_EQ(outside.lines.size(), 1u);
  EXPECT_TRUE(outside.suspect());
  const VerdictLine& line = outside.lines.front();
  EXPECT_EQ(line.rule, c.rule);
  EXPECT_GT(line.value, line.limit);
  for (const char* part : c.says) EXPECT_THAT(line.sentence, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(Verdict, EachRule, ::testing::ValuesIn(rule_cases()),
                         [](const auto& of) { return std::string(of.param.rule); });

TEST(Verdict, EachRuleHasACase) {
  std::set<std::string> covered, all;
  for (const RuleCase& c : rule_cases()) covered.insert(c.rule);
  for (const Rule& rule : rules()) all.insert(rule.name);
  EXPECT_EQ(covered, all);
}

TEST(Verdict, FiguresThatARunDoesNotHaveAreNotJudged) {
  const Verdict verdict =
      verdict_of(scene::Scene(), Json{{"impulse_closure", nullptr}, {"momentum_balance", 0.5}});
  EXPECT_EQ(verdict.judged, std::vector<std::string>{"momentum"});
  EXPECT_EQ(verdict.lines.size(), 1u);
  const Json json = to_json(verdict);
  EXPECT_EQ(json["status"], "suspect");
  EXPECT_EQ(json["lines"][0]["rule"], "momentum");
  EXPECT_EQ(json["lines"][0]["value"], 0.5);
}

TEST(Verdict, ANumberThatIsNoneIsBeyondEveryLimit) {
  Json run = good_run();
  run["energy_residual"] = std::nan("");
  EXPECT_EQ(verdict_of(toy_scene(), run).lines.size(), 1u);
}

// Not even steps twice as long could be taken to measure it.
TEST(Verdict, AnErrorThatLongerStepsCannotMeasureIsBeyondTheLimit) {
  Json run = good_run();
  run["mbd_position_error_estimate"] =
      "not estimated: longer steps, with which it is measured, do not resolve the motion; what measures it";
  const Verdict verdict = verdict_of(toy_scene(), run);
  ASSERT_EQ(verdict.lines.size(), 1u);
  EXPECT_EQ(verdict.lines[0].rule, "position_error");
  EXPECT_THAT(verdict.lines[0].sentence, HasSubstr("is unknown"));
}

TEST(Verdict, GrowthOfSmallErrorsIsNamed) {
  Json run = good_run();
  run["mbd_position_error_estimate"] = 0.3;
  run["mbd_local_error_sum"] = 0.001;
  const Verdict verdict = verdict_of(toy_scene(), run);
  ASSERT_EQ(verdict.lines.size(), 1u);
  EXPECT_THAT(verdict.lines[0].sentence, HasSubstr("chaotic"));
}

TEST(Verdict, LimitsOfTheSceneCount) {
  scene::Scene scene = toy_scene();
  scene.dem->overlap_limit = 0.3;
  Json run = good_run();
  run["max_overlap_ratio"] = 0.25;
  EXPECT_FALSE(verdict_of(scene, run).suspect());
  scene.dem->speed_limit.reset();
  run["max_speed"] = 1e6;
  EXPECT_FALSE(verdict_of(scene, run).suspect());
}

TEST(Verdict, DroppedTorquesAreNamed) {
  Json run = good_run();
  run["impulse_closure"] = 0.65;
  run["border"]["box"]["angular_impulse_applied"] = {0, 0, 0};
  const Verdict verdict = verdict_of(toy_scene(), run);
  ASSERT_EQ(verdict.lines.size(), 1u);
  EXPECT_THAT(verdict.lines[0].sentence,
              HasSubstr("of 2 N m s of torque that the particles gave body 'box' it was moved by 0"));
}

TEST(Verdict, LostSpheresRepeatWhatIsSaidOfUnits) {
  Json run = good_run();
  run["lost_particles"] = 10000;
  run["warnings"] = {
      "wall \"hopper\" is 400 m wide in a domain of 1 m: is the file in mm? then give \"scale\": 0.001"};
  const Verdict verdict = verdict_of(toy_scene(), run);
  ASSERT_EQ(verdict.lines.size(), 1u);
  EXPECT_THAT(verdict.lines[0].sentence, HasSubstr("then give \"scale\": 0.001"));
}

TEST(Verdict, AdvisesNoSchemeThatTheRunHas) {
  scene::Scene scene = toy_scene();
  Json run = good_run();
  run["energy_residual"] = 0.2;
  run["border"]["box"]["omega_H"] = 30;
  run["border"]["box"].erase("stable_scheme");
  for (const auto scheme : {scene::Scheme::dem_first, scene::Scheme::implicit}) {
    scene.coupling.scheme = scheme;
    const Verdict verdict = verdict_of(scene, run);
    ASSERT_EQ(verdict.lines.size(), 2u);
    for (const auto& line : verdict.lines)
      EXPECT_EQ(line.sentence.find("or coupling.scheme = \"implicit\"") != std::string::npos,
                scheme != scene::Scheme::implicit)
          << line.sentence;
  }
}

TEST(Verdict, StiffnessFollowsTheContactLaw) {
  scene::Scene scene = toy_scene();
  scene.dem->contact = scene::ContactLaw::hooke;
  scene::Pair pair;
  pair.spring_stiffness = 1000;
  scene.dem->pairs = {pair};
  Json run = good_run();
  run["max_overlap_ratio"] = 0.1;
  EXPECT_THAT(verdict_of(scene, run).lines.at(0).sentence,
              HasSubstr("spring_stiffness = 4.4e+03 (now 1e+03)"));
}

TEST(Verdict, ErrorControlledRunsAreToldATolerance) {
  scene::Scene scene = toy_scene();
  scene.mbd->integrator.error_tolerance = 1e-4;
  Json run = good_run();
  run["mbd_largest_energy_balance_J"] = 1;
  EXPECT_THAT(verdict_of(scene, run).lines.at(0).sentence,
              HasSubstr("mbd.integrator.error_tolerance = 1e-05 (now 0.0001)"));
}

// A participant cannot switch the rule off by what it reports.
TEST(Verdict, TheLongestMicroStepAndTheShortestCriticalTimeCount) {
  const auto value = [](const char* at, double figure) {
    Json run = good_run();
    run[Json::json_pointer(at)] = figure;
    const Verdict verdict = verdict_of(toy_scene(), run);
    return verdict.lines.empty() ? 0.0 : verdict.lines[0].value;
  };
  EXPECT_EQ(value("/critical_time_s", 1e9), 0);
  EXPECT_EQ(value("/largest_micro_step_s", 1.9e-5), 0);
  EXPECT_DOUBLE_EQ(value("/largest_micro_step_s", 2.5e-5), 0.5);
  EXPECT_DOUBLE_EQ(value("/critical_time_of_scene_s", 2e-5), 0.5);
}

TEST(Verdict, TheDocumentationHasTheSameTable) {
  tandem::test::expect_on_page("docs/verdict.md", "rules", rules_as_markdown());
}

TEST(Status, OfAProcessThatIsGoneIsDied) {
  Json summary{{"status", "running"}, {"process", this_process()}};
  EXPECT_EQ(status_now(summary), "running");
  summary["process"]["started"] =
      summary["process"]["started"].get<std::uint64_t>() + 1;  // its number was reused
  EXPECT_EQ(status_now(summary), "died");
  summary["process"]["host"] = "elsewhere";
  EXPECT_EQ(status_now(summary), "running");
  EXPECT_EQ(status_now(Json{{"status", "ok"}}), "ok");
  EXPECT_EQ(status_now(Json::object()), "");
}

}  // namespace
}  // namespace tandem::launch

// What tandem/participant.hpp makes of a solver and of its exceptions. The library is not linked: the
// functions below stand for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tandem/participant.hpp>

#include <functional>
#include <stdexcept>

namespace {

struct Failure {
  int code = TANDEM_OK;
  std::string what, where, hint;
} failure;
std::function<void(const tandem_motion_solver&, void*)> use_motion;
std::function<void(const tandem_load_solver&, void*)> use_load, use_liquid;
std::vector<std::string> facts;

}  // namespace

extern "C" {
int tandem_fail(int code, const char* what, const char* where, const char* hint) {
  failure = {code, what, where, hint};
  return code;
}
void tandem_log(char level, const char* sentence) {
  facts.push_back(std::string(1, level) + " " + sentence);
}
void tandem_fact_number(tandem_facts*, const char* key, double) {
  facts.emplace_back(key);
}
void tandem_fact_text(tandem_facts*, const char* key, const char* value) {
  facts.push_back(std::string(key) + " " + value);
}
void tandem_warn(tandem_facts*, const char* sentence) {
  facts.emplace_back(sentence);
}
int tandem_motion_main(int, char**, const char*, const tandem_motion_solver* table, void* self) {
  use_motion(*table, self);
  return 7;
}
int tandem_load_main(int, char**, const char*, const tandem_load_solver* table, void* self) {
  use_load(*table, self);
  return 8;
}
int tandem_liquid_main(int, char**, const char*, const tandem_load_solver* table, void* self) {
  use_liquid(*table, self);
  return 9;
}
int tandem_pose_at(const tandem_body_motion*, const tandem_window*, double, tandem_pose*, tandem_twist*) {
  return tandem_fail(TANDEM_ERROR_NUMERICS, "rotates too far", "tandem_pose_at", "");
}
}

namespace tandem::participant::test {
namespace {

using testing::ElementsAre;

class Motion : public MotionSolver {
 public:
  std::function<void()> in_advance = [] {};
  int saved = 0;

  std::uint64_t capabilities() const override { return TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK; }
  std::vector<std::string> features() const override { return {"joint:*", "coupler"}; }
  void configure(const tandem_configuration&, tandem_motion_set&, Facts& given) override {
    given.number("bodies", 3);
    given.text("method", "none");
    given.warn("careful");
  }
  void advance(const tandem_load_set&, tandem_motion_set& motion) override {
    in_advance();
    for (tandem_body_motion& body : bodies(motion)) body.applied_work = 5;
  }
  void observe(tandem_bodies_frame&) override {}
  void save() override { ++saved; }
};

class Load : public LoadSolver {
 public:
  std::uint64_t capabilities() const override { return 0; }
  std::vector<std::string> features() const override { return {}; }
  void configure(const tandem_configuration&, Facts&) override {}
  void advance(const tandem_motion_set& motion, tandem_load_set&) override {
    pose_at(bodies(motion)[0], motion.window, 0);
  }
  void observe(tandem_particles_frame&) override {}
};

// Status of advance() with this in it.
int thrown(std::function<void()> what) {
  Motion solver;
  solver.in_advance = std::move(what);
  int status = -1;
  failure = {};
  use_motion = [&](const tandem_motion_solver& table, void* self) {
    const tandem_load_set loads{};
    tandem_motion_set motion{};
    status = table.advance(self, &loads, &motion);
  };
  run(0, nullptr, "test 1", solver);
  return status;
}

TEST(ParticipantHeader, MakesATableOfTheSolver) {
  Motion solver;
  bool used = false;
  facts.clear();
  use_motion = [&](const tandem_motion_solver& table, void* self) {
    used = true;
    EXPECT_EQ(table.size, sizeof(tandem_motion_solver));
    EXPECT_EQ(table.capabilities, TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK);
    EXPECT_STREQ(table.features[0], "joint:*");
    EXPECT_STREQ(table.features[1], "coupler");
    EXPECT_EQ(table.features[2], nullptr);
    for (const bool given :
         {bool(table.configure), bool(table.advance), bool(table.observe), bool(table.report),
          bool(table.predict), bool(table.save), bool(table.restore), bool(table.extrapolate),
          bool(table.control), bool(table.checkpoint), bool(table.resume)})
      EXPECT_TRUE(given);
    const tandem_configuration configuration{};
    tandem_motion_set initial{};
    EXPECT_EQ(table.configure(self, &configuration, &initial, nullptr), TANDEM_OK);
    EXPECT_THAT(facts, ElementsAre("bodies", "method none", "careful"));
    tandem_body_motion body{};
    tandem_motion_set motion{{}, 1, &body};
    const tandem_load_set loads{};
    EXPECT_EQ(table.advance(self, &loads, &motion), TANDEM_OK);
    EXPECT_EQ(body.applied_work, 5);  // written in place
    EXPECT_EQ(table.save(self), TANDEM_OK);
    EXPECT_EQ(table.report(self, nullptr), TANDEM_OK);  // the solver has no report() of its own
  };
  EXPECT_EQ(run(0, nullptr, "test 1", solver), 7);
  EXPECT_TRUE(used);
  EXPECT_EQ(solver.saved, 1);
}

TEST(ParticipantHeader, ExceptionsBecomeErrorsOfTheRun) {
  EXPECT_EQ(thrown([] { throw Error(Code::scene, "mass is -1 kg", "mbd.bodies 'bob'", "give a mass > 0"); }),
            TANDEM_ERROR_SCENE);
  EXPECT_EQ(failure.what, "mass is -1 kg");
  EXPECT_EQ(failure.where, "mbd.bodies 'bob'");
  EXPECT_EQ(failure.hint, "give a mass > 0");
  EXPECT_EQ(thrown([] { throw Error(Code::numerics, "does not converge"); }), TANDEM_ERROR_NUMERICS);
  EXPECT_EQ(failure.where, "advance");
  EXPECT_EQ(thrown([] { throw std::bad_alloc(); }), TANDEM_ERROR_RESOURCE);
  EXPECT_EQ(thrown([] { throw std::runtime_error("oh"); }), TANDEM_ERROR_INTERNAL);
  EXPECT_EQ(failure.what, "oh");
  EXPECT_EQ(thrown([] { throw 5; }), TANDEM_ERROR_INTERNAL);
  EXPECT_EQ(thrown([] {}), TANDEM_OK);
}

TEST(ParticipantHeader, APromiseWithoutAFunctionIsAnError) {
  Motion solver;  // promises predict() and restore() and overrides neither
  use_motion = [&](const tandem_motion_solver& table, void* self) {
    const tandem_window window{};
    tandem_motion_set motion{};
    EXPECT_EQ(table.predict(self, &window, &motion), TANDEM_ERROR_INTERNAL);
    EXPECT_EQ(failure.where, "predict");
    EXPECT_EQ(table.restore(self), TANDEM_ERROR_INTERNAL);
    EXPECT_EQ(failure.where, "restore");
  };
  run(0, nullptr, "test 1", solver);
}

TEST(ParticipantHeader, AFailureOfTheLibraryKeepsItsReason) {
  Load solver;
  use_load = [&](const tandem_load_solver& table, void* self) {
    tandem_body_motion body{};
    const tandem_motion_set motion{{}, 1, &body};
    tandem_load_set loads{};
    EXPECT_EQ(table.advance(self, &motion, &loads), TANDEM_ERROR_NUMERICS);
    EXPECT_EQ(failure.what, "rotates too far");
  };
  EXPECT_EQ(run(0, nullptr, "test 1", solver), 8);
}

class Liquid : public LiquidSolver {
 public:
  std::uint64_t capabilities() const override { return TANDEM_CAN_OBSERVE_LIQUID; }
  std::vector<std::string> features() const override { return {"liquid.inside"}; }
  void configure(const tandem_configuration& c, Facts& given) override {
    given.number(liquids(c)[0].name, c.spacing);
  }
  void advance(const tandem_motion_set&, tandem_load_set&) override {}
  void observe(tandem_particles_frame& frame) override { frame.count = 3; }
};

TEST(ParticipantHeader, ASolverOfALiquidHasATableLikeOneOfSpheres) {
  Liquid solver;
  facts.clear();
  use_liquid = [&](const tandem_load_solver& table, void* self) {
    EXPECT_EQ(table.capabilities, TANDEM_CAN_OBSERVE_LIQUID);
    EXPECT_STREQ(table.features[0], "liquid.inside");
    tandem_liquid water{};
    water.name = "water";
    tandem_configuration configuration{};
    configuration.liquid_count = 1, configuration.liquids = &water;
    EXPECT_EQ(table.configure(self, &configuration, nullptr), TANDEM_OK);
    EXPECT_THAT(facts, ElementsAre("water"));
    tandem_particles_frame frame{};
    EXPECT_EQ(table.observe(self, &frame), TANDEM_OK);
    EXPECT_EQ(frame.count, 3u);
  };
  EXPECT_EQ(run(0, nullptr, "test 1", solver), 9);
}

}  // namespace
}  // namespace tandem::participant::test

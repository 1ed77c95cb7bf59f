// A whole run under a controller of this program: the loop is that of the exact discrete system.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "common/error.hpp"
#include "coordinator/run/run.hpp"
#include "coordinator/window/controller.hpp"

namespace tandem::launch {
namespace {

constexpr double J = .4, window = .01, stiffness = 30, damping = 4;

constexpr const char* wheel = R"({
  "tandem": "1.0", "name": "wheel", "end_time": 0.5, "coupling": {"window": 0.01},
  "mbd": {"bodies": [{"name": "wheel", "mass": 1, "inertia": [0.4, 0.4, 0.4]}],
          "joints": [{"name": "axle", "type": "revolute", "child": "wheel", "position": [0, 0, 0], "axis": [0, 0, 1],
                      "rate": 2}],
          "forces": [{"name": "motor", "type": "actuator", "joint": "axle", "input": "torque"}],
          "sensors": ["axle.q", "axle.rate", "wheel.angular_velocity.z", "axle.reaction_torque.z"]}})";

// A spring and a damper, in parallel with the exact wheel: J q'' = u, held over each window.
class SpringAndDamper : public Controller {
 public:
  const std::vector<double>& inputs(Nanoseconds now, const std::vector<double>& sensors) override {
    EXPECT_EQ(now, to_nanoseconds(calls * window));
    worst = std::max({worst, std::abs(sensors[0] - q), std::abs(sensors[1] - u)});
    EXPECT_EQ(sensors[2], sensors[1]);
    if (calls > 0) {
      EXPECT_NEAR(sensors[3], torque[0], 1e-12);  // of the previous window
    }
    torque[0] = -stiffness * q - damping * u;
    q += window * u + window * window / 2 * torque[0] / J;
    u += window * torque[0] / J;
    ++calls;
    return torque;
  }
  double q = 0, u = 2, worst = 0;
  int calls = 0;
  std::vector<double> torque = std::vector<double>(1);
};

class ControlTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    options_.scene = folder_ / "wheel.json";
    options_.folder = folder_ / "out";
    options_.transport = Transport::inproc;
    options_.picture = options_.report = false;
    options_.quiet = true;
    std::ofstream(options_.scene) << wheel;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string text_of(const char* file) {
    std::stringstream text;
    text << std::ifstream(options_.folder / file).rdbuf();
    return text.str();
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_control_" + std::to_string(getpid()));
  RunOptions options_;
};

TEST_F(ControlTest, LoopIsTheExactDiscreteSystem) {
  SpringAndDamper controller;
  EXPECT_EQ(run(options_, &controller), 0);
  EXPECT_EQ(controller.calls, 50);
  std::printf(
      "spring and damper by a controller, 50 windows: largest difference of angle and rate %.1e, tolerance "
      "1e-12\n",
      controller.worst);
  EXPECT_LT(controller.worst, 1e-12);
  const std::string inputs = text_of("control.csv");
  EXPECT_EQ(inputs.substr(0, inputs.find('\n', 13)), "time,torque\n0,-8");
  EXPECT_EQ(std::count(inputs.begin(), inputs.end(), '\n'), 51);
}

TEST_F(ControlTest, SceneAndControllerGoTogether) {
  EXPECT_EQ(run(options_), exit_status(ErrorCode::usage));
  EXPECT_NE(text_of("summary.json").find("nothing gives the control inputs of the scene: torque"),
            std::string::npos);
  std::string free = wheel;
  free.replace(free.find(R"("input": "torque")"), 17, R"("size": {"type": "constant"})");
  std::ofstream(options_.scene) << free;
  options_.controller = "cat";
  EXPECT_EQ(run(options_), exit_status(ErrorCode::usage));
  EXPECT_NE(text_of("summary.json").find("the scene has no control inputs"), std::string::npos);
}

TEST_F(ControlTest, AWrongAnswerEndsTheRun) {
  options_.controller = "sh -c 'read names; read sensors; echo 5'";
  EXPECT_EQ(run(options_), exit_status(ErrorCode::protocol));
  EXPECT_NE(text_of("summary.json").find("answered '5': no JSON object"), std::string::npos);
}

}  // namespace
}  // namespace tandem::launch

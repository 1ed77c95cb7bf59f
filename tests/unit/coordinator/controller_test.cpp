// A controller program: its input, its valid answers, and each way in which it can fail.
#include "coordinator/window/controller.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;

class ControllerTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    scene_.name = "machine";
    scene_.end_time = 2;
    scene_.mbd.emplace();
    scene_.mbd->sensors = {"hinge.q", "hinge.rate"};
    for (const char* name : {"left", "right"})
      scene_.mbd->forces.push_back(scene::Actuator{name, JointId{0}, scene::ConstantMotion{}, name});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // A shell program that has read the first line.
  ControllerProgram start(const std::string& script, std::chrono::milliseconds patience = 10s) {
    std::ofstream(folder_ / "c.sh") << "read greeting\n" << script;
    return ControllerProgram("sh " + (folder_ / "c.sh").string(), scene_, patience, folder_ / "log");
  }
  // The error of one request, without the folder.
  std::string error(const std::string& script, std::chrono::milliseconds patience = 10s) {
    ControllerProgram program = start(script, patience);
    try {
      program.inputs({3'000'000}, {.1, .2});
    } catch (const Error& e) {
      code_ = e.code();
      std::string text = e.what();
      const std::string path = folder_.string() + "/";
      for (std::size_t at; (at = text.find(path)) != std::string::npos;) text.erase(at, path.size());
      return text;
    }
    return "no error";
  }
  std::string answered(const std::string& line) { return error("read line; echo '" + line + "'; read line"); }
  std::string text_of(const char* file) {
    std::stringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    return text.str();
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_controller_" + std::to_string(getpid()));
  scene::Scene scene_;
  ErrorCode code_{};
};

TEST_F(ControllerTest, IsToldSensorsAndGivesInputs) {
  const std::string f = folder_.string();
  {
    ControllerProgram program = start(
        "echo \"$greeting\" > " + f + "/told\nn=0\nwhile read line; do echo \"$line\" >> " + f +
        "/told; n=$((n + 1)); echo '{\"inputs\": {\"right\": -2.5, \"left\": '$n'}}'; done; echo end >> " +
        f + "/told");
    EXPECT_EQ(program.inputs({0}, {.1, -1. / 3}), (std::vector<double>{1, -2.5}));
    EXPECT_EQ(program.inputs({1'000'000}, {5, 1e-9}), (std::vector<double>{2, -2.5}));
  }
  EXPECT_EQ(
      text_of("told"),
      R"({"scene":"machine","window":0.001,"end_time":2.0,"sensors":["hinge.q","hinge.rate"],"inputs":["left","right"]}
{"time":0.0,"sensors":{"hinge.q":0.1,"hinge.rate":-0.3333333333333333}}
{"time":0.001,"sensors":{"hinge.q":5.0,"hinge.rate":1e-09}}
end
)");
}

TEST_F(ControllerTest, AnswersMayComeInPieces) {
  ControllerProgram program = start(
      "read line; printf '{\"inputs\": {\"left\"'; sleep 0.05; printf ': 1, \"right\": 2}}\\n'; read line");
  EXPECT_EQ(program.inputs({0}, {0, 0}), (std::vector<double>{1, 2}));
}

TEST_F(ControllerTest, WrongAnswersAreShown) {
  const std::string begin = "controller 'sh c.sh': answered '",
                    end = " at t = 0.003 s (docs/control.md describes the lines)";
  EXPECT_EQ(answered("3.5"), begin + "3.5': no JSON object with \"inputs\"" + end);
  EXPECT_EQ(code_, ErrorCode::protocol);
  EXPECT_EQ(answered("ready"), begin + "ready': no JSON object with \"inputs\"" + end);
  EXPECT_EQ(answered(R"({"inputs": [1, 2]})"),
            begin + R"({"inputs": [1, 2]}': no JSON object with "inputs")" + end);
  EXPECT_EQ(answered(R"({"inputs": {"left": 1}})"),
            begin + R"({"inputs": {"left": 1}}': input 'right' is missing)" + end);
  EXPECT_EQ(answered(R"({"inputs": {"left": 1, "right": "2"}})"),
            begin + R"({"inputs": {"left": 1, "right": "2"}}': input 'right' is no number)" + end);
  EXPECT_EQ(
      answered(R"({"inputs": {"left": 1, "right": 2, "rihgt": 3}})"),
      begin + R"({"inputs": {"left": 1, "right": 2, "rihgt": 3}}': the scene has no input 'rihgt')" + end);
  EXPECT_EQ(
      answered(R"({"inputs": {"left": 1, "right": 2, "left": 3}})"),
      begin + R"({"inputs": {"left": 1, "right": 2, "left": 3}}': the key 'left' is given twice)" + end);
  EXPECT_EQ(
      answered(R"({"inputs": {}, "inputs": {"left": 1, "right": 2}})"),
      begin + R"({"inputs": {}, "inputs": {"left": 1, "right": 2}}': the key 'inputs' is given twice)" + end);
  EXPECT_EQ(answered(R"({"inputs": {"left": 1, "right": 2}, "": 0, "": 1})"),
            begin + R"({"inputs": {"left": 1, "right": 2}, "": 0, "": 1}': the key '' is given twice)" + end);
  EXPECT_EQ(answered(R"({"time": 0, "inputs": {"left": 1, "right": 2}})"),
            begin + R"({"time": 0, "inputs": {"left": 1, "right": 2}}': the key 'time' is unknown)" + end);
  EXPECT_EQ(answered(R"({"inputs": {"left": 1, "right": 1e999}})"),
            begin + R"({"inputs": {"left": 1, "right": 1e999}}': no JSON object with "inputs")" + end);
}

TEST_F(ControllerTest, AnswersWithoutAQuestionAreRefused) {
  const std::string hint = " (answer each line with \"time\" once; docs/control.md describes the lines)";
  const std::string answer = R"({"inputs": {"left": 1, "right": 2}})";
  // Both at once, so that the second one has arrived when the first is read.
  EXPECT_EQ(error("read line; printf '" + answer + "\\nagain\\n'; read line"),
            "controller 'sh c.sh': sent 'again' without being asked at t = 0.003 s" + hint);
  EXPECT_EQ(code_, ErrorCode::protocol);
  // Between two requests.
  ControllerProgram program = start("read line; echo '" + answer + "'; sleep 0.2; echo later; read line");
  program.inputs({0}, {0, 0});
  std::this_thread::sleep_for(1s);
  EXPECT_THROW(program.inputs({1'000'000}, {0, 0}), Error);
}

TEST_F(ControllerTest, DeepAndLongAnswersAreShownByTheirBegin) {
  const std::string said = error("read line; head -c 500000 /dev/zero | tr '\\0' '['; echo; read line");
  EXPECT_EQ(said,
            "controller 'sh c.sh': answered '" + std::string(97, '[') +
                "...': no JSON object with \"inputs\" at t = 0.003 s (docs/control.md describes the lines)");
}

TEST_F(ControllerTest, AnEndIsTold) {
  const std::string hint = " (its own messages are in run.log; it has to answer until its input ends)";
  EXPECT_EQ(error("echo 'no idea' >&2; exit 7"),
            "controller 'sh c.sh': exited with status 7 at t = 0.003 s" + hint);
  EXPECT_EQ(code_, ErrorCode::peer_lost);
  EXPECT_EQ(text_of("log"), "no idea\n");
  EXPECT_EQ(error("kill -9 $$"),
            "controller 'sh c.sh': was killed by signal 9 (Killed) at t = 0.003 s" + hint);
}

TEST_F(ControllerTest, AProgramThatDoesNotExistIsTold) {
  ControllerProgram program("/no/such/program", scene_, 10s, folder_ / "log");
  EXPECT_THROW(program.inputs({0}, {0, 0}), Error);
  EXPECT_NE(text_of("log").find("/no/such/program"), std::string::npos);
}

TEST_F(ControllerTest, SilenceIsBoundedAndTold) {
  EXPECT_EQ(error("read line; read line", 100ms),
            "controller 'sh c.sh': did not answer within 0.1 s at t = 0.003 s (it has to flush each line; "
            "--patience "
            "gives it more time)");
  EXPECT_EQ(code_, ErrorCode::timeout);
}

}  // namespace
}  // namespace tandem::launch

// A temporary folder with a scene and a study of it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "launch/study/plan.hpp"

namespace tandem::launch {

class StudyFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    put("scene.json",
        R"({"tandem": "1.0", "name": "pendulum", "end_time": 1, "coupling": {"window": 0.01}, "mbd": {
      "bodies": [{"name": "bob", "mass": 1, "inertia": [1, 1, 1], "position": [1, 0, 0]}],
      "joints": [{"name": "hinge", "type": "revolute", "child": "bob", "position": [0, 0, 0], "axis": [0, 1, 0]}]}})");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  // A valid study; `change` is merged into it, null removes a key.
  Study study(const std::string& change = "{}") const {
    auto json = nlohmann::json::parse(R"({"study": "1.0", "name": "s", "scene": "scene.json",
      "sweep": [{"of": "window", "values": [0.01, 0.02]}, {"of": "rho_inf", "values": [0.5, 0.9]}],
      "order_in": "window",
      "reference": {"type": "table", "times": [0.5, 1], "signals": [{"of": "hinge.q", "values": [1, 2]}]},
      "measures": [{"name": "angle", "of": ["hinge.q"]}]})");
    json.merge_patch(nlohmann::json::parse(change));
    put("study.json", json.dump());
    return read_study(folder_ / "study.json");
  }
  // The error that `work` throws, without the folder.
  template <class Work>
  std::string message(const Work& work) const {
    try {
      work();
    } catch (const Error& error) {
      std::string text = error.what();
      const std::string path = folder_.string() + "/";
      for (std::size_t at; (at = text.find(path)) != std::string::npos;) text.erase(at, path.size());
      return text;
    }
    return "no error";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_study_" + std::to_string(getpid()));
};

}  // namespace tandem::launch

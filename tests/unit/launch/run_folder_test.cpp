#include "launch/coordinator/run_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "common/error.hpp"
#include "launch/verdict/status.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

class RunFolder : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::temp_directory_path() / ("tandem_folder_" + std::to_string(getpid()));
    fs::create_directories(base_);
  }
  void TearDown() override { fs::remove_all(base_); }
  void touch(const fs::path& file) { std::ofstream(file) << "x"; }
  ErrorCode refused(const fs::path& folder) {
    try {
      prepare_run_folder(folder);
    } catch (const Error& error) {
      return error.code();
    }
    return {};
  }
  fs::path base_;
};

TEST_F(RunFolder, IsCreatedWithItsParents) {
  prepare_run_folder(base_ / "a" / "b");
  EXPECT_TRUE(fs::exists(base_ / "a" / "b" / "run.log"));
}

TEST_F(RunFolder, AnEarlierRunIsRemoved) {
  prepare_run_folder(base_ / "run");
  touch(base_ / "run" / "report.html");
  prepare_run_folder(base_ / "run");
  EXPECT_FALSE(fs::exists(base_ / "run" / "report.html"));
}

TEST_F(RunFolder, ARunThatGoesOnKeepsItsFolderAndADeadOneDoesNot) {
  prepare_run_folder(base_ / "run");
  nlohmann::json summary{{"status", "running"}, {"process", this_process()}};
  std::ofstream(base_ / "run" / "summary.json") << summary;
  EXPECT_EQ(refused(base_ / "run"), ErrorCode::usage);
  EXPECT_TRUE(fs::exists(base_ / "run" / "summary.json"));
  summary["process"]["started"] = 1;
  std::ofstream(base_ / "run" / "summary.json") << summary;
  EXPECT_TRUE(prepare_run_folder(base_ / "run"));
  EXPECT_FALSE(prepare_run_folder(base_ / "run"));
}

TEST_F(RunFolder, AnotherFolderIsLeftAlone) {
  touch(base_ / "thesis.tex");
  EXPECT_EQ(refused(base_), ErrorCode::usage);
  EXPECT_TRUE(fs::exists(base_ / "thesis.tex"));
}

TEST_F(RunFolder, AFileIsNoFolder) {
  touch(base_ / "file");
  EXPECT_EQ(refused(base_ / "file"), ErrorCode::usage);
  EXPECT_EQ(refused(base_ / "file" / "below"), ErrorCode::resource);
}

}  // namespace
}  // namespace tandem::launch

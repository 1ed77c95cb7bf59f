// Ownership of a result folder, deletion of files in it, and the state of its run.
#include "launch/run_folder/run_folder.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <set>

#include "common/error.hpp"
#include "launch/run_folder/own_files.hpp"
#include "launch/run_folder/ps.hpp"
#include "launch/run_folder/registry.hpp"
#include "launch/run_folder/run_state.hpp"
#include "launch/verdict/status.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::temp_directory_path() / ("tandem_folder_" + std::to_string(getpid()));
    fs::create_directories(base_);
  }
  void TearDown() override { fs::remove_all(base_); }
  static void touch(const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
  }
  // The contents of the run's folder, relative to it, including folders.
  std::set<std::string> there() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(run_))
      names.insert(entry.path().lexically_relative(run_).string());
    return names;
  }
  std::string refusal(const fs::path& folder, ErrorCode code = ErrorCode::usage) {
    try {
      const RunFolder claimed(folder, "toy");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      return error.what();
    }
    return "none";
  }
  // A process that claims the folder, calls `then` and waits to be killed.
  template <class Then>
  void die_in_folder(Then then) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
      const RunFolder folder(run_, "toy");
      then();
      if (write(ready[1], "x", 1) == 1) pause();
      _exit(1);
    }
    char byte = 0;
    ASSERT_EQ(read(ready[0], &byte, 1), 1);
    while_it_runs();
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(ready[0]);
    close(ready[1]);
  }
  std::function<void()> while_it_runs = [] {};

  fs::path base_, run_ = fs::temp_directory_path() / ("tandem_folder_" + std::to_string(getpid())) / "run";
};

TEST_F(RunFolderTest, AnEmptyNameIsRefused) {
  EXPECT_THAT(refusal(""), testing::HasSubstr("give the name of a folder"));
}

TEST_F(RunFolderTest, LinksToFoldersOfOtherRunsAreRefused) {
  for (const char* name : {"frames", "checkpoint", "half_steps"}) {
    { const RunFolder earlier(run_, "toy"); }
    touch(base_ / "other" / "precious");
    fs::create_directory_symlink(base_ / "other", run_ / name);
    EXPECT_THAT(refusal(run_), testing::HasSubstr("is a link, and a run writes into its own folder only"))
        << name;
    EXPECT_TRUE(fs::exists(base_ / "other" / "precious"));
    fs::remove(run_ / name);
  }
  EXPECT_EQ(refusal(run_), "none");
}

TEST_F(RunFolderTest, IsCreatedWithItsParentsAndMarked) {
  const RunFolder folder(base_ / "a" / "b", "toy");
  const auto marker = read_marker(base_ / "a" / "b");
  ASSERT_TRUE(marker);
  EXPECT_EQ(marker->scene, "toy");
  EXPECT_EQ(marker->owner, geteuid());
  EXPECT_EQ(marker->pid, getpid());
  EXPECT_FALSE(marker->ended);
  EXPECT_EQ(marker->lock, Lock::held);
  EXPECT_EQ(life_of(*marker), Life::lives);
}

TEST_F(RunFolderTest, WhatARunWroteIsRemovedAndNothingElse) {
  { const RunFolder folder(run_, "toy"); }
  const std::vector<std::string> own{"summary.json",
                                     "run.log",
                                     "report.html.new",
                                     "frames/particles_000012.h5",
                                     "frames/bodies_1000000.h5.new",
                                     "frames/surfaces.h5",
                                     "checkpoint/window_000120/dem.h5",
                                     "checkpoint/window_1000000/mbd.h5.part",
                                     "movie.mp4",
                                     "movie_frames/still_000012.png",
                                     "half_steps/tandem_run.json",
                                     "half_steps/bodies.csv",
                                     "half_steps/frames/bodies_000000.h5"};
  for (const std::string& name : own) {
    touch(run_ / name);
    EXPECT_TRUE(is_own_file(name)) << name;
  }
  const std::set<std::string> others{"photos",
                                     "photos/run.log",
                                     "thesis.tex",
                                     "frames/mine.h5",
                                     "frames/particles_12.h5",
                                     "frames/checkpoint",
                                     "movie_frames/still_of_mine.png",
                                     "checkpoint/window_000120/notes.txt"};
  for (const std::string& name : others)
    if (name != "photos") touch(run_ / name);
  for (const std::string& name : others) EXPECT_FALSE(is_own_file(name)) << name;
  fs::create_symlink("/etc", run_ / "half_steps" / "checkpoint");

  const RunFolder folder(run_, "toy");
  std::set<std::string> expected = others;
  expected.insert({"tandem_run.json", "summary.json.reserve", "frames", "checkpoint",
                   "checkpoint/window_000120", "half_steps", "half_steps/checkpoint", "movie_frames"});
  EXPECT_EQ(there(), expected);
  EXPECT_EQ(folder.others().size(), 8u);
}

TEST_F(RunFolderTest, FoldersOfNoRunAreLeftAlone) {
  touch(base_ / "thesis.tex");
  EXPECT_NE(refusal(base_).find("holds files, but none of an earlier run"), std::string::npos);
  touch(run_ / "run.log");
  touch(run_ / "photos" / "me.jpg");
  const std::string said = refusal(run_);
  EXPECT_NE(said.find("older version of tandem"), std::string::npos) << said;
  EXPECT_EQ(there(), (std::set<std::string>{"run.log", "photos", "photos/me.jpg"}));
}

TEST_F(RunFolderTest, ARunThatGoesOnKeepsItsFolderAndADeadOneDoesNot) {
  while_it_runs = [this] {
    EXPECT_EQ(read_run(run_).status, "running");
    const std::string said = refusal(run_);
    EXPECT_NE(said.find("still in progress in this folder: pid "), std::string::npos) << said;
  };
  die_in_folder([] {});
  EXPECT_EQ(read_run(run_).status, "died");
  {
    const RunFolder next(run_, "toy");
    EXPECT_TRUE(next.earlier_died());
  }
  const RunFolder next(run_, "toy");
  EXPECT_FALSE(next.earlier_died());
}

TEST_F(RunFolderTest, ARunThatDiedBeforeItWroteItsMarkerIsNoObstacle) {
  touch(run_ / marker_name);
  fs::resize_file(run_ / marker_name, 0);
  const RunFolder next(run_, "toy");
  EXPECT_TRUE(next.earlier_died());
}

TEST_F(RunFolderTest, OfTwoThatStartAtOnceOneRuns) {
  const RunFolder first(run_, "toy");
  EXPECT_NE(refusal(run_).find("still in progress"), std::string::npos);
}

TEST_F(RunFolderTest, ALockFreeFileSystemAndAnotherHostAreNoGuess) {
  Marker marker = own_marker("toy");
  marker.lock = Lock::unknown;
  EXPECT_EQ(life_of(marker), Life::lives) << "by its process";
  marker.started += 1;
  EXPECT_EQ(life_of(marker), Life::gone);
  marker.host = "elsewhere";
  EXPECT_EQ(life_of(marker), Life::unknown);
  marker.lock = Lock::free;
  EXPECT_EQ(life_of(marker), Life::gone);
  marker.lock = Lock::held;
  EXPECT_EQ(life_of(marker), Life::lives);
}

TEST_F(RunFolderTest, AFolderThatWasDeletedOrReplacedIsNoticed) {
  const RunFolder folder(run_, "toy");
  folder.expect_there();
  fs::remove_all(run_);
  EXPECT_THROW(folder.expect_there(), Error);
  fs::create_directories(run_);
  touch(run_ / marker_name);
  touch(run_ / reserve_name);
  EXPECT_THROW(folder.expect_there(), Error);
}

TEST_F(RunFolderTest, AFolderThatWasMovedIsStillHeld) {
  const RunFolder folder(run_, "toy");
  fs::rename(run_, base_ / "moved");
  touch(run_ / marker_name);
  EXPECT_THROW(folder.expect_there(), Error);
  touch(folder.held() / "here");
  EXPECT_TRUE(fs::exists(base_ / "moved" / "here"));
}

TEST_F(RunFolderTest, ATableThatWasDeletedOrReplacedIsNoticed) {
  RunFolder folder(run_, "toy");
  touch(run_ / "windows.csv");
  touch(run_ / "mine.csv");
  folder.watch_files();
  fs::remove(run_ / "mine.csv");
  folder.expect_there();
  fs::rename(run_ / "windows.csv", run_ / "old.csv");
  EXPECT_THROW(folder.expect_there(), Error);
  touch(run_ / "windows.csv");
  EXPECT_THROW(folder.expect_there(), Error) << "another file with its name";
}

TEST_F(RunFolderTest, AFileIsNoFolderAndAMarkerIsNoLink) {
  touch(base_ / "file");
  EXPECT_NE(refusal(base_ / "file").find("is not a folder"), std::string::npos);
  EXPECT_NE(refusal(base_ / "file" / "below", ErrorCode::resource).find("cannot be created"),
            std::string::npos);
  touch(base_ / "precious");
  fs::create_directories(run_);
  fs::create_symlink(base_ / "precious", run_ / marker_name);
  refusal(run_);
  EXPECT_EQ(fs::file_size(base_ / "precious"), 1u);
}

TEST_F(RunFolderTest, DiedIsWhatTheSummarySaysWithoutALivingWriter) {
  { const RunFolder folder(run_, "toy"); }
  nlohmann::json summary{{"status", "running"},
                         {"process", {{"host", "elsewhere"}, {"pid", 1}, {"started", 1}}}};
  std::ofstream(run_ / "summary.json") << summary;
  EXPECT_EQ(read_run(run_).status, "died") << "the lock is free";
  summary["status"] = "ok";
  std::ofstream(run_ / "summary.json") << summary;
  EXPECT_EQ(read_run(run_).status, "ok");
  EXPECT_EQ(read_run(base_ / "nothing").status, "");
}

class Registry : public RunFolderTest {
 protected:
  void SetUp() override {
    RunFolderTest::SetUp();
    setenv("TANDEM_RUNS", (base_ / "runs").c_str(), 1);
  }
  void TearDown() override {
    unsetenv("TANDEM_RUNS");
    RunFolderTest::TearDown();
  }
};

TEST_F(Registry, ListsRunsThatGoOnAndThatDied) {
  EXPECT_EQ(list_of_runs(), "no runs\n");
  while_it_runs = [this] {
    const auto runs = registered_runs();
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].folder, run_);
    EXPECT_EQ(runs[0].state.status, "running");
    EXPECT_NE(list_of_runs().find(run_.string()), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(list_of_runs_as_json()).at(0).at("status"), "running");
  };
  std::optional<RegistryEntry> entry;  // of the child
  die_in_folder([&] { entry.emplace(run_); });
  ASSERT_EQ(registered_runs().size(), 1u);
  EXPECT_EQ(registered_runs()[0].state.status, "died");
  EXPECT_EQ(forget_died_runs(), 1);
  EXPECT_EQ(registered_runs().size(), 0u);
}

TEST_F(Registry, DropsEntriesOfFoldersThatAreGoneOrTaken) {
  std::optional<RegistryEntry> entry;
  die_in_folder([&] { entry.emplace(run_); });
  {
    const RunFolder next(run_, "toy");
    EXPECT_EQ(registered_runs().size(), 0u) << "another run has the folder";
  }
  die_in_folder([&] { entry.emplace(run_); });
  fs::remove_all(run_);
  EXPECT_EQ(registered_runs().size(), 0u);
}

TEST_F(Registry, IsNotTakenFromAnotherUser) {
  fs::create_directories(base_ / "runs");
  fs::permissions(base_ / "runs", fs::perms::all);
  EXPECT_EQ(registry_folder(), fs::path());
  const RegistryEntry none(run_);
  EXPECT_TRUE(fs::is_empty(base_ / "runs"));
}

TEST_F(Registry, StopsARunAndSaysWhatIsNone) {
  const auto said = [](const std::string& run) {
    try {
      stop_run(run, std::chrono::seconds(5));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(said("12345678").find("is no run in progress here"), std::string::npos);
  EXPECT_NE(said(base_).find("is no run in progress here"), std::string::npos);
  std::optional<RegistryEntry> entry;
  while_it_runs = [&] {
    // SIGTERM ends the child. It remains a zombie here, which holds no lock.
    EXPECT_EQ(said(std::to_string(registered_runs().at(0).pid)), "none");
    EXPECT_EQ(read_run(run_).status, "died");
  };
  die_in_folder([&] { entry.emplace(run_); });
}

}  // namespace
}  // namespace tandem::launch

// Ownership of a result folder, deletion of files in it, and the state of its run.
#include "coordinator/run_folder/run_folder.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <set>

#include "common/error.hpp"
#include "coordinator/run_folder/claimed_folder.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/run_folder/ps.hpp"
#include "coordinator/run_folder/registry.hpp"
#include "coordinator/run_folder/run_state.hpp"
#include "coordinator/verdict/status.hpp"

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
  for (const char* name : {"frames", "checkpoint", "half_steps", "scene"}) {
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
                                     "scene/scene.json",
                                     "scene/file_0123456789abcdef.stl",
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
                                     "scene/file_of_mine.stl",
                                     "movie_frames/still_of_mine.png",
                                     "checkpoint/window_000120/notes.txt"};
  for (const std::string& name : others)
    if (name != "photos") touch(run_ / name);
  for (const std::string& name : others) EXPECT_FALSE(is_own_file(name)) << name;
  fs::create_symlink("/etc", run_ / "half_steps" / "checkpoint");

  const RunFolder folder(run_, "toy");
  std::set<std::string> expected = others;
  expected.insert({"tandem_run.json", "summary.json.reserve", "frames", "checkpoint",
                   "checkpoint/window_000120", "half_steps", "half_steps/checkpoint", "movie_frames",
                   "scene"});
  EXPECT_EQ(there(), expected);
  EXPECT_EQ(folder.others().size(), 9u);
}

TEST_F(RunFolderTest, NoInputOfTheRunIsDeleted) {
  { const RunFolder folder(run_, "toy"); }
  for (const char* name : {"bodies.csv", "frames/particles_000012.h5", "half_steps/summary.json"})
    touch(run_ / name);
  touch(base_ / "mesh.stl");
  fs::create_symlink(base_ / "mesh.stl", run_ / "joints.csv");
  fs::create_symlink(run_ / "bodies.csv", base_ / "link.csv");
  fs::create_directory_symlink(run_, base_ / "run_by_another_name");
  const std::set<std::string> before = there();
  const auto refused = [this](const fs::path& input, const fs::path& folder) {
    try {
      const RunFolder claimed(folder, "toy", 1 << 16, {base_ / "mesh.stl", input});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      return std::string(error.what());
    }
    return std::string("none");
  };
  for (const fs::path& folder : {run_, base_ / "run_by_another_name"})
    for (const fs::path& input :
         {run_ / "bodies.csv", run_ / "joints.csv", base_ / "link.csv", run_, run_ / "frames",
          base_ / "run_by_another_name" / "half_steps" / ".." / "bodies.csv"}) {
      EXPECT_THAT(refused(input, folder), testing::HasSubstr("is an input of this run")) << input;
      EXPECT_EQ(there(), before) << input;
    }
  // A copy of the folder, with a link to its frames; and a link back to itself.
  fs::create_directories(base_ / "copy" / "inner");
  fs::create_directory_symlink("../../run/frames", base_ / "copy" / "inner" / "frames");
  fs::create_directory_symlink("..", base_ / "copy" / "inner" / "back");
  for (const fs::path& input : {base_ / "copy", base_ / "copy/inner/frames/particles_000012.h5"})
    EXPECT_THAT(refused(input, run_), testing::HasSubstr("is an input of this run")) << input;
  EXPECT_EQ(there(), before);
  touch(run_ / "bed.csv");
  EXPECT_EQ(refused(run_ / "bed.csv", run_), "none") << "no run deletes it";
  EXPECT_FALSE(fs::exists(run_ / "bodies.csv"));
}

TEST_F(RunFolderTest, OtherVerbsClaimTheirFoldersToo) {
  const auto refused = [this](const fs::path& input = {}) {
    try {
      claim_folder(run_, {"study", {"scenes", "results.csv"}, {base_ / "study.json", input}});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      return std::string(error.what());
    }
    return std::string("none");
  };
  for (const char* name : {"scenes/mine.json", "results.csv"}) {
    touch(run_ / name);
    touch(run_ / "thesis.tex");
    EXPECT_THAT(refused(), testing::HasSubstr("is not of tandem study, which would overwrite it")) << name;
    fs::remove_all(run_);
  }
  fs::create_directories(run_);
  fs::create_symlink("nowhere", run_ / "results.csv");
  EXPECT_THAT(refused(), testing::HasSubstr("would overwrite it")) << "a link that leads nowhere";
  fs::remove(run_ / "results.csv");
  touch(run_ / "thesis.tex");
  EXPECT_EQ(refused(), "none");
  touch(run_ / "results.csv");
  EXPECT_EQ(refused(), "none") << "the second time, its own";
  EXPECT_EQ(there(), (std::set<std::string>{"results.csv", "tandem_study.json", "thesis.tex"}));
  EXPECT_THAT(refused(run_ / "scenes" / "a.json"), testing::HasSubstr("is an input of this tandem study"));
  fs::create_directory_symlink(run_, base_ / "link");
  EXPECT_THAT(refused(base_ / "link" / "results.csv"),
              testing::HasSubstr("is an input of this tandem study"));
  EXPECT_THAT(refused(run_ / "tandem_study.json"), testing::HasSubstr("is an input of this tandem study"));
  fs::create_symlink(base_ / "elsewhere.json", run_ / "scenes");
  EXPECT_THAT(refused(run_ / "scenes"), testing::HasSubstr("is an input of this tandem study")) << "a link";
  if (geteuid() != 0) return;
  ASSERT_EQ(chown((run_ / "tandem_study.json").c_str(), 65534, 65534), 0);
  EXPECT_THAT(refused(), testing::HasSubstr("belongs to another user (uid 65534)"));
}

TEST_F(RunFolderTest, AFileThatHasTheNameOfAMarkIsLeftAlone) {
  const fs::path mark = run_ / "tandem_study.json";
  const auto refused = [this] {
    try {
      claim_folder(run_, {"study", {"results.csv"}, {}});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      return std::string(error.what());
    }
    return std::string("none");
  };
  fs::create_directories(run_);
  for (const char* text : {"", "x", "[]", R"({"study": "1.0"})", R"({"format": "tandem conform folder"})"}) {
    std::ofstream(mark) << text;
    EXPECT_THAT(refused(), testing::HasSubstr("tandem study has not written it")) << text;
    std::ifstream file(mark);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), text);
  }
  fs::remove(mark);
  fs::create_symlink("nowhere", mark);
  EXPECT_THAT(refused(), testing::HasSubstr("tandem study has not written it")) << "a link";
  fs::remove(mark);
  EXPECT_EQ(refused(), "none");
  EXPECT_EQ(refused(), "none") << "the second time, its own";
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
    const auto listed = [] { return nlohmann::json::parse(list_of_runs_as_json()).at(0); };
    EXPECT_EQ(listed().at("status"), "running");
    EXPECT_TRUE(listed().at("left_s").is_null());
    std::ofstream(run_ / "summary.json") << R"({"status": "running", "simulated_s": 3, "restarted_at_s": 1,
                                                "end_time_s": 4, "wall_s": 1800})";
    EXPECT_EQ(listed().at("left_s"), 900);
    EXPECT_THAT(list_of_runs(), testing::HasSubstr(" 15 min 00 s "));
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
  EXPECT_NE(said("12345678").find("no such run is in progress on this host"), std::string::npos);
  EXPECT_NE(said(base_).find("no such run is in progress on this host"), std::string::npos);
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

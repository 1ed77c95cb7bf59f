// The folders in which a server may read and write, and its treatment of paths that lead elsewhere.
#include "protocol/participant/state_folders.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace tandem::protocol {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StateFoldersTest : public testing::Test {
 protected:
  StateFoldersTest() {
    fs::create_directories(given / "window_000001");
    fs::create_directories(outside);
    write(given / "window_000001" / "mbd.h5", "inside");
    write(outside / "secret", "outside");
  }
  ~StateFoldersTest() override { fs::remove_all(root); }

  static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string read(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  void expect_refused(const fs::path& path, ErrorCode code, const std::string& sentence) const {
    for (const bool writes : {false, true}) {
      try {
        writes ? folders.to_write(path) : folders.to_read(path);
        ADD_FAILURE() << path << " was accepted";
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        EXPECT_THAT(e.what(), HasSubstr(sentence));
      }
    }
  }

  const fs::path root = fs::temp_directory_path() / ("tandem_state_folders_" + std::to_string(getpid()));
  const fs::path given = (fs::create_directories(root / "given"), root / "given"), outside = root / "outside";
  const StateFolders folders{{given.string()}};
};

TEST_F(StateFoldersTest, FilesInsideAreReadAndWritten) {
  EXPECT_EQ(read(folders.to_read(given / "window_000001" / "mbd.h5").path()), "inside");
  const StatePlace place = folders.to_write(given / "window_000001" / "dem.h5");
  write(place.path(), "new");
  EXPECT_EQ(read(given / "window_000001" / "dem.h5"), "new");
}

TEST_F(StateFoldersTest, WithoutAFolderNothingIsWrittenOrRead) {
  const StateFolders none{{}};
  for (const bool writes : {false, true}) {
    try {
      writes ? none.to_write(given / "x") : none.to_read(given / "x");
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
      EXPECT_THAT(e.what(), HasSubstr("it was given no folder for states"));
    }
  }
}

TEST_F(StateFoldersTest, PathsThatLeadOutsideAreRefused) {
  expect_refused(outside / "secret", ErrorCode::usage, "outside of the folders for states");
  expect_refused(given / ".." / "outside" / "secret", ErrorCode::usage, "outside of the folders for states");
  expect_refused(given, ErrorCode::usage, "outside of the folders for states");
  expect_refused(given.string() + "x/y", ErrorCode::usage, "outside of the folders for states");
  expect_refused("/etc/passwd", ErrorCode::usage, "outside of the folders for states");
}

TEST_F(StateFoldersTest, LinksAreNotFollowed) {
  fs::create_directory_symlink(outside, given / "linked");
  expect_refused(given / "linked" / "secret", ErrorCode::resource, "linked: is a symbolic link");
  fs::create_symlink(outside / "secret", given / "file");
  EXPECT_THROW(folders.to_read(given / "file"), Error);
}

TEST_F(StateFoldersTest, APlaceStaysWhereItWasWhenItsNameIsTurnedIntoALink) {
  const StatePlace place = folders.to_write(given / "window_000001" / "mbd.h5");
  fs::rename(given / "window_000001", given / "moved");
  fs::create_directory_symlink(outside, given / "window_000001");
  write(place.path(), "new");
  EXPECT_EQ(read(given / "moved" / "mbd.h5"), "new");
  EXPECT_FALSE(fs::exists(outside / "mbd.h5"));
}

TEST_F(StateFoldersTest, APipeDoesNotHoldTheServer) {
  ASSERT_EQ(mkfifo((given / "pipe").c_str(), 0600), 0);
  try {
    folders.to_read(given / "pipe");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("is no plain file"));
  }
}

TEST_F(StateFoldersTest, ErrorsNameThePathThatWasAskedFor) {
  const fs::path path = given / "window_000001" / "mbd.h5";
  const StatePlace place = folders.to_read(path);
  const Error error =
      place.translated({ErrorCode::resource, "is damaged", place.path(), "see " + place.path()});
  EXPECT_EQ(error.where(), path.string());
  EXPECT_EQ(error.hint(), "see " + path.string());
}

TEST(StateFolders, WhatIsNoFolderIsRefused) {
  EXPECT_THROW(StateFolders({"/dev/null"}), Error);
  EXPECT_THROW(StateFolders({"/does/not/exist"}), Error);
}

}  // namespace
}  // namespace tandem::protocol

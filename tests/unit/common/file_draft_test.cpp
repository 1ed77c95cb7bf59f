#include "common/file_draft.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "common/error.hpp"

namespace tandem {
namespace {

namespace fs = std::filesystem;

class FileDraftTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string text() const {
    std::ifstream file(folder_ / "file");
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const fs::path folder_ = fs::temp_directory_path() / ("tandem_draft_" + std::to_string(getpid()));
};

TEST_F(FileDraftTest, ReplacesAsAWholeOrNotAtAll) {
  replace_file(folder_ / "file", "old");
  {
    FileDraft draft(folder_ / "file");
    draft.append("new and longer");
    EXPECT_EQ(text(), "old");
  }
  EXPECT_EQ(text(), "old") << "not committed";
  EXPECT_FALSE(fs::exists(folder_ / "file.new"));
  replace_file(folder_ / "file", "new", Durability::power);
  EXPECT_EQ(text(), "new");
}

TEST_F(FileDraftTest, TakesTheBeginOfAnotherFile) {
  replace_file(folder_ / "file", std::string(100'000, 'x') + "tail");
  FileDraft draft(folder_ / "file");
  draft.append_from(folder_ / "file", 100'000);
  draft.append("end");
  draft.commit();
  EXPECT_EQ(text(), std::string(100'000, 'x') + "end");
  EXPECT_THROW(FileDraft(folder_ / "file").append_from(folder_ / "file", 100'004), Error)
      << "shorter than that";
}

TEST_F(FileDraftTest, AFullDiskIsSaidAndKeepsTheOldFile) {
  replace_file(folder_ / "file", "old");
  const pid_t child = fork();
  if (child == 0) {  // a file size limit in place of a full disk
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10, 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      replace_file(folder_ / "file", "more than ten bytes");
    } catch (const Error& error) {
      const bool good = error.code() == ErrorCode::resource && error.where() == folder_ / "file" &&
                        error.problem() == "cannot be written: File too large";
      _exit(good ? 7 : 8);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(text(), "old");
  EXPECT_FALSE(fs::exists(folder_ / "file.new"));
}

TEST_F(FileDraftTest, ALinkInTheWayIsNotFollowed) {
  replace_file(folder_ / "precious", "mine");
  fs::create_symlink(folder_ / "precious", folder_ / "file.new");
  EXPECT_THROW(replace_file(folder_ / "file", "x"), Error);
  EXPECT_EQ(fs::file_size(folder_ / "precious"), 4u);
}

}  // namespace
}  // namespace tandem

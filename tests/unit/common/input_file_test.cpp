#include "common/input_file.hpp"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

namespace tandem {
namespace {

namespace fs = std::filesystem;

class InputFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  static std::string refusal(const fs::path& file, std::uint64_t largest = 1000) {
    std::string said;
    for (const bool whole : {true, false}) {
      try {
        const InputFile input{.code = ErrorCode::usage, .largest = largest, .hint = "give another"};
        whole ? void(read_input(file, input)) : expect_input(file, input);
        return "none";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_TRUE(said.empty() || said == error.what()) << said;
        said = error.what();
      }
    }
    return said;
  }
  fs::path path(const char* name) const { return folder_ / name; }

 private:
  const fs::path folder_ = fs::temp_directory_path() / ("tandem_input_" + std::to_string(getpid()));
};

TEST_F(InputFileTest, APlainFileIsReadAsAWhole) {
  const std::string text = std::string("a\0b", 3) + std::string(10000, 'x');
  std::ofstream(path("file")) << text;
  fs::create_symlink("file", path("link"));
  for (const char* name : {"file", "link"}) EXPECT_EQ(read_input(path(name), {.largest = text.size()}), text);
  std::ofstream(path("empty")) << "";
  EXPECT_EQ(read_input(path("empty"), {.largest = 0}), "");
  EXPECT_FALSE(read_input("/proc/self/stat", {.largest = 10000}).empty()) << "its size is said to be 0";
}

TEST_F(InputFileTest, WhatIsNoPlainFileIsRefusedByItsKind) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path("socket").c_str(), sizeof address.sun_path - 1);
  const int end = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(end, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(end);
  fs::create_symlink("nowhere", path("dangling"));
  const auto said = [&](const char* name, const std::string& rest) {
    return path(name).string() + ": " + rest;
  };
  EXPECT_EQ(refusal("/tmp"), "/tmp: is a folder (give the path of a file)");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device (give the path of a file)");
  EXPECT_EQ(refusal(path("pipe")),
            said("pipe", "is a pipe (write what comes through it to a file, and give that)"));
  EXPECT_EQ(refusal(path("socket")), said("socket", "is a socket (give the path of a file)"));
  EXPECT_EQ(refusal(path("none")), said("none", "does not exist (give another)"));
  EXPECT_EQ(refusal(path("dangling")), said("dangling", "does not exist (give another)"));
}

TEST_F(InputFileTest, MoreThanTheLargestSizeIsRefusedBeforeMemoryIsTaken) {
  std::ofstream(path("file")) << "x";
  ASSERT_EQ(truncate(path("file").c_str(), off_t{1} << 40), 0);  // takes no space on the disk
  const std::string file = path("file").string();
  EXPECT_EQ(refusal(path("file")),
            file + ": has more than 1000 bytes, the most that is read of such a file (give a smaller file)");
  EXPECT_EQ(refusal(path("file"), 256 << 20),
            file + ": has more than 256 MiB, the most that is read of such a file (give a smaller file)");
}

TEST_F(InputFileTest, ASecretIsItsOwnersAlone) {
  std::ofstream(path("file")) << "x";
  const InputFile input{.largest = 10, .secret = "key"};
  fs::permissions(path("file"), fs::perms(0640));
  EXPECT_THAT(
      [&] { read_input(path("file"), input); },
      testing::Throws<Error>(testing::Property(&Error::problem, "other users may read or write this key")));
  fs::permissions(path("file"), fs::perms(0600));
  EXPECT_EQ(read_input(path("file"), input), "x");
  if (geteuid() != 0) return;
  ASSERT_EQ(chown(path("file").c_str(), 65534, 65534), 0);
  EXPECT_THAT([&] { read_input(path("file"), input); },
              testing::Throws<Error>(
                  testing::Property(&Error::problem, "this key belongs to another user (uid 65534)")));
}

}  // namespace
}  // namespace tandem

#include "protocol/secret.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"

namespace tandem::protocol {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string long_enough(32, 's');

class SecretFile : public testing::Test {
 protected:
  ~SecretFile() override {
    unsetenv(secret_variable);
    fs::remove(path);
  }
  void write(const std::string& text,
             fs::perms perms = fs::perms::owner_read | fs::perms::owner_write) const {
    std::ofstream(path) << text;
    fs::permissions(path, perms);
  }
  void expect_no_secret(const std::string& file, const std::string& sentence) const {
    try {
      take_secret(file);
      ADD_FAILURE() << "taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
      EXPECT_THAT(e.what(), HasSubstr(sentence));
      EXPECT_THAT(e.what(), testing::Not(HasSubstr("ssss"))) << "the secret itself is in the message";
    }
  }
  const fs::path path = fs::temp_directory_path() / ("tandem_secret_" + std::to_string(getpid()));
};

TEST_F(SecretFile, ComesByFileOrByEnvironmentAndTheFileCountsFirst) {
  EXPECT_EQ(take_secret(""), "");
  setenv(secret_variable, (long_enough + "e").c_str(), 1);
  write(" " + long_enough + "\n");
  EXPECT_EQ(take_secret(path), long_enough);
  EXPECT_EQ(getenv(secret_variable), nullptr) << "what is started from here would have it";
  setenv(secret_variable, (long_enough + "e\n").c_str(), 1);
  EXPECT_EQ(take_secret(""), long_enough + "e");
  EXPECT_EQ(getenv(secret_variable), nullptr);
}

TEST_F(SecretFile, WhatOthersCanReadOrIsTooShortOrTooLongIsRefused) {
  expect_no_secret(path, "does not exist");
  write(long_enough, fs::perms::owner_read | fs::perms::group_read);
  expect_no_secret(path, "other users may read or write this secret");
  write(long_enough.substr(1));
  expect_no_secret(path, "a secret of 31 characters; 32 to 1024 are needed");
  write(std::string(5000, 's'));
  expect_no_secret(path, "32 to 1024 are needed");
  setenv(secret_variable, "short", 1);
  expect_no_secret("", "TANDEM_SECRET: a secret of 5 characters");
}

// Nobody may ever write to a pipe: opening it must not wait.
TEST_F(SecretFile, APipeOrADeviceIsRefused) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  expect_no_secret(path, "is a pipe");
  expect_no_secret("/dev/zero", "is a device");
}

TEST_F(SecretFile, IsInheritedByAFileWithoutAName) {
  const Fd file = secret_to_inherit(long_enough);
  EXPECT_EQ(take_secret("/proc/self/fd/" + std::to_string(file.get())), long_enough);
}

TEST(Secret, EachIsNewAndLong) {
  const std::string secret = make_secret();
  EXPECT_EQ(secret.size(), 64u);
  EXPECT_NE(secret, make_secret());
}

}  // namespace
}  // namespace tandem::protocol

#include "launch/new_project/new_project.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "tests/support/error_of.hpp"

namespace tandem::launch::test {
namespace {

namespace fs = std::filesystem;
using tandem::test::error_of;
using testing::HasSubstr;
using testing::Not;

class NewProject : public testing::Test {
 protected:
  NewProject() : folder_(fs::temp_directory_path() / ("tandem_new_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~NewProject() override { fs::remove_all(folder_); }
  NewParticipant wanted(const std::string& name = "bed") const {
    return {name, "cpp", "dem", folder_ / "project"};
  }
  std::string text(const char* file) const {
    std::stringstream all;
    all << std::ifstream(folder_ / "project" / file).rdbuf();
    return all.str();
  }
  fs::path folder_;
};

TEST_F(NewProject, HasTheNameInEveryFile) {
  new_participant(wanted());
  for (const char* file : {"CMakeLists.txt", "README.md", "main.cpp", "scene.json"}) {
    EXPECT_THAT(text(file), HasSubstr("bed")) << file;
    EXPECT_THAT(text(file), Not(testing::ContainsRegex("@[A-Z]*@"))) << file;
  }
}

TEST_F(NewProject, LeavesAFolderThatExists) {
  fs::create_directory(folder_ / "project");
  std::ofstream(folder_ / "project/mine") << "mine";
  EXPECT_THAT(error_of([&] { new_participant(wanted()); }),
              HasSubstr("exists already, and is left as it is"));
  EXPECT_EQ(text("mine"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "project"), {}), 1);
}

TEST_F(NewProject, RefusesNamesThatABuildWouldNotTake) {
  for (const char* name : {"", "1st", "a b", "a/b", "..", "-x", "a;b", "test", "all"}) {
    EXPECT_THAT(error_of([&] { new_participant(wanted(name)); }), HasSubstr("NAME: ")) << name;
    EXPECT_FALSE(fs::exists(folder_ / "project")) << name;
  }
  EXPECT_THAT(error_of([&] { new_participant(wanted(std::string(65, 'a'))); }), HasSubstr("NAME: "));
}

TEST_F(NewProject, NamesTheLanguagesThatHaveTemplates) {
  NewParticipant cobol = wanted();
  cobol.language = "cobol";
  EXPECT_THAT(error_of([&] { new_participant(cobol); }),
              testing::AllOf(HasSubstr("no template in 'cobol'"), HasSubstr("c, cpp, fortran")));
  EXPECT_FALSE(fs::exists(folder_ / "project"));
}

}  // namespace
}  // namespace tandem::launch::test

#include "coordinator/results/signals.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <limits>

#include "common/error.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

std::vector<double> column(const Signals& signals, const std::string& name) {
  std::vector<double> values;
  signals.visit({name}, [&](std::span<const double> row) { values.push_back(row[0]); });
  return values;
}

TEST(Signals, StreamsRowsAndReadsThemBack) {
  const toy::Folder folder;
  Signals signals(folder / "s.csv", {"time", "a"});
  signals.append({0.1, 1.0 / 3.0});
  // Each row is on disk at once: a run that dies leaves its rows.
  EXPECT_EQ(toy::text_of(folder / "s.csv"), "time,a\n0.1,0.3333333333333333\n");
  signals.append({0.2, -1e-300});
  EXPECT_EQ(column(signals, "a"), (std::vector<double>{1.0 / 3.0, -1e-300}));
  EXPECT_EQ(signals.rows(), 2u);
  EXPECT_TRUE(signals.has("time"));
  EXPECT_FALSE(signals.has("b"));
}

TEST(Signals, UnknownColumnNamesTheNearest) {
  const toy::Folder folder;
  const Signals signals(folder / "s.csv", {"time", "box.position.z"});
  try {
    column(signals, "box.postion.z");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_NE(error.hint().find("box.position.z"), std::string::npos) << error.what();
  }
}

TEST(Signals, ColumnsComeInTheOrderThatIsAskedFor) {
  const toy::Folder folder;
  Signals signals(folder / "s.csv", {"time", "a", "b", "c"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  signals.append({1, 2, nan, 4});
  signals.visit({"c", "time", "a", "c", "b"}, [&](std::span<const double> row) {
    EXPECT_EQ(std::vector<double>(row.begin(), row.begin() + 4), (std::vector<double>{4, 1, 2, 4}));
    EXPECT_TRUE(std::isnan(row[4]));
  });
}

TEST(Signals, GoesOnFromAMarkOfAnotherFile) {
  const toy::Folder folder;
  Signals first(folder / "first.csv", {"time", "a"});
  first.append({1, 0.1});
  first.append({2, 0.2});
  const RowMark mark = first.mark();
  first.append({3, 0.3});
  Signals second(folder / "second.csv", {"time", "a"});
  second.begin_with(folder / "first.csv", mark);
  second.append({3, 0.3});
  EXPECT_EQ(toy::text_of(folder / "second.csv"), toy::text_of(folder / "first.csv"));
  EXPECT_EQ(second.rows(), 3u);
  EXPECT_EQ(second.mark().digest, first.mark().digest);
}

TEST(Signals, EarlierRowsThatAreNotTheSameAreRefused) {
  const toy::Folder folder;
  Signals first(folder / "first.csv", {"time", "a"});
  first.append({1, 0.1});
  const RowMark mark = first.mark();
  const std::string whole = toy::text_of(folder / "first.csv");
  for (const auto& [text, problem] :
       std::vector<std::pair<std::string, std::string>>{{"time,a\n1,0.2\n", "was changed"},
                                                        {"time,a\n1,0.", "shorter than when"},
                                                        {"", "shorter than when"}}) {
    std::ofstream(folder / "first.csv") << text;
    try {
      Signals(folder / "second.csv", {"time", "a"}).begin_with(folder / "first.csv", mark);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::resource);
      EXPECT_EQ(error.where(), folder / "first.csv");
      EXPECT_NE(error.problem().find(problem), std::string::npos) << error.what();
    }
  }
  std::ofstream(folder / "first.csv") << whole;
  Signals(folder / "second.csv", {"time", "a"}).begin_with(folder / "first.csv", mark);
}

TEST(Signals, RowsThatWereLostAreNoticed) {
  const toy::Folder folder;
  Signals signals(folder / "s.csv", {"time", "a"});
  signals.append({1, 0.1});
  std::filesystem::resize_file(folder / "s.csv", 9);
  EXPECT_THROW(column(signals, "a"), Error);
}

TEST(RowFile, AFullDiskTakesNoPartOfALine) {
  const toy::Folder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // a file size limit in place of a full disk
    std::signal(SIGXFSZ, SIG_IGN);
    RowFile file(folder / "rows.csv", "time,a");
    const rlimit limit{100, 100};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      for (int i = 0; i < 100; ++i) file.append("0.123456789,1\n");
    } catch (const Error& error) {
      _exit(error.code() == ErrorCode::resource ? 7 : 8);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  const std::string text = toy::text_of(folder / "rows.csv");
  EXPECT_EQ(text.size(), 7u + 6 * 14) << "as many whole lines as fit into 100 bytes";
  EXPECT_TRUE(text.ends_with("0.123456789,1\n"));
}

TEST(Signals, RowOfWrongLengthIsAnInternalError) {
  const toy::Folder folder;
  Signals signals(folder / "s.csv", {"time", "a"});
  EXPECT_THROW(signals.append({1}), Error);
}

TEST(Signals, MissingFolderIsAResourceErrorWithThePath) {
  try {
    const Signals signals("/nonexistent_tandem/s.csv", {"time"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
    EXPECT_EQ(error.where(), "/nonexistent_tandem/s.csv");
    EXPECT_NE(error.problem().find("No such file"), std::string::npos) << error.what();
  }
}

TEST(Signals, FullDiskIsAResourceErrorWithThePath) {
  // /dev/full can be opened but refuses each byte, already those of the header.
  try {
    Signals signals("/dev/full", {"time"});
    signals.append({1});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
    EXPECT_EQ(error.where(), "/dev/full");
    EXPECT_NE(error.problem().find("No space left"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tandem::launch

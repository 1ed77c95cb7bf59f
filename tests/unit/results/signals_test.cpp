#include "launch/results/signals.hpp"

#include "common/error.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

TEST(Signals, KeepsColumnsAndStreamsRows) {
  const toy::Folder folder;
  Signals signals(folder / "s.csv", {"time", "a"});
  signals.append({0.1, 1.0 / 3.0});
  // Each row is on disk at once: a run that dies leaves what it had.
  EXPECT_EQ(toy::text_of(folder / "s.csv"), "time,a\n0.1,0.3333333333333333\n");
  signals.append({0.2, -1e-300});
  EXPECT_EQ(signals.column("a"), (std::vector<double>{1.0 / 3.0, -1e-300}));
  EXPECT_TRUE(signals.has("time"));
  EXPECT_FALSE(signals.has("b"));
}

TEST(Signals, UnknownColumnNamesTheNearest) {
  const toy::Folder folder;
  const Signals signals(folder / "s.csv", {"time", "box.position.z"});
  try {
    signals.column("box.postion.z");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_NE(error.hint().find("box.position.z"), std::string::npos) << error.what();
  }
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
  // /dev/full takes the file but refuses each byte, already the header's.
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

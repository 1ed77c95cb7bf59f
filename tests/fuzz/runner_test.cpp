// Every kind of finding must be detected, and the saved input must reproduce it.
#include "tests/fuzz/runner.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>

#include "common/error.hpp"

namespace tandem::fuzz {
namespace {

namespace fs = std::filesystem;

// A target that refuses inputs with an x, and has a finding on inputs with an exclamation mark.
template <void (*happen)()>
class ExclamationMark : public Target {
 public:
  void run(std::span<const std::byte> input) override {
    if (text_of(input).find('!') != std::string_view::npos) happen();
    if (text_of(input).find('x') != std::string_view::npos) throw Error(ErrorCode::scene, "has an x");
  }
};

template <void (*happen)()>
TargetKind kind_that() {
  return {.name = "faulty",
          .text = true,
          .corpus = [](const fs::path&) -> std::vector<Bytes> {
            return {
                bytes_of("calm water"),
                bytes_of("x"),
            };
          },
          .make = [](const fs::path&) -> std::unique_ptr<Target> {
            return std::make_unique<ExclamationMark<happen>>();
          }};
}

class Runner : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    fs::current_path(folder_);
  }
  void TearDown() override {
    fs::current_path("/");
    fs::remove_all(folder_);
  }
  std::vector<fs::path> saved() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) files.push_back(entry.path());
    return files;
  }
  // Expects a finding whose input has the mark.
  template <void (*happen)()>
  void expect_finding() const {
    TargetKind kind = kind_that<happen>();
    kind.corpus = [](const fs::path&) -> std::vector<Bytes> { return {bytes_of("calm water")}; };
    EXPECT_EQ(run_plan(kind, {.count = 20000, .seed = 3, .jobs = 2, .patience = .25}), 1);
    ASSERT_EQ(saved().size(), 1u);
    EXPECT_EQ(fs::file_size(saved()[0]) > 0, true);
  }
  const fs::path folder_ = fs::temp_directory_path() / ("tandem_fuzz_test_" + std::to_string(getpid()));
};

void nothing() {}
void crash() {
  std::raise(SIGSEGV);
}
void leave() {
  std::_Exit(0);
}
void hang() {
  pause();
}
void throw_another() {
  throw std::out_of_range("vector");
}
void throw_bug() {
  throw Error(ErrorCode::internal, "no such case");
}

TEST_F(Runner, FindsACrash) {
  expect_finding<crash>();
}
TEST_F(Runner, FindsAnEndOfTheProgram) {
  expect_finding<leave>();
}
TEST_F(Runner, FindsAnEndlessWait) {
  expect_finding<hang>();
}
TEST_F(Runner, FindsAnotherException) {
  expect_finding<throw_another>();
}
TEST_F(Runner, FindsAnErrorOfOurs) {
  expect_finding<throw_bug>();
}

#ifndef TANDEM_SANITIZED
void take_memory() {
  Bytes much(std::size_t{100} << 20, std::byte{1});
  asm volatile("" : : "r"(much.data()) : "memory");
}
TEST_F(Runner, FindsMuchMemoryForOneInput) {
  expect_finding<take_memory>();
}

// A target that leaks 4 MiB with each input.
class Leaky : public Target {
 public:
  void run(std::span<const std::byte> input) override {
    lost_.emplace_back(std::size_t{4} << 20, std::byte{1});
    if (input.size() % 2 == 0) throw Error(ErrorCode::scene, "is even");
  }

 private:
  std::vector<Bytes> lost_;
};

TEST_F(Runner, FindsMemoryThatGrows) {
  TargetKind kind = kind_that<nothing>();
  kind.corpus = [](const fs::path&) -> std::vector<Bytes> { return {bytes_of("odd")}; };
  kind.make = [](const fs::path&) -> std::unique_ptr<Target> { return std::make_unique<Leaky>(); };
  EXPECT_EQ(run_plan(kind, {.count = 300}), 1);
  kind.leaks = true;
  EXPECT_EQ(run_plan(kind, {.count = 300}), 0);
}
#endif

TEST_F(Runner, FindsAnEntryThatIsRefused) {
  EXPECT_EQ(run_plan(kind_that<nothing>(), {.count = 2}), 1);
}

TEST_F(Runner, FindsThatNothingIsRefused) {
  TargetKind kind = kind_that<nothing>();
  kind.corpus = [](const fs::path&) -> std::vector<Bytes> { return {bytes_of("")}; };
  kind.make = [](const fs::path&) -> std::unique_ptr<Target> {
    class Careless : public Target {
      void run(std::span<const std::byte>) override {}
    };
    return std::make_unique<Careless>();
  };
  EXPECT_EQ(run_plan(kind, {.count = 100}), 1);
  // Where the target must refuse an input, the first one is already a finding.
  kind.finish = [](Random&, Bytes&) { return Fate::refused; };
  EXPECT_EQ(run_plan(kind, {.count = 100}), 1);
  EXPECT_EQ(saved().size(), 1u);
}

TEST_F(Runner, SavedInputsDoTheSameAgain) {
  expect_finding<throw_another>();
  EXPECT_EQ(run_file(kind_that<throw_another>(), saved()[0]), 1);
  EXPECT_EQ(run_file(kind_that<nothing>(), saved()[0]), 0);
}

TEST_F(Runner, HasNoFindingWhereAllIsWell) {
  TargetKind kind = kind_that<nothing>();
  kind.corpus = [](const fs::path&) -> std::vector<Bytes> { return {bytes_of("calm water")}; };
  EXPECT_EQ(run_plan(kind, {.count = 20000, .jobs = 3}), 0);
  EXPECT_TRUE(saved().empty());
}

TEST(Mutator, MakesTheSameInputOfTheSameNumbers) {
  const std::vector<Bytes> corpus{bytes_of("one 1 1.5"), bytes_of("two 2 -2e3")};
  const Mutator mutator(corpus, true);
  std::size_t damaged = 0;
  for (std::uint64_t number = 0; number < 1000; ++number) {
    Bytes first, second = bytes_of("what was there before");
    Random a(7, number), b(7, number);
    mutator.make(a, first);
    mutator.make(b, second);
    ASSERT_EQ(first, second);
    damaged += std::ranges::find(corpus, first) == corpus.end() ? 1 : 0;
  }
  EXPECT_GT(damaged, 900u);
}

}  // namespace
}  // namespace tandem::fuzz

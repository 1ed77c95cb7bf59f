// Sets up logging before any thread starts, without output: these tests cause errors on purpose.
#include <gtest/gtest.h>

#include "common/log.hpp"

namespace {

class QuietLog : public testing::Environment {
  void SetUp() override { tandem::log::setup("test", "off"); }
};

[[maybe_unused]] const testing::Environment* const quiet = testing::AddGlobalTestEnvironment(new QuietLog);

}  // namespace

// Sets up logging before any thread starts, and silent: the errors that these tests provoke are not for the
// reader.
#include <gtest/gtest.h>

#include "common/log.hpp"

namespace {

class QuietLog : public testing::Environment {
  void SetUp() override { tandem::log::setup("test", "off"); }
};

[[maybe_unused]] const testing::Environment* const quiet = testing::AddGlobalTestEnvironment(new QuietLog);

}  // namespace

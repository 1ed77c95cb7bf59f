// What a participant on a stream writes before it speaks the protocol.
#include "protocol/stream/stream_channel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.hpp"
#include "protocol/frame.hpp"

namespace tandem::protocol::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// What the coordinator's end says after these bytes of a participant that stays.
std::string error_after(const std::string& bytes) {
  Endpoint endpoint = create_stream("dem_server 'lmp' (pid 7)");
  if (write(endpoint.inherited.front().get(), bytes.data(), bytes.size()) !=
      static_cast<ssize_t>(bytes.size()))
    return "the test cannot write";
  std::vector<std::byte> frame;
  try {
    endpoint.channel->receive(frame, Clock::now() + std::chrono::seconds(5));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol) << error.what();
    return error.what();
  }
  return "a frame of " + std::to_string(frame.size()) + " bytes";
}

std::string as_bytes(std::uint64_t size) {
  return {reinterpret_cast<const char*>(&size), sizeof size};
}

TEST(Stream, QuotesTextThatIsNoFrame) {
  const std::string frame = as_bytes(64) + "TNDM" + std::string(60, '\0');
  EXPECT_EQ(error_after(frame), "a frame of 64 bytes");
  for (const std::string text : {"loading the deck\n", "hi\n", "a", "hello wo"})
    EXPECT_THAT(
        error_after(text + frame),
        AllOf(
            HasSubstr("dem_server 'lmp' (pid 7) wrote text to the channel, which is its standard output: \"" +
                      text.substr(0, 2).substr(0, text.find('\n'))),
            HasSubstr("print to standard error")));
}

TEST(Stream, RefusesSizesThatNoFrameHas) {
  EXPECT_THAT(error_after(as_bytes(~std::uint64_t{0})),
              HasSubstr("announced a frame of 18446744073709551615 bytes"));
  EXPECT_THAT(error_after(as_bytes(5) + "TNDM"), HasSubstr("5 bytes that is none"));
  EXPECT_THAT(error_after(as_bytes(0) + as_bytes(0)), HasSubstr("0 bytes that is none"));
}

}  // namespace
}  // namespace tandem::protocol::test

// DDS Security: who has no certificate of the run's authority hears nothing, joins nothing, and finds nothing
// in the packets.
#include <gmock/gmock.h>

#include <filesystem>
#include <string_view>
#include <thread>

#include "ends.hpp"
#include "intruder_end.hpp"
#include "launch/keys/keys.hpp"
#include "wiretap.hpp"

namespace tandem::protocol::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

class DdsCertificates : public testing::Test {
 protected:
  DdsCertificates() {
    launch::write_certificates(ours_, 1);
    launch::write_certificates(theirs_, 1);
  }
  ~DdsCertificates() override {
    fs::remove_all(ours_);
    fs::remove_all(theirs_);
  }
  DdsOptions protected_options() const {
    DdsOptions run = options();
    run.secret.clear();
    run.certificates = ours_;
    return run;
  }
  static fs::path folder(const char* whose) {
    return fs::temp_directory_path() / ("tandem_certificates_" + std::to_string(getpid()) + whose);
  }
  const fs::path ours_ = folder("ours"), theirs_ = folder("theirs");
};

TEST_F(DdsCertificates, APairWithCertificatesWorksWithAndWithoutASecret) {
  for (const bool secret : {false, true}) {
    DdsOptions run = protected_options();
    if (secret) run.secret = options().secret;
    const auto [coordinator, participant] = open_pair(run);
    expect_works(*coordinator, *participant);
    const std::vector<std::byte> large(std::size_t{20} << 20, std::byte{3});
    std::jthread reader([&, end = participant.get()] { EXPECT_TRUE(receive(*end, 50s) == large); });
    const std::array<std::span<const std::byte>, 1> parts{large};
    coordinator->send(parts, in(50s));
  }
}

TEST_F(DdsCertificates, WhoHasNoneHearsNothingAndJoinsNothing) {
  const auto [coordinator, participant] = open_pair(protected_options());
  DdsOptions without = options();
  const IntruderEnd spy(without);
  for (int i = 0; i < 50; ++i, std::this_thread::sleep_for(10ms)) expect_works(*coordinator, *participant);
  EXPECT_TRUE(spy.heard().empty());
  const Error e = error_of([&] { open_dds_participant(without, in(1s)); });
  EXPECT_EQ(e.code(), ErrorCode::timeout);
  expect_works(*coordinator, *participant);
}

TEST_F(DdsCertificates, ThoseOfAnotherAuthorityDoNotFit) {
  DdsOptions others = protected_options();
  others.certificates = theirs_;
  auto participant =
      std::async(std::launch::async, [&] { return error_of([&] { open_dds_participant(others, in(3s)); }); });
  const Error coordinator = error_of([&] { open_dds_coordinator(protected_options(), in(2s)); });
  EXPECT_EQ(coordinator.code(), ErrorCode::timeout);
  EXPECT_THAT(coordinator.what(), AnyOf(HasSubstr("certificates are on"), HasSubstr("refused an end")));
  const Error other = participant.get();
  EXPECT_EQ(other.code(), ErrorCode::timeout);
  EXPECT_THAT(other.what(), HasSubstr("DDS Security refused an end: Certificate not valid"));
  EXPECT_THAT(other.what(), HasSubstr("give all programs of the run copies of one folder"));
}

// Before anybody has come at all, this end cannot know whether somebody was refused.
TEST_F(DdsCertificates, AnEndThatWaitsInVainSaysThatOthersMayBeRefused) {
  const Error e = error_of([&] { open_dds_coordinator(protected_options(), in(200ms)); });
  EXPECT_THAT(e.what(), AnyOf(HasSubstr("certificates are on, and an end without them"),
                              HasSubstr("DDS Security refused an end")));
}

TEST_F(DdsCertificates, AFolderThatIsNotCompleteOrOpenToOthersIsRefused) {
  fs::permissions(ours_ / "identity_key.pem", fs::perms::others_read, fs::perm_options::add);
  EXPECT_THAT(error_of([&] { open_dds_coordinator(protected_options(), in(1s)); }).what(),
              HasSubstr("other users may read or write this key"));
  fs::remove(ours_ / "governance.p7s");
  fs::permissions(ours_ / "identity_key.pem", fs::perms::others_read, fs::perm_options::remove);
  EXPECT_THAT(error_of([&] { open_dds_coordinator(protected_options(), in(1s)); }).what(),
              HasSubstr("governance.p7s: does not exist"));
  EXPECT_THAT(error_of([&] { launch::write_certificates(theirs_, 1); }).what(),
              HasSubstr("holds something already"));
}

TEST_F(DdsCertificates, ThePacketsHoldNoPlainText) {
  constexpr std::string_view plain = "what only the ends of this run are to read";
  for (const bool with : {false, true}) {
    const Wiretap tap;
    if (!tap.usable()) GTEST_SKIP() << "only root may look at packets";
    const auto [coordinator, participant] = open_pair(with ? protected_options() : options());
    const auto bytes = std::as_bytes(std::span(plain));
    bool found = false;
    for (int i = 0; i < 20; ++i) {
      // Other programs use the loopback too, and what does not fit into the tap is lost to it.
      tap.finds("what empties it");
      send(*coordinator, {bytes.begin(), bytes.end()});
      EXPECT_EQ(receive(*participant).size(), plain.size());
      found = tap.finds(plain) || found;
    }
    EXPECT_EQ(found, !with) << (with ? "with" : "without") << " certificates";
  }
}

}  // namespace
}  // namespace tandem::protocol::test

#include "protocol/registration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/violation.hpp"

namespace tandem::protocol::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A coordinator of 1.4 that also supports 1.3.
constexpr Dialect spoken[] = {{{1, 4}, 0x44}, {{1, 3}, 0x33}};

Hello hello(std::uint64_t layout) {
  return {Role::mbd, layout, can_predict, 1, "mbd 1", "host"};
}

Version admitted(const Hello& h, Version v, std::uint64_t needed = 0) {
  return admit(h, v, Role::mbd, needed, "mbd_server (pid 7)", spoken);
}

void expect_refused(Violation violation, const testing::Matcher<std::string>& text, auto&& f) {
  try {
    f();
    ADD_FAILURE() << "admitted";
  } catch (const ProtocolError& e) {
    EXPECT_EQ(e.violation(), violation);
    EXPECT_EQ(e.code(), ErrorCode::protocol);
    EXPECT_THAT(std::string(e.what()), AllOf(HasSubstr("mbd_server (pid 7)"), text));
    EXPECT_FALSE(e.hint().empty()) << "no remedy";
  }
}

TEST(Registration, TheSameMinorAndTheOneBeforeAreServed) {
  EXPECT_EQ(admitted(hello(0x44), {1, 4}), (Version{1, 4}));
  EXPECT_EQ(admitted(hello(0x33), {1, 3}), (Version{1, 3}));
}

// A participant that was built with the last release.
TEST(Registration, OneOf1_4IsServed) {
  EXPECT_EQ(admit(hello(0x82142f4fa4d5c467), {1, 4}, Role::mbd, can_predict, "mbd_server (pid 7)"),
            (Version{1, 4}));
}

TEST(Registration, OtherVersionsAreRefusedWithBothValues) {
  expect_refused(Violation::wrong_version,
                 AllOf(HasSubstr("version is 1.2"), HasSubstr("speaks 1.4 and 1.3"),
                       HasSubstr("update the participant")),
                 [] {
                   admitted(hello(0x33), {1, 2});
                 });
  expect_refused(Violation::wrong_version, AllOf(HasSubstr("version is 1.5"), HasSubstr("use a coordinator")),
                 [] {
                   admitted(hello(0x44), {1, 5});
                 });
  expect_refused(Violation::wrong_version, HasSubstr("version is 2.4"), [] {
    admitted(hello(0x44), {2, 4});
  });
}

TEST(Registration, TheLayoutIsThatOfTheSpokenVersion) {
  expect_refused(
      Violation::wrong_layout,
      AllOf(HasSubstr("of protocol 1.3"), HasSubstr("0000000000000044"), HasSubstr("0000000000000033")), [] {
        admitted(hello(0x44), {1, 3});
      });
}

TEST(Registration, RoleAndCapabilitiesAreThoseOfTheRun) {
  expect_refused(Violation::wrong_role, AllOf(HasSubstr("role is dem_server"), HasSubstr("needs mbd_server")),
                 [] {
                   Hello h = hello(0x44);
                   h.role = Role::dem;
                   admitted(h, {1, 4});
                 });
  EXPECT_NO_THROW(admitted(hello(0x44), {1, 4}, can_predict));
  expect_refused(Violation::missing_capability, HasSubstr("missing can_rollback"), [] {
    admitted(hello(0x44), {1, 4}, can_predict | can_rollback);
  });
}

TEST(Registration, ThisReleaseServesItself) {
  Hello h = hello(layout_hash);
  EXPECT_EQ(admit(h, protocol_version, Role::mbd, 0, "peer"), protocol_version);
  EXPECT_EQ(std::size(dialects), 3u) << "the two before are served";
}

}  // namespace
}  // namespace tandem::protocol::test

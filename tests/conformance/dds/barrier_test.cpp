// How two ends find each other, and what is said when they do not.
#include <dds/dds.h>
#include <gmock/gmock.h>

#include <cstdlib>

#include "ends.hpp"
#include "protocol/dds/network.hpp"
#include "stranger_type.hpp"
#include "wire.h"

namespace tandem::protocol::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(DdsBarrier, EachEndNamesTheOther) {
  const auto [coordinator, participant] = open_pair(options());
  const std::string pid = "(pid " + std::to_string(getpid()) + " on ";
  EXPECT_THAT(coordinator->peer(), StartsWith("dem_server " + pid));
  EXPECT_THAT(participant->peer(), StartsWith("coordinator " + pid));
  expect_works(*coordinator, *participant);
}

TEST(DdsBarrier, TheOrderOfStartDoesNotMatter) {
  for (const bool coordinator_first : {true, false}) {
    const DdsOptions run = options(coordinator_first ? "-c" : "-p");
    auto first = std::async(std::launch::async, [&] {
      return coordinator_first ? open_dds_coordinator(run, in(10s)) : open_dds_participant(run, in(10s));
    });
    std::this_thread::sleep_for(300ms);
    const auto second =
        coordinator_first ? open_dds_participant(run, in(10s)) : open_dds_coordinator(run, in(10s));
    expect_works(*first.get(), *second);
  }
}

TEST(DdsBarrier, RolesAndRunsDoNotMix) {
  DdsOptions mbd = options(), dem = options(), other = options("-other");
  mbd.role = Role::mbd;
  const auto a = open_pair(mbd), b = open_pair(dem), c = open_pair(other);
  EXPECT_THAT(a.first->peer(), StartsWith("mbd_server"));
  send(*a.first, std::vector<std::byte>(1));
  send(*b.first, std::vector<std::byte>(2));
  send(*c.first, std::vector<std::byte>(3));
  EXPECT_EQ(receive(*c.second).size(), 3u);
  EXPECT_EQ(receive(*b.second).size(), 2u);
  EXPECT_EQ(receive(*a.second).size(), 1u);
}

TEST(DdsBarrier, TheEnvironmentChangesNothing) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"nowhere0\"/>"
         "</Interfaces></General></Domain></CycloneDDS>",
         1);
  const auto [coordinator, participant] = open_pair(options());
  unsetenv("CYCLONEDDS_URI");
  expect_works(*coordinator, *participant);
}

TEST(DdsBarrier, AMissingSideIsNamedWithThePlaceWhereItWasLookedFor) {
  const auto begin = Clock::now();
  const Error server = error_of([] { open_dds_coordinator(options(), in(300ms)); });
  EXPECT_LT(Clock::now() - begin, 5s);
  EXPECT_EQ(server.code(), ErrorCode::timeout);
  EXPECT_EQ(server.problem(), "no dem_server joined run '" + options().run + "' within 0.3 s");
  EXPECT_EQ(server.where(), "dds on interface lo (127.0.0.1)");
  EXPECT_THAT(server.hint(), HasSubstr("looked at 127.0.0.1;"));
  EXPECT_THAT(server.hint(), HasSubstr("UDP ports 17910 to 17957"));

  const Error coordinator = error_of([] { open_dds_participant(options(), in(100ms)); });
  EXPECT_THAT(coordinator.problem(), StartsWith("no coordinator joined run"));
}

TEST(DdsBarrier, ARoleIsTakenOnce) {
  const auto pair = open_pair(options());
  const Error server = error_of([] { open_dds_participant(options(), in(10s)); });
  EXPECT_EQ(server.code(), ErrorCode::protocol);
  EXPECT_THAT(server.problem(), StartsWith("coordinator (pid "));
  EXPECT_THAT(server.problem(), HasSubstr("already belongs to dem_server (pid "));
  const Error coordinator = error_of([] { open_dds_coordinator(options(), in(10s)); });
  EXPECT_EQ(coordinator.code(), ErrorCode::protocol);
  EXPECT_THAT(coordinator.problem(), HasSubstr("already belongs to coordinator (pid "));
  // The pair has not noticed.
  expect_works(*pair.first, *pair.second);
}

TEST(DdsBarrier, TheWaitCanBeEnded) {
  DdsOptions run = options();
  run.idle = [] { throw Error(ErrorCode::interrupted, "stopped by Ctrl-C"); };
  EXPECT_EQ(error_of([&] { open_dds_coordinator(run, in(10s)); }).code(), ErrorCode::interrupted);
}

TEST(DdsBarrier, WrongOptionsAreRefused) {
  DdsOptions run = options();
  run.interface = "nowhere0";
  const Error interface = error_of([&] { open_dds_coordinator(run, in(1s)); });
  EXPECT_EQ(interface.code(), ErrorCode::usage);
  EXPECT_EQ(interface.problem(), "interface 'nowhere0' is unknown");
  EXPECT_THAT(interface.hint(), HasSubstr("lo"));

  run = options();
  run.peers = {"no such host"};
  EXPECT_THAT(error_of([&] { open_dds_coordinator(run, in(1s)); }).problem(),
              StartsWith("peer 'no such host' has no IPv4 address"));

  run = options();
  for (const std::string name : {"", "a<b", "a b"}) {
    run.run = name;
    EXPECT_EQ(error_of([&] { open_dds_coordinator(run, in(1s)); }).problem(),
              "'" + name + "' is no name for a run");
  }
  run = options();
  run.lease = 10ms;
  EXPECT_EQ(error_of([&] { open_dds_coordinator(run, in(1s)); }).problem(), "a lease of 10 ms");
}

// An end of the same run that speaks otherwise: made here of bare Cyclone calls.
class Stranger {
 public:
  Stranger(const DdsOptions& run, const dds_topic_descriptor_t& type, dds_reliability_kind_t reliability) {
    const std::string configuration = dds::domain_configuration(dds::find_network(run), run);
    domain_ = dds_create_domain(200'000, configuration.c_str());
    const dds_entity_t participant = dds_create_participant(200'000, nullptr, nullptr);
    const dds_entity_t topic =
        dds_create_topic(participant, &type, "tandem_dem_server_answers", nullptr, nullptr);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, reliability, DDS_MSECS(10));
    EXPECT_GT(dds_create_writer(participant, topic, qos, nullptr), 0);
    dds_delete_qos(qos);
  }
  ~Stranger() { dds_delete(domain_); }

 private:
  dds_entity_t domain_ = 0;
};

DdsOptions insecure_options() {
  DdsOptions run = options();
  run.secret.clear();
  run.insecure = true;
  return run;
}

TEST(DdsBarrier, WithASecretStrangersOfOtherTypesAreNamedAndDoNotEndTheWait) {
  const Stranger stranger(options(), stranger_type(), DDS_RELIABILITY_RELIABLE);
  EXPECT_THAT(error_of([] { open_dds_coordinator(options(), in(1s)); }).problem(),
              HasSubstr("other DDS types"));
  const auto [coordinator, participant] = open_pair(options());
  expect_works(*coordinator, *participant);
}

TEST(DdsBarrier, OtherTypesAreRefused) {
  ASSERT_STREQ(stranger_type().m_typename, tandem_dds_Chunk_desc.m_typename);
  ASSERT_NE(&stranger_type(), &tandem_dds_Chunk_desc);
  const Stranger stranger(options(), stranger_type(), DDS_RELIABILITY_RELIABLE);
  const Error e = error_of([] { open_dds_coordinator(insecure_options(), in(10s)); });
  EXPECT_EQ(e.code(), ErrorCode::protocol) << e.what();
  EXPECT_THAT(e.problem(), HasSubstr("uses other DDS types"));
}

TEST(DdsBarrier, AnotherQualityOfServiceIsRefused) {
  const Stranger stranger(options(), tandem_dds_Chunk_desc, DDS_RELIABILITY_BEST_EFFORT);
  const Error e = error_of([] { open_dds_coordinator(insecure_options(), in(10s)); });
  EXPECT_EQ(e.code(), ErrorCode::protocol) << e.what();
  EXPECT_THAT(e.problem(), HasSubstr("another quality of service (DDS policy 11)"));
}

}  // namespace
}  // namespace tandem::protocol::test

// Round trip of a frame between two ends: two threads (inproc) or two processes (shm; dds over the loopback).
// The median of repetitions is what docs/protocol.md quotes:
// bench_channel --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <optional>
#include <thread>

#include "common/error.hpp"
#include "forked_child.hpp"
#include "launch/keys/keys.hpp"
#include "protocol/dds/dds_channel.hpp"
#include "protocol/frame.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/shm/shm_channel.hpp"

namespace tandem::protocol {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

void send(Channel& channel, const Bytes& frame) {
  const std::array<std::span<const std::byte>, 1> parts{frame};
  channel.send(parts, Clock::now() + 10s);
}

// Sends back what comes, until the other end closes.
void echo(Channel& channel) {
  Bytes frame;
  try {
    while (true) {
      channel.receive(frame, Clock::now() + 60s);
      send(channel, frame);
    }
  } catch (const Error&) {
  }
}

void round_trips(benchmark::State& state, Channel& channel) {
  const Bytes frame(static_cast<std::size_t>(state.range(0)));
  Bytes back;
  for (auto _ : state) {
    send(channel, frame);
    channel.receive(back, Clock::now() + 10s);
  }
  state.SetBytesProcessed(2 * state.range(0) * state.iterations());
}

void inproc(benchmark::State& state, WaitPolicy wait) {
  auto [ours, theirs] = create_inproc("echo", wait);
  std::jthread other([end = std::move(theirs)] { echo(*end); });
  round_trips(state, *ours);
  ours.reset();
}

void shm(benchmark::State& state, WaitPolicy wait) {
  Endpoint endpoint = create_shm("echo", {.wait = wait});
  const test::ForkedChild child([&] {
    endpoint.channel.reset();
    echo(*attach_shm(endpoint.server_arguments.at(1), Clock::now() + 5s, wait));
  });
  endpoint.inherited.clear();
  round_trips(state, *endpoint.channel);
}

// A folder of certificates for this process.
class Certificates {
 public:
  Certificates() { launch::write_certificates(path, 1); }
  ~Certificates() { std::filesystem::remove_all(path); }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tandem_bench_" + std::to_string(getpid()));
};

enum class Protection { none, secret, certificates, both };

[[maybe_unused]] void dds(benchmark::State& state, Protection protection) {
  DdsOptions options;
  options.run = "bench-" + std::to_string(getpid());
  options.role = Role::dem;
  options.insecure = protection == Protection::none;
  if (protection == Protection::secret || protection == Protection::both)
    options.secret = "the secret of a benchmark, long enough";
  std::optional<Certificates> certificates;
  if (protection == Protection::certificates || protection == Protection::both)
    options.certificates = certificates.emplace().path;
  const test::ForkedChild child([&] { echo(*open_dds_participant(options, Clock::now() + 10s)); });
  round_trips(state, *open_dds_coordinator(options, Clock::now() + 10s));
}

// What a frame costs besides: header and checksum, made and checked.
void checksum_of(benchmark::State& state) {
  const Bytes frame(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(checksum(frame));
  state.SetBytesProcessed(state.range(0) * state.iterations());
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(512)->Arg(64 * 1024)->UseRealTime();
}

BENCHMARK_CAPTURE(shm, spin, WaitPolicy::spin)->Apply(sizes);
BENCHMARK_CAPTURE(shm, adaptive, WaitPolicy::adaptive)->Apply(sizes);
BENCHMARK_CAPTURE(shm, block, WaitPolicy::block)->Apply(sizes);
BENCHMARK_CAPTURE(inproc, spin, WaitPolicy::spin)->Apply(sizes);
BENCHMARK_CAPTURE(inproc, adaptive, WaitPolicy::adaptive)->Apply(sizes);
BENCHMARK_CAPTURE(inproc, block, WaitPolicy::block)->Apply(sizes);
#if TANDEM_WITH_DDS
BENCHMARK_CAPTURE(dds, insecure, Protection::none)->Apply(sizes);
BENCHMARK_CAPTURE(dds, secret, Protection::secret)->Apply(sizes);
BENCHMARK_CAPTURE(dds, certificates, Protection::certificates)->Apply(sizes);
BENCHMARK_CAPTURE(dds, secret_and_certificates, Protection::both)->Apply(sizes);
#endif
BENCHMARK(checksum_of)->Apply(sizes);

}  // namespace
}  // namespace tandem::protocol

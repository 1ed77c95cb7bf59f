#include "mbd_server/state/state.hpp"

#include <cstdio>

namespace tandem::mbd {
namespace {

void add(std::uint64_t& sum, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) sum = (sum ^ bytes[i]) * 0x100000001b3u;
}

template <class Matrix>
void add(std::uint64_t& sum, const Matrix& values) {
  add(sum, values.data(), sizeof(double) * static_cast<std::size_t>(values.size()));
}

}  // namespace

std::string hash(const State& state) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  add(sum, &state.time, sizeof state.time);
  add(sum, &state.step, sizeof state.step);
  add(sum, &state.steps, sizeof state.steps);
  add(sum, state.q);
  add(sum, state.u);
  add(sum, state.udot);
  add(sum, state.a);
  add(sum, state.lambda);
  add(sum, state.inputs);
  add(sum, &state.next_step, sizeof state.next_step);
  add(sum, &state.last_error, sizeof state.last_error);
  add(sum, state.loads);
  add(sum, state.load_rates);
  add(sum, &state.load_time, sizeof state.load_time);
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum));
  return text;
}

}  // namespace tandem::mbd

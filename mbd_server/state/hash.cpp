#include "mbd_server/state/state.hpp"

#include <cstdio>
#include <type_traits>

#include "mbd_server/state/fields.hpp"

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

void add(std::uint64_t& sum, const ContactPoint& point) {
  for_each_point_field(point, [&]<class Field>(const char*, const Field& field) {
    if constexpr (std::is_same_v<Field, Vector3d>)
      add(sum, field.data(), 3 * sizeof(double));
    else
      add(sum, &field, sizeof field);
  });
}

}  // namespace

std::string hash(const State& state) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for_each_field(state, [&]<class Field>(const char*, const Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      add(sum, &field, sizeof field);
    else if constexpr (std::is_same_v<Field, std::vector<ContactPoint>>)
      for (const ContactPoint& point : field) add(sum, point);
    else
      add(sum, field);
  });
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum));
  return text;
}

}  // namespace tandem::mbd

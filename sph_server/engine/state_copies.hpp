// Copies of the whole state of an engine, in memory and as named arrays.
#pragma once

#include <cstring>

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

// The bytes of an array, or of a single value.
template <class T>
auto bytes_of(std::span<T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(values);
}
template <class Array>
auto bytes_of_all(Array& array) {
  if constexpr (requires { std::span(array); })
    return bytes_of(std::span<const std::remove_reference_t<decltype(array[0])>>(array));
  else
    return bytes_of(std::span<const Array>(&array, 1));
}
template <class Array>
void assign_bytes(const std::vector<std::byte>& bytes, Array& array) {
  const std::span<const std::byte> to = bytes_of_all(array);
  if (!bytes.empty()) std::memcpy(const_cast<std::byte*>(to.data()), bytes.data(), bytes.size());
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::save() {
  saved_.values.clear();
  each_value(*this, [&](const char*, const auto& value) {
    const auto bytes = bytes_of_all(value);
    saved_.values.emplace_back(bytes.begin(), bytes.end());
  });
  saved_.count = count_;
  Memory::each([this](const char*, const auto& now, auto& saved) { exec_.copy(now, saved); }, memory_,
               saved_.memory);
  exec_.copy(built_at_, saved_.built_at);
  exec_.copy(skin_, saved_.skin);
}

// The lists are built anew, from the positions that they had.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::restore() {
  allocate(saved_.count);
  std::size_t next = 0;
  each_value(*this, [&](const char*, auto& value) { assign_bytes(saved_.values.at(next++), value); });
  Memory::each([this](const char*, auto& now, const auto& saved) { exec_.copy(saved, now); }, memory_,
               saved_.memory);
  exec_.copy(saved_.built_at, built_at_);
  exec_.copy(saved_.skin, skin_);
  use_saved_lists();
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::use_saved_lists() {
  place_walls(built_poses_);
  sort_into_cells(built_at_);
  build_lists();
  place_walls(poses_);
  built_ = true;
}

// Arrays without an element, as those of bodies without walls, are in no file.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::write(const Sink& sink) const {
  const auto give = [&](const char* name, const auto& array) {
    if (const auto bytes = bytes_of_all(array); !bytes.empty()) sink(name, bytes);
  };
  const Host host = download();
  Host::each(give, host);
  std::vector<Vec3d> built_at(count_);
  if (count_ > 0) exec_.download(built_at_, std::span(built_at));
  give("built_at", built_at);
  std::vector<float> skin(count_);
  if (count_ > 0) exec_.download(skin_, std::span(skin));
  give("skin", skin);
  each_value(*this, give);
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::read(const Source& source, std::size_t particles) {
  const auto take = [&](const char* name, auto& array) {
    const std::size_t size = bytes_of_all(array).size();
    if (size == 0) return;
    const std::vector<std::byte> bytes = source(name);
    if (bytes.size() != size)
      throw Error(ErrorCode::resource,
                  "its array '" + std::string(name) + "' has " + std::to_string(bytes.size()) + " bytes", {},
                  "continue from another checkpoint");
    assign_bytes(bytes, array);
  };
  Host host;
  each(host, [&](auto& array) { array.resize(particles); });
  Host::each(take, host);
  std::vector<Vec3d> built_at(particles);
  take("built_at", built_at);
  std::vector<float> skin(particles);
  take("skin", skin);
  each_value(*this, take);
  upload(host);
  if (particles > 0) {
    exec_.upload(built_at_, std::span<const Vec3d>(built_at));
    exec_.upload(skin_, std::span<const float>(skin));
  }
  use_saved_lists();
}

}  // namespace tandem::sph

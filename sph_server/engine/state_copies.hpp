// Copies of the whole state of an engine, in memory and as named arrays.
#pragma once

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

template <class Real, bool shifting>
void LiquidEngineOf<Real, shifting>::save() {
  saved_.clear();
  each_array(*this, [&](const char*, const auto& array) {
    const auto bytes = bytes_of(array);
    saved_.emplace_back(bytes.begin(), bytes.end());
  });
  saved_list_ = list_;
}

template <class Real, bool shifting>
void LiquidEngineOf<Real, shifting>::restore() {
  allocate(saved_list_.start.size() - 1);
  built_at_.resize(position_.size());
  std::size_t next = 0;
  each_array(*this, [&](const char*, auto& array) { assign(saved_.at(next++), array); });
  list_ = saved_list_;
  use_list();
  place_walls(poses_);
}

// Arrays without an element, as those of bodies without walls, are in no file.
template <class Real, bool shifting>
void LiquidEngineOf<Real, shifting>::write(const Sink& sink) const {
  each_array(*this, [&](const char* name, const auto& array) {
    if (const auto bytes = bytes_of(array); !bytes.empty()) sink(name, bytes);
  });
}

template <class Real, bool shifting>
void LiquidEngineOf<Real, shifting>::read(const Source& source, std::size_t particles) {
  allocate(particles);
  built_at_.resize(particles);
  each_array(*this, [&](const char* name, auto& array) {
    const std::size_t size = bytes_of(array).size();
    if (size == 0) return;
    const std::vector<std::byte> bytes = source(name);
    if (bytes.size() != size)
      throw Error(ErrorCode::resource,
                  "its array '" + std::string(name) + "' has " + std::to_string(bytes.size()) + " bytes", {},
                  "continue from another checkpoint");
    assign(bytes, array);
  });
  // The lists are those of the positions and poses when they were built.
  place_walls(built_poses_);
  build_list(grid_, setup_.periods, built_at_, reach_, walls_, pool_, list_);
  use_list();
  place_walls(poses_);
}

}  // namespace tandem::sph

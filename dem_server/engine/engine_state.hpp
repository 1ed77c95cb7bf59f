// The state of an engine that changes during a run: a rollback restores it and a restart file holds it.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "dem_server/engine/arrays.hpp"
#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

template <class Exec, class Real>
struct EngineState {
  typename Exec::template Buffer<WindowProgress> window;
  SphereBuffers<Exec, Real> spheres;
  ListBuffers<Exec, Real> lists;
  typename Exec::template Buffer<double> wall_sums;   // since the start (rows x wall_sum_count)
  typename Exec::template Buffer<double> dissipated;  // since the start [J]
  WindowProgress host_window;                         // copy of `window` between windows
  Totals totals;
};

// Calls f(name, buffer of each state) for every buffer; buffers that a law does not need are empty. This is
// the only list of the buffers that are copied, counted and written to files.
template <class F, class... States>
void for_each_buffer(F f, States&... state) {
  f("window_progress", state.window...);
  for (const int side : {0, 1}) {
    const std::string of_side = side == 0 ? ".0" : ".1";
    f("position_radius" + of_side, state.spheres.position[side]...);
    f("velocity_kind" + of_side, state.spheres.velocity[side]...);
    f("spin" + of_side, state.spheres.spin[side]...);
  }
  f("fine_part", state.spheres.fine...);
  f("id", state.spheres.id...);
  f("pairs.start", state.lists.pairs.start...);
  f("pairs.entry", state.lists.pairs.entry...);
  f("pairs.spring", state.lists.pairs.spring...);
  f("pairs.rolling_spring", state.lists.pairs.rolling...);
  f("pairs.image", state.lists.pairs.image...);
  f("walls.entry", state.lists.walls.entry...);
  f("walls.history", state.lists.walls.history...);
  f("walls.rolling_spring", state.lists.walls.rolling...);
  f("mirror_start", state.lists.mirror_start...);
  f("mirror", state.lists.mirror...);
  f("wall_slack", state.lists.wall_slack...);
  f("near", state.lists.near...);
  f("wall_sums", state.wall_sums...);
  f("dissipated", state.dissipated...);
}

template <class Exec, class Real>
void copy(Exec& exec, const EngineState<Exec, Real>& from, EngineState<Exec, Real>& to) {
  for_each_buffer([&](const std::string&, const auto& a, auto& b) { exec.copy(a, b); }, from, to);
  to.host_window = from.host_window;
  to.totals = from.totals;
}

template <class Exec, class Real>
void write_state(Exec& exec, const EngineState<Exec, Real>& state, const ArraySink& sink) {
  sink("host_window_progress", std::as_bytes(std::span(&state.host_window, 1)));
  sink("totals", std::as_bytes(std::span(&state.totals, 1)));
  for_each_buffer(
      [&](const std::string& name, const auto& buffer) {
        using T = std::remove_cvref_t<decltype(*buffer.data())>;
        std::vector<T> host(buffer.size());
        if (!host.empty()) exec.download(buffer, std::span<T>(host));
        sink(name, std::as_bytes(std::span<const T>(host)));
      },
      state);
}

// Error{resource} where an array cannot be one of this engine, which has `fewest` to `most` indices for
// spheres.
template <class Exec, class Real>
void read_state(Exec& exec, EngineState<Exec, Real>& state, const ArraySource& source, std::size_t fewest,
                std::size_t most) {
  const auto expect = [](const std::string& name, bool fits) {
    if (!fits)
      throw Error(ErrorCode::resource, "its array '" + name + "' has a length that this engine cannot use",
                  {}, "continue with the program that wrote it");
  };
  const auto read_value = [&](const std::string& name, auto& value) {
    const std::vector<std::byte> bytes = source(name);
    expect(name, bytes.size() == sizeof(value));
    std::memcpy(&value, bytes.data(), sizeof(value));
  };
  const bool images = state.lists.pairs.image.size() > 0, spins = state.spheres.spin[0].size() > 0,
             pair_rolling = state.lists.pairs.rolling.size() > 0,
             wall_rolling = state.lists.walls.rolling.size() > 0,
             mirrors = state.lists.mirror_start.size() > 0;
  const std::size_t wall_sums = state.wall_sums.size(), dissipated = state.dissipated.size();
  read_value("host_window_progress", state.host_window);
  read_value("totals", state.totals);
  for_each_buffer(
      [&](const std::string& name, auto& buffer) {
        using T = std::remove_cvref_t<decltype(*buffer.data())>;
        const std::vector<std::byte> bytes = source(name);
        expect(name, bytes.size() % sizeof(T) == 0);
        std::vector<T> host(bytes.size() / sizeof(T));
        if (!host.empty()) std::memcpy(host.data(), bytes.data(), bytes.size());
        buffer.resize(host.size());
        if (!host.empty()) exec.upload(buffer, std::span<const T>(host));
      },
      state);
  expect("window_progress", state.window.size() == 1);
  expect("wall_sums", state.wall_sums.size() == wall_sums);
  expect("dissipated", state.dissipated.size() == dissipated);
  const std::size_t n = state.spheres.position[0].size();
  expect("position_radius.0", n >= fewest && n <= most);
  expect("host_window_progress",
         state.host_window.indices <= n && state.host_window.used <= state.host_window.indices);
  for (const int side : {0, 1}) {
    const std::string of_side = side == 0 ? ".0" : ".1";
    expect("position_radius" + of_side, state.spheres.position[side].size() == n);
    expect("velocity_kind" + of_side, state.spheres.velocity[side].size() == n);
    expect("spin" + of_side, state.spheres.spin[side].size() == (spins ? n : 0));
  }
  expect("id", state.spheres.id.size() == (spins ? 0 : n));
  expect("fine_part", state.spheres.fine.size() == (has_fine_part<Real> ? n : 0));
  const auto& pairs = state.lists.pairs;
  const auto& walls = state.lists.walls;
  expect("pairs.start", pairs.start.size() == n + 1);
  expect("mirror_start", state.lists.mirror_start.size() == (mirrors ? n + 1 : 0));
  const std::size_t entries = std::size_t{state.host_window.listed} + Exec::read_ahead;
  expect("mirror", mirrors ? state.lists.mirror.size() >= entries : state.lists.mirror.size() == 0);
  expect("pairs.entry", pairs.entry.size() >= entries);
  expect("pairs.spring", spins ? pairs.spring.size() >= state.host_window.listed : pairs.spring.size() == 0);
  expect("pairs.rolling_spring", pairs.rolling.size() == (pair_rolling ? pairs.entry.size() : 0));
  expect("walls.history", walls.history.size() == (spins ? walls.entry.size() : 0));
  expect("walls.rolling_spring", walls.rolling.size() == (wall_rolling ? walls.entry.size() : 0));
  expect("wall_slack", state.lists.wall_slack.size() == walls.entry.size());
  expect("pairs.image", pairs.image.size() == (images ? pairs.entry.size() : 0));
}

}  // namespace tandem::dem

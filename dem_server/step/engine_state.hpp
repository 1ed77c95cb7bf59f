// All of an engine that changes during a run: what a rollback restores and a restart file holds.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "dem_server/model/view.hpp"
#include "dem_server/step/engine.hpp"

namespace tandem::dem {

// Arrays as View has them.
template <class Exec, class Real>
struct EngineState {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  struct Pairs {
    Buffer<std::uint32_t> start;
    Buffer<Neighbour> entry;
    Buffer<Vec3<Real>> spring;
    Buffer<Turn<Real>> turn;
    Buffer<Image> image;
  };
  struct Walls {
    Buffer<std::uint32_t> entry;
    Buffer<History<Real>> history;
    Buffer<Turn<Real>> turn;
  };

  Buffer<Control> control;
  Buffer<Place<Real>> place[2];
  Buffer<Drift<Real>> drift[2];
  Buffer<Spin<Real>> spin[2];
  Buffer<Remainder<Real>> remainder;
  Buffer<std::uint32_t> id;  // absent where Spin has it
  Pairs pairs;
  Walls walls;
  Buffer<std::uint32_t> mirror_start, mirror;  // where pairs are evaluated once
  Buffer<float> wall_slack;
  Buffer<NearBody> near;
  Control host_control;  // as it stands in `control` between windows
  Books books;
};

// Calls f(name, buffer of each state) for every buffer; those that a law does not need are empty. The one
// list of what is copied, counted and written to files.
template <class F, class... States>
void for_each_buffer(F f, States&... state) {
  f("control", state.control...);
  for (const int side : {0, 1}) {
    const std::string of_side = side == 0 ? ".0" : ".1";
    f("place" + of_side, state.place[side]...);
    f("drift" + of_side, state.drift[side]...);
    f("spin" + of_side, state.spin[side]...);
  }
  f("remainder", state.remainder...);
  f("id", state.id...);
  f("pairs.start", state.pairs.start...);
  f("pairs.entry", state.pairs.entry...);
  f("pairs.spring", state.pairs.spring...);
  f("pairs.turn", state.pairs.turn...);
  f("pairs.image", state.pairs.image...);
  f("walls.entry", state.walls.entry...);
  f("walls.history", state.walls.history...);
  f("walls.turn", state.walls.turn...);
  f("mirror_start", state.mirror_start...);
  f("mirror", state.mirror...);
  f("wall_slack", state.wall_slack...);
  f("near", state.near...);
}

template <class Exec, class Real>
void copy(Exec& exec, const EngineState<Exec, Real>& from, EngineState<Exec, Real>& to) {
  for_each_buffer([&](const std::string&, const auto& a, auto& b) { exec.copy(a, b); }, from, to);
  to.host_control = from.host_control;
  to.books = from.books;
}

template <class Exec, class Real>
void write_state(Exec& exec, const EngineState<Exec, Real>& state, const ArraySink& sink) {
  sink("host_control", std::as_bytes(std::span(&state.host_control, 1)));
  sink("books", std::as_bytes(std::span(&state.books, 1)));
  for_each_buffer(
      [&](const std::string& name, const auto& buffer) {
        using T = std::remove_cvref_t<decltype(*buffer.data())>;
        std::vector<T> host(buffer.size());
        if (!host.empty()) exec.download(buffer, std::span<T>(host));
        sink(name, std::as_bytes(std::span<const T>(host)));
      },
      state);
}

// Error{resource} where an array cannot be one of this engine, whose arrays have `fewest` to `most`
// slots.
template <class Exec, class Real>
void read_state(Exec& exec, EngineState<Exec, Real>& state, const ArraySource& source, std::size_t fewest,
                std::size_t most) {
  const auto expect = [](const std::string& name, bool fits) {
    if (!fits)
      throw Error(ErrorCode::resource, "its array '" + name + "' has a length that this engine cannot use",
                  {}, "go on with the program that wrote it");
  };
  const auto read_value = [&](const std::string& name, auto& value) {
    const std::vector<std::byte> bytes = source(name);
    expect(name, bytes.size() == sizeof(value));
    std::memcpy(&value, bytes.data(), sizeof(value));
  };
  const bool images = state.pairs.image.size() > 0, spins = state.spin[0].size() > 0,
             pair_turns = state.pairs.turn.size() > 0, wall_turns = state.walls.turn.size() > 0,
             mirrors = state.mirror_start.size() > 0;
  read_value("host_control", state.host_control);
  read_value("books", state.books);
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
  expect("control", state.control.size() == 1);
  const std::size_t n = state.place[0].size();
  expect("place.0", n >= fewest && n <= most);
  expect("host_control",
         state.host_control.slots <= n && state.host_control.used <= state.host_control.slots);
  for (const int side : {0, 1}) {
    const std::string of_side = side == 0 ? ".0" : ".1";
    expect("place" + of_side, state.place[side].size() == n);
    expect("drift" + of_side, state.drift[side].size() == n);
    expect("spin" + of_side, state.spin[side].size() == (spins ? n : 0));
  }
  expect("id", state.id.size() == (spins ? 0 : n));
  expect("remainder", state.remainder.size() == (has_remainder<Real> ? n : 0));
  const auto& pairs = state.pairs;
  const auto& walls = state.walls;
  expect("pairs.start", pairs.start.size() == n + 1);
  expect("mirror_start", state.mirror_start.size() == (mirrors ? n + 1 : 0));
  const std::size_t entries = std::size_t{state.host_control.listed} + Exec::read_ahead;
  expect("mirror", mirrors ? state.mirror.size() >= entries : state.mirror.size() == 0);
  expect("pairs.entry", pairs.entry.size() >= entries);
  expect("pairs.spring", spins ? pairs.spring.size() >= state.host_control.listed : pairs.spring.size() == 0);
  expect("pairs.turn", pairs.turn.size() == (pair_turns ? pairs.entry.size() : 0));
  expect("walls.history", walls.history.size() == (spins ? walls.entry.size() : 0));
  expect("walls.turn", walls.turn.size() == (wall_turns ? walls.entry.size() : 0));
  expect("wall_slack", state.wall_slack.size() == walls.entry.size());
  expect("pairs.image", pairs.image.size() == (images ? pairs.entry.size() : 0));
}

}  // namespace tandem::dem

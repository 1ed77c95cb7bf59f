// Ranks that are threads of a test.
#pragma once

#include <algorithm>
#include <atomic>
#include <barrier>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "particles/base/backend.hpp"
#include "particles/base/ranks.hpp"

namespace tandem::test {

class ThreadRanks final : public particles::Ranks {
 public:
  // What the ranks of one run share.
  struct Team {
    explicit Team(unsigned size) : posted{Posted(size), Posted(size)}, barrier(size) {}
    using Posted = std::vector<std::vector<Bytes>>;  // by sender and receiver
    Posted posted[2];  // in turn: a rank reads one while others already write the next
    std::barrier<> barrier;
  };
  ThreadRanks(unsigned rank, Team& team) : rank_(rank), team_(team) {}

  unsigned rank() const override { return rank_; }
  unsigned size() const override { return static_cast<unsigned>(team_.posted[0].size()); }
  unsigned on_this_host() const override { return per_host > 0 ? per_host : size(); }
  unsigned per_host = 0;  // 0: all
  std::vector<std::int64_t> weights() const override {
    return weights_.empty() ? Ranks::weights() : weights_;
  }
  void set_weights(const std::vector<std::int64_t>& weights) { weights_ = weights; }
  std::vector<Bytes> exchange(const std::vector<Bytes>& to) override {
    Team::Posted& posted = team_.posted[turn_++ % 2];
    posted[rank_] = to;
    team_.barrier.arrive_and_wait();
    std::vector<Bytes> from;
    for (const auto& of_sender : posted) from.push_back(of_sender[rank_]);
    return from;
  }
  void begin_swap(std::span<const Parcel> to, std::span<const Parcel> from) override {
    std::vector<Bytes> out(size());
    for (const Parcel& parcel : to) out[parcel.rank].assign(parcel.bytes.begin(), parcel.bytes.end());
    std::vector<Bytes> in = exchange(out);
    for (const Parcel& parcel : from) {
      if (in[parcel.rank].size() != parcel.bytes.size()) std::abort();  // the ranks disagree on their ghosts
      std::ranges::copy(in[parcel.rank], parcel.bytes.begin());
      in[parcel.rank].clear();
    }
    for (const Bytes& rest : in)
      if (!rest.empty()) std::abort();
  }
  void end_swap() override {}
  void sum(std::span<std::int64_t> values) override {
    combine(values, [](std::int64_t a, std::int64_t b) { return a + b; });
  }
  void maximum(std::span<std::uint64_t> values) override {
    combine(values, [](std::uint64_t a, std::uint64_t b) { return std::max(a, b); });
  }
  void broadcast(Bytes& bytes) override {
    std::vector<Bytes> out(size());
    if (rank_ == 0) out.assign(size(), bytes);
    bytes = exchange(out)[0];
  }
  [[noreturn]] void abort(int) override { std::abort(); }

 private:
  template <class T, class F>
  void combine(std::span<T> values, F f) {
    const auto bytes = std::as_bytes(std::span(values));
    const std::vector<Bytes> all = exchange(std::vector<Bytes>(size(), Bytes(bytes.begin(), bytes.end())));
    for (unsigned r = 0; r < size(); ++r) {
      const T* const other = reinterpret_cast<const T*>(all[r].data());
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = r == 0 ? other[i] : f(values[i], other[i]);
    }
  }

  unsigned rank_, turn_ = 0;
  Team& team_;
  std::vector<std::int64_t> weights_;  // empty: equal ones
};

// Runs work(ranks) on so many ranks. The others cannot go on without a rank that fails: the program then ends
// with its error.
template <class Work>
void on_ranks(unsigned size, Work work) {
  ThreadRanks::Team team(size);
  std::vector<std::jthread> threads;
  for (unsigned rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      particles::use_cuda_device(rank);
      ThreadRanks ranks(rank, team);
      try {
        work(ranks);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "rank %u of %u: %s\n", rank, size, error.what());
        std::abort();
      }
    });
}

}  // namespace tandem::test

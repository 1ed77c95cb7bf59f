// Ranks that are processes of MPI.
#pragma once

#include <memory>

#include "particles/base/ranks.hpp"

namespace tandem::particles {

// One in a process, in which no other part uses MPI. Its calls may come from any thread, one at a time.
class MpiRanks final : public Ranks {
 public:
  MpiRanks(int& argc, char**& argv);
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  unsigned rank() const override { return rank_; }
  unsigned size() const override { return size_; }
  unsigned on_this_host() const override { return on_this_host_; }
  unsigned place_on_host() const override { return place_on_host_; }
  std::vector<Bytes> exchange(const std::vector<Bytes>& to) override;
  void begin_swap(std::span<const Parcel> to, std::span<const Parcel> from) override;
  void end_swap() override;
  void sum(std::span<std::int64_t> values) override;
  void maximum(std::span<std::uint64_t> values) override;
  void broadcast(Bytes& bytes) override;
  [[noreturn]] void abort(int status) override;

 private:
  struct Requests;
  std::unique_ptr<Requests> swapping_;  // of the swap that has begun
  unsigned rank_ = 0, size_ = 1, on_this_host_ = 1, place_on_host_ = 0;
};

}  // namespace tandem::particles

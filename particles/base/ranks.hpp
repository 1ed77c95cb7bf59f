// Processes that compute the particles of one run together, called ranks. Each has a part of the particles;
// an engine without ranks has all of them. The calls are collective: all ranks make them, in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tandem::particles {

class Ranks {
 public:
  using Bytes = std::vector<std::byte>;
  // What goes to, or comes from, another rank.
  struct Parcel {
    unsigned rank = 0;
    std::span<std::byte> bytes;
  };

  virtual ~Ranks() = default;
  virtual unsigned rank() const = 0;
  virtual unsigned size() const = 0;
  // Those on the host of this one.
  virtual unsigned on_this_host() const { return size(); }
  // Each rank gets a share of the particles in proportion to its weight, from the next rebuild on. All ranks
  // give the same.
  virtual std::vector<std::int64_t> weights() const { return std::vector<std::int64_t>(size(), 1); }

  // Sends to[r] to each rank r, this one included. Returns what each of them has sent to this one.
  virtual std::vector<Bytes> exchange(const std::vector<Bytes>& to) = 0;
  // The same between some ranks, which know the lengths of what they get. Until end_swap() other calls may be
  // made, and the bytes of the parcels stay where they are.
  virtual void begin_swap(std::span<const Parcel> to, std::span<const Parcel> from) = 0;
  virtual void end_swap() = 0;
  void swap(std::span<const Parcel> to, std::span<const Parcel> from) {
    begin_swap(to, from);
    end_swap();
  }
  // Replaces each value by the sum, or the maximum, of the values of all ranks.
  virtual void sum(std::span<std::int64_t> values) = 0;
  virtual void maximum(std::span<std::uint64_t> values) = 0;
  // Replaces `bytes` by those of rank 0. The others may wait for long, and leave their core to others
  // meanwhile.
  virtual void broadcast(Bytes& bytes) = 0;
  // Ends all ranks at once, where one of them cannot continue.
  [[noreturn]] virtual void abort(int status) = 0;
};

}  // namespace tandem::particles

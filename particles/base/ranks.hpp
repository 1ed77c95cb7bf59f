// Processes that compute the particles of one run together, called ranks. Each has a part of the particles;
// an engine without ranks has all of them. The calls are collective: all ranks make them, in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
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
  // Those on the host of this one, and the number of this one among them.
  virtual unsigned on_this_host() const { return size(); }
  virtual unsigned place_on_host() const { return rank(); }
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

// Sends values[r] to each rank r. Returns what each of them has sent to this one.
template <class T>
std::vector<T> exchange_values(Ranks& ranks, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<Ranks::Bytes> to;
  for (const T& value : values) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    to.emplace_back(bytes.begin(), bytes.end());
  }
  std::vector<T> from(values.size());
  const std::vector<Ranks::Bytes> received = ranks.exchange(to);
  for (std::size_t r = 0; r < from.size(); ++r) std::memcpy(&from[r], received[r].data(), sizeof(T));
  return from;
}

// Bits that are set on any rank.
inline std::uint32_t any_of_ranks(Ranks& ranks, std::uint32_t bits) {
  std::uint64_t each[32];
  for (unsigned k = 0; k < 32; ++k) each[k] = bits >> k & 1;
  ranks.maximum(each);
  std::uint32_t any = 0;
  for (unsigned k = 0; k < 32; ++k) any |= static_cast<std::uint32_t>(each[k]) << k;
  return any;
}

}  // namespace tandem::particles

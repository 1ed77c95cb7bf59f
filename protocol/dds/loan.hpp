// Samples taken from a reader without copying, in order; they belong to Cyclone and are returned when all
// have been used.
#pragma once

#include <array>

#include "protocol/dds/entity.hpp"
#include "wire.h"

namespace tandem::protocol::dds {

class Loan {
 public:
  explicit Loan(dds_entity_t reader) : reader_(reader) {}
  ~Loan() { give_back(); }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;

  // Null when the reader has no sample. Valid until pop().
  const tandem_dds_Chunk* front() {
    for (;;) {
      for (; next_ < count_; ++next_)
        if (infos_[next_].valid_data) return static_cast<const tandem_dds_Chunk*>(samples_[next_]);
      give_back();
      count_ = checked(dds_take(reader_, samples_.data(), infos_.data(), capacity, capacity), "take samples");
      if (count_ == 0) return nullptr;
    }
  }
  void pop() { ++next_; }

 private:
  static constexpr int capacity = 8;

  void give_back() {
    if (count_ > 0) dds_return_loan(reader_, samples_.data(), count_);
    samples_.fill(nullptr);
    count_ = next_ = 0;
  }

  dds_entity_t reader_;
  std::array<void*, capacity> samples_{};
  std::array<dds_sample_info_t, capacity> infos_{};
  int count_ = 0, next_ = 0;
};

}  // namespace tandem::protocol::dds

// Damages inputs. A Mutator has no state: the same random numbers make the same damage.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "tests/fuzz/random.hpp"

namespace tandem::fuzz {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::string_view text);
std::string_view text_of(std::span<const std::byte> bytes);

class Mutator {
 public:
  // `corpus` must outlive this object and have at least one entry. In inputs that are `text`, written numbers
  // are also replaced by others.
  Mutator(const std::vector<Bytes>& corpus, bool text);
  // Writes an entry of the corpus with one to about ten changes to `out`, whose memory is reused.
  void make(Random& random, Bytes& out) const;

 private:
  void change(Random& random, Bytes& out) const;

  const std::vector<Bytes>& corpus_;
  bool text_;
  std::size_t largest_;  // largest size of an input [bytes]
};

}  // namespace tandem::fuzz

// Damages inputs. Nothing is remembered from one input to the next: the same random numbers make the same
// damage.
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
  // `corpus` must outlive this, and has at least one entry. Of inputs that are `text` numbers are replaced as
  // they are written, too.
  Mutator(const std::vector<Bytes>& corpus, bool text);
  // An entry of the corpus with one to about ten changes. `out` keeps its memory.
  void make(Random& random, Bytes& out) const;

 private:
  void change(Random& random, Bytes& out) const;

  const std::vector<Bytes>& corpus_;
  bool text_;
  std::size_t largest_;  // that an input may become [bytes]
};

}  // namespace tandem::fuzz

#include "tests/fuzz/mutator.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace tandem::fuzz {
namespace {

// Limits of the types in use, and values that break arithmetic.
constexpr auto words =
    std::to_array<std::uint64_t>({0,
                                  1,
                                  2,
                                  0x7f,
                                  0x80,
                                  0xff,
                                  0x7fff,
                                  0x8000,
                                  0xffff,
                                  0x7fffffff,
                                  0x80000000,
                                  0xffffffff,
                                  0x100000000,
                                  0x7fffffffffffffff,
                                  0x8000000000000000,
                                  0xffffffffffffffff,
                                  0x2000000000000000,
                                  0x1fffffffffffffff,
                                  std::bit_cast<std::uint64_t>(1.0),
                                  std::bit_cast<std::uint64_t>(-1.0),
                                  std::bit_cast<std::uint64_t>(1e308),
                                  std::bit_cast<std::uint64_t>(-1e308),
                                  std::bit_cast<std::uint64_t>(1e-308),
                                  std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity()),
                                  std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN()),
                                  std::bit_cast<std::uint64_t>(std::numeric_limits<double>::denorm_min()),
                                  0x7f800000,
                                  0x7fc00000});

constexpr auto numerals = std::to_array<std::string_view>({"0",
                                                           "-0",
                                                           "1",
                                                           "-1",
                                                           "2",
                                                           "1e-300",
                                                           "1e300",
                                                           "-1e300",
                                                           "1e308",
                                                           "1e309",
                                                           "4e-324",
                                                           "0.1",
                                                           "1e-9",
                                                           "1e9",
                                                           "127",
                                                           "255",
                                                           "256",
                                                           "32767",
                                                           "65536",
                                                           "2147483647",
                                                           "2147483648",
                                                           "4294967295",
                                                           "4294967296",
                                                           "9223372036854775807",
                                                           "9223372036854775808",
                                                           "18446744073709551615",
                                                           "18446744073709551616",
                                                           "-9223372036854775808",
                                                           "nan",
                                                           "inf",
                                                           "-inf",
                                                           "NaN",
                                                           "0x10",
                                                           "1e",
                                                           "01",
                                                           "1.",
                                                           ".5",
                                                           "+1",
                                                           "1e+",
                                                           "1,5",
                                                           "true",
                                                           "null",
                                                           "\"1\"",
                                                           "[]",
                                                           "{}",
                                                           ""});

bool is_digit(std::byte b) {
  return b >= std::byte{'0'} && b <= std::byte{'9'};
}
bool is_of_number(std::byte b) {
  const char c = static_cast<char>(b);
  return is_digit(b) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

struct Piece {
  std::size_t begin, size;
};
// A random range, short in most cases, but up to the whole rest.
Piece piece_of(Random& random, std::size_t size) {
  const std::size_t begin = random.below(size);
  const std::size_t left = size - begin;
  return {begin, 1 + random.below(random.one_in(8) ? left : std::min<std::size_t>(left, 32))};
}

void insert(Bytes& out, std::size_t at, const std::byte* data, std::size_t size) {
  if (size == 0) return;
  const std::size_t old = out.size();
  out.resize(old + size);
  std::memmove(out.data() + at + size, out.data() + at, old - at);
  std::memcpy(out.data() + at, data, size);
}

void erase(Bytes& out, Piece piece) {
  const auto begin = out.begin() + static_cast<std::ptrdiff_t>(piece.begin);
  out.erase(begin, begin + static_cast<std::ptrdiff_t>(piece.size));
}

// Replaces the next number after a random position, if there is one nearby.
void replace_number(Random& random, Bytes& out) {
  std::size_t begin = random.below(out.size());
  const std::size_t stop = std::min(out.size(), begin + 256);
  while (begin < stop && !is_digit(out[begin])) ++begin;
  if (begin == stop) return;
  std::size_t end = begin;
  while (begin > 0 && is_of_number(out[begin - 1])) --begin;
  while (end < out.size() && is_of_number(out[end])) ++end;
  const std::string_view numeral = numerals[random.below(numerals.size())];
  erase(out, {begin, end - begin});
  insert(out, begin, reinterpret_cast<const std::byte*>(numeral.data()), numeral.size());
}

void overwrite_word(Random& random, Bytes& out) {
  const std::size_t width = std::size_t{1} << random.below(4);
  if (out.size() < width) return;
  std::size_t at = random.below(out.size() - width + 1);
  if (!random.one_in(4)) at -= at % width;
  std::uint64_t word = words[random.below(words.size())];
  if (random.one_in(3)) {  // one more or less than the present value
    std::memcpy(&word, out.data() + at, width);
    word += random.one_in(2) ? 1 : std::uint64_t{0} - 1;
  }
  std::memcpy(out.data() + at, &word, width);
}

// Inserts a copy of a piece, once or many times, which lengthens lists and deepens nesting.
void repeat(Random& random, Bytes& out, std::size_t largest) {
  const Piece piece = piece_of(random, out.size());
  const Bytes copy(out.begin() + static_cast<std::ptrdiff_t>(piece.begin),
                   out.begin() + static_cast<std::ptrdiff_t>(piece.begin + piece.size));
  const std::size_t times = random.one_in(16) ? std::size_t{1} << random.below(13) : 1;
  const std::size_t at = random.one_in(2) ? piece.begin : random.below(out.size() + 1);
  Bytes all;
  for (std::size_t i = 0; i < times && out.size() + all.size() + copy.size() <= largest; ++i)
    all.insert(all.end(), copy.begin(), copy.end());
  insert(out, at, all.data(), all.size());
}

}  // namespace

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Mutator::Mutator(const std::vector<Bytes>& corpus, bool text) : corpus_(corpus), text_(text), largest_(4096) {
  for (const Bytes& entry : corpus) largest_ = std::max(largest_, 2 * entry.size());
}

void Mutator::make(Random& random, Bytes& out) const {
  const Bytes& entry = corpus_[random.below(corpus_.size())];
  out.assign(entry.begin(), entry.end());
  std::size_t changes = 1;
  while (changes < 16 && random.one_in(2)) ++changes;
  for (; changes > 0; --changes) {
    change(random, out);
    if (out.size() > largest_) out.resize(largest_);
  }
}

void Mutator::change(Random& random, Bytes& out) const {
  const Bytes& other = corpus_[random.below(corpus_.size())];
  if (out.empty()) out.push_back(std::byte{0});
  if (text_ && random.one_in(3)) return replace_number(random, out);
  switch (random.below(12)) {
    case 0:
    case 1:
      out[random.below(out.size())] ^= std::byte{1} << random.below(8);
      break;
    case 2:
      out[random.below(out.size())] = static_cast<std::byte>(random.bits());
      break;
    case 3: {
      const std::uint64_t noise = random.bits();
      insert(out, random.below(out.size() + 1), reinterpret_cast<const std::byte*>(&noise),
             1 + random.below(8));
      break;
    }
    case 4:
      erase(out, piece_of(random, out.size()));
      break;
    case 5:
      repeat(random, out, largest_);
      break;
    case 6: {  // replaces the end by that of another entry
      out.resize(random.below(out.size() + 1));
      const std::size_t from =
          random.one_in(2) ? std::min(out.size(), other.size()) : random.below(other.size() + 1);
      out.insert(out.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
      break;
    }
    case 7: {  // inserts a piece of another entry, or overwrites with it
      if (other.empty()) break;
      const Piece piece = piece_of(random, other.size());
      const std::size_t at = random.below(out.size());
      if (random.one_in(2))
        insert(out, at, other.data() + piece.begin, piece.size);
      else
        std::memcpy(out.data() + at, other.data() + piece.begin, std::min(piece.size, out.size() - at));
      break;
    }
    case 8:
      if (random.one_in(3)) out.resize(random.below(out.size()));
      break;
    default:
      overwrite_word(random, out);
  }
}

}  // namespace tandem::fuzz

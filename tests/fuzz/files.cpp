#include "tests/fuzz/files.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/error.hpp"

namespace tandem::fuzz {

void put(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  // This must not be a tandem::Error, which would count as a refusal.
  if (!stream.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

Bytes get(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw std::runtime_error(file.string() + " cannot be read");
  return bytes_of(text);
}

Bytes choice(unsigned which, std::span<const std::byte> bytes) {
  Bytes input(1 + bytes.size());
  input[0] = static_cast<std::byte>('0' + which);
  std::ranges::copy(bytes, input.begin() + 1);
  return input;
}

unsigned chosen(std::span<const std::byte>& input, unsigned of) {
  if (input.empty()) return 0;
  const unsigned which = (static_cast<unsigned>(input[0]) + of * 256 - '0') % of;
  input = input.subspan(1);
  return which;
}

}  // namespace tandem::fuzz

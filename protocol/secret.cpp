#include "protocol/secret.hpp"

#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol {
namespace {

constexpr std::size_t least_secret = 32, most_secret = 1024;
constexpr std::uint64_t largest_file = std::uint64_t{64} << 10;  // [bytes], with white space
constexpr const char* how_to_make = "make one with: tandem keys --secret FILE";

std::string read_private(const std::string& path) {
  return read_input(
      path, {.code = ErrorCode::usage, .largest = largest_file, .hint = how_to_make, .secret = "secret"});
}

}  // namespace

std::string take_secret(const std::string& file) {
  std::string secret, where = file;
  if (!file.empty()) {
    secret = read_private(file);
  } else if (const char* given = std::getenv(secret_variable)) {
    secret = given;
    where = secret_variable;
  } else {
    return {};
  }
  unsetenv(secret_variable);
  constexpr const char* white = " \t\r\n";
  const std::size_t begin = secret.find_first_not_of(white);
  secret = begin == std::string::npos ? "" : secret.substr(begin, secret.find_last_not_of(white) - begin + 1);
  if (secret.size() < least_secret || secret.size() > most_secret)
    throw Error(ErrorCode::usage,
                "a secret of " + std::to_string(secret.size()) + " characters; " +
                    std::to_string(least_secret) + " to " + std::to_string(most_secret) + " are needed",
                where, how_to_make);
  return secret;
}

Fd secret_to_inherit(const std::string& secret) {
  Fd file(memfd_create("secret", MFD_CLOEXEC));
  if (!file || fchmod(file.get(), 0600) != 0 ||
      write(file.get(), secret.data(), secret.size()) != static_cast<ssize_t>(secret.size()))
    throw Error(ErrorCode::resource, std::string("cannot be handed over: ") + std::strerror(errno), "secret");
  return file;
}

std::string make_secret() {
  std::array<unsigned char, 32> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    throw Error(ErrorCode::resource, std::string("no random numbers: ") + std::strerror(errno), "secret");
  constexpr const char* digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : random) (text += digits[byte >> 4]) += digits[byte & 15];
  return text;
}

}  // namespace tandem::protocol

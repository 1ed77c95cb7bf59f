#include "particles/backend/setting.hpp"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>

#include "common/error.hpp"

namespace tandem::particles {

std::optional<std::uint32_t> setting(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return {};
  std::uint32_t number = 0;
  const char* const end = text + std::strlen(text);
  const auto read = std::from_chars(text, end, number);
  if (read.ec != std::errc{} || read.ptr != end)
    throw Error(ErrorCode::usage, std::string("\"") + text + "\" is not a whole number", name,
                "say one, or unset the variable");
  return number;
}

}  // namespace tandem::particles

// Message of the error that an action throws.
#pragma once

#include <functional>
#include <string>

#include "common/error.hpp"

namespace tandem::test {

inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return std::string(name(error.code())) + ": " + error.what();
  }
  return "no error";
}

}  // namespace tandem::test

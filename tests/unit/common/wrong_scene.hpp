// Tables of wrong scenes, each with the whole message that a user gets.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace tandem::scene::test {

struct WrongScene {
  const char* name;     // of the test case
  const char* patch;    // RFC 6902, the change of the good scene
  const char* message;  // without "scene.json: "
};

// The message of parse() and validate() about a text; "no error" when they accept it.
std::string verdict(const std::string& text);

// The message about the good scene with `patch` applied.
std::string verdict_on_patch(const std::string& patch);

class WrongSceneTest : public testing::TestWithParam<WrongScene> {};

inline std::string name_of_case(const testing::TestParamInfo<WrongScene>& info) {
  return info.param.name;
}

}  // namespace tandem::scene::test
